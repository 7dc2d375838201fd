"""Whom the pictures of a survey have to credit.

Every source gives lines of text; who is credited for which picture is not
said, since that could tell who made it.
"""

import json
from collections.abc import Iterable
from pathlib import Path

from moka.core.errors import ModelError, OptionError
from moka.core.picture_credits import picture_credits
from moka.model.container import read_file, split_container

__all__ = ["collect_credits"]


def collect_credits(
    pictures: Iterable[Path], files: Iterable[Path]
) -> list[str]:
    """Credit lines in alphabetical order, each once.

    They come from the pictures' own metadata (authors and copyright) and
    from ``files``: the ``asset.copyright`` of .gltf and .glb files, every
    line of any other, which is UTF-8 text. Raises OptionError or ModelError
    for a file that cannot be read.
    """
    lines = {line for path in pictures for line in picture_credits(path)}
    for path in files:
        if path.suffix.lower() in (".gltf", ".glb"):
            lines |= _of_model(path)
        else:
            lines |= set(_of_text(path))
    return sorted(stripped for line in lines if (stripped := line.strip()))


def _of_model(path: Path) -> set[str]:
    text, _ = split_container(memoryview(read_file(path)), str(path))
    try:
        document = json.loads(bytes(text))
    except ValueError as error:
        raise ModelError(f"{path}: not valid JSON: {error}") from error
    asset = document.get("asset")
    credit = asset.get("copyright") if isinstance(asset, dict) else None
    if credit is not None and not isinstance(credit, str):
        raise ModelError(f"{path}: asset.copyright: is not a string")
    return set(credit.splitlines()) if credit else set()


def _of_text(path: Path) -> list[str]:
    try:
        return path.read_text("utf-8").splitlines()
    except OSError as error:
        raise OptionError(
            f"{path}: cannot read the credits: {error.strerror}"
        ) from error
    except UnicodeDecodeError as error:
        raise OptionError(f"{path}: is not UTF-8 text: {error}") from error
