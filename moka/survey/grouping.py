"""Which scene a picture shows and which renderer made it, by its name."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

from moka.core.errors import OptionError

__all__ = ["DEFAULT_PATTERN", "Entry", "group", "pairs_of"]

DEFAULT_PATTERN = "{scene}@{renderer}"


@dataclass(frozen=True)
class Entry:
    """One picture of the survey and where it belongs."""

    path: Path
    scene: str
    renderer: str


def group(
    paths: Iterable[Path], pattern: str = DEFAULT_PATTERN
) -> list[list[Entry]]:
    """The pictures of each scene, in the order of the scenes' names.

    ``pattern`` has ``{scene}`` and ``{renderer}`` once each and describes
    the end of a path without its suffix: ``{scene}@{renderer}`` for
    ``helmet@moka.png``, ``{renderer}/{scene}`` for a folder per renderer.
    Raises OptionError for a name that does not fit, a scene with a single
    picture and two pictures of a scene by the same renderer.
    """
    matcher = _matcher(pattern)
    depth = pattern.count("/") + 1
    scenes: dict[str, dict[str, Entry]] = {}
    for path in paths:
        parts = path.absolute().with_suffix("").parts
        match = matcher.fullmatch("/".join(parts[-depth:]))
        if match is None:
            raise OptionError(
                f"{path}: the name does not have the form {pattern}; rename "
                "it, or give another form with --group"
            )
        entry = Entry(path, match["scene"], match["renderer"])
        others = scenes.setdefault(entry.scene, {})
        if entry.renderer in others:
            raise OptionError(
                f"{path}: {others[entry.renderer].path} already shows "
                f"{entry.scene} by {entry.renderer}"
            )
        others[entry.renderer] = entry
    groups = [
        [renderers[name] for name in sorted(renderers)]
        for _, renderers in sorted(scenes.items())
    ]
    for entries in groups:
        if len(entries) == 1:
            raise OptionError(
                f"{entries[0].path}: is the only picture of "
                f"{entries[0].scene}, so that there is nothing to compare"
            )
    return groups


def pairs_of(groups: Iterable[Sequence[Entry]]) -> list[list[Entry]]:
    """Every pair of pictures of the same scene."""
    return [
        list(pair) for entries in groups for pair in combinations(entries, 2)
    ]


def _matcher(pattern: str) -> re.Pattern[str]:
    text = re.escape(pattern)
    for field in ("scene", "renderer"):
        written = re.escape(f"{{{field}}}")
        if text.count(written) != 1:
            raise OptionError(
                f"--group {pattern}: needs {{scene}} and {{renderer}}, each "
                "once"
            )
        text = text.replace(written, f"(?P<{field}>[^/]+)")
    return re.compile(text)
