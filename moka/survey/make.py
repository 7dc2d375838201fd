"""Writes a survey: a folder to hand out and a key to keep.

The folder holds one page and the pictures, under names that say nothing and
without metadata. What they show, and who made them, is in the key alone.
"""

import json
import secrets
import shutil
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.core.errors import OptionError
from moka.core.picture_file import Picture, read_picture
from moka.core.png import write_png
from moka.survey.credits import collect_credits
from moka.survey.grouping import DEFAULT_PATTERN, Entry, group, pairs_of
from moka.survey.page import SURROUND, Page, build_page

__all__ = ["SurveyOptions", "make_survey"]

KEY_VERSION = 1


@dataclass(frozen=True)
class SurveyOptions:
    """How a survey is made.

    ``pattern`` is the form of the pictures' names (see
    :func:`moka.survey.grouping.group`); ``pairs`` shows the pictures of a
    scene two at a time, not all at once; ``notice`` is text that stands
    before the consent, ``contact`` says to whom the answers go; ``credits``
    are files as :func:`moka.survey.credits.collect_credits` takes them;
    ``tone_map`` and ``exposure`` (EV) show EXR files.
    """

    title: str
    pattern: str = DEFAULT_PATTERN
    pairs: bool = False
    notice: str = ""
    contact: str = ""
    credits: Sequence[Path] = ()
    tone_map: str = "neutral"
    exposure: float = 0.0


def make_survey(
    pictures: Iterable[Path], folder: Path, key: Path, options: SurveyOptions
) -> int:
    """Write the survey to ``folder`` and its key; returns its page count.

    ``folder`` and ``key`` must not exist yet, and the key must lie outside
    of the folder. Either both appear or none. Raises OptionError for that,
    for names that cannot be grouped and for pictures of one scene that
    differ in size; ImageFileError for pictures that cannot be read.
    """
    _check_targets(folder, key)
    groups = group(pictures, options.pattern)
    entries = [entry for scene in groups for entry in scene]
    sets = _shuffled(pairs_of(groups) if options.pairs else groups)
    names = {entry: f"{secrets.token_hex(8)}.png" for entry in entries}
    survey = secrets.token_hex(8)
    lines = collect_credits([entry.path for entry in entries], options.credits)
    temporary = folder.with_name(f".moka-{secrets.token_hex(8)}.tmp")
    try:
        temporary.mkdir()
        sizes = _write_pictures(groups, names, temporary, options)
        page = Page(
            survey=survey,
            title=options.title,
            notice=options.notice,
            contact=options.contact,
            credits=lines,
            sets=[[names[entry] for entry in each] for each in sets],
            sizes=sizes,
        )
        (temporary / "index.html").write_text(build_page(page), "utf-8")
        if lines:
            text = "".join(f"{line}\n" for line in lines)
            (temporary / "credits.txt").write_text(text, "utf-8")
        key.write_text(_key_text(survey, names, sets), "utf-8")
        temporary.rename(folder)
    except OSError as error:
        raise OptionError(
            f"{error.filename or folder}: cannot write the survey: "
            f"{error.strerror}"
        ) from error
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
        if not folder.exists():
            key.unlink(missing_ok=True)
    return len(sets)


def _shuffled(sets: Iterable[Sequence[Entry]]) -> list[list[Entry]]:
    """The sets in an order that, in the page's source, tells nothing."""
    chance = secrets.SystemRandom()
    mixed = [chance.sample(each, len(each)) for each in sets]
    chance.shuffle(mixed)
    return mixed


def _check_targets(folder: Path, key: Path) -> None:
    for path in (folder, key):
        if path.exists():
            raise OptionError(f"{path}: exists already; name another")
        if not path.absolute().parent.is_dir():
            raise OptionError(f"{path}: the folder {path.parent} is missing")
    if folder.resolve() in key.resolve().parents:
        raise OptionError(
            f"{key}: the key must not lie in the folder that is handed out"
        )


def _write_pictures(
    groups: Iterable[Sequence[Entry]],
    names: dict[Entry, str],
    folder: Path,
    options: SurveyOptions,
) -> dict[str, tuple[int, int]]:
    """Write the pictures under their new names; returns their sizes."""
    sizes: dict[str, tuple[int, int]] = {}
    for entries in groups:
        first: Picture | None = None
        for entry in entries:
            picture = read_picture(entry.path)
            first = first or picture
            if picture.size != first.size:
                raise OptionError(
                    f"{picture.path}: is {_size(picture)}, but {first.path} "
                    f"is {_size(first)}; pictures of one scene must have one "
                    "size"
                )
            shown = picture.shown(options.tone_map, options.exposure)
            name = names[entry]
            write_png(folder / name, _over_surround(shown.pixels))
            sizes[name] = picture.size
    return sizes


def _over_surround(pixels: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Opaque codes: what the page would show around and behind a picture."""
    alpha = pixels[:, :, 3:]
    colour = alpha * pixels[:, :, :3] + (1 - alpha) * SURROUND
    codes: NDArray[np.uint8] = np.rint(255.0 * colour).astype(np.uint8)
    return codes


def _key_text(
    survey: str, names: dict[Entry, str], sets: Sequence[Sequence[Entry]]
) -> str:
    key: dict[str, Any] = {
        "survey_key": KEY_VERSION,
        "survey": survey,
        "pictures": {
            name: {
                "scene": entry.scene,
                "renderer": entry.renderer,
                "file": entry.path.name,
            }
            for entry, name in names.items()
        },
        "sets": [[names[entry] for entry in each] for each in sets],
    }
    return json.dumps(key, indent=2, ensure_ascii=False) + "\n"


def _size(picture: Picture) -> str:
    width, height = picture.size
    return f"{width} x {height}"
