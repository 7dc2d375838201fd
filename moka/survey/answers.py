"""Reads the key of a survey and the files of answers that belong to it."""

import hashlib
import json
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from moka.core.errors import OptionError

__all__ = [
    "HIGHEST",
    "LOWEST",
    "Answers",
    "Key",
    "Rating",
    "read_answers",
    "read_key",
]

LOWEST, HIGHEST = 1, 10

_VERSION = 1


@dataclass(frozen=True)
class Key:
    """What the pictures of a survey show.

    ``pictures`` maps a file name to scene and renderer; ``sets`` holds the
    file names that were shown together.
    """

    survey: str
    pictures: Mapping[str, tuple[str, str]]
    sets: Sequence[Sequence[str]]


@dataclass(frozen=True)
class Rating:
    """One mark: by whom, for what, and as which picture from the start.

    ``participant`` and ``position`` count from 0, ``set`` is that of the
    key. Participants are numbered by a hash of what they answered, so that
    the number does not tell who answered first.
    """

    participant: int
    position: int
    set: int
    scene: str
    renderer: str
    rating: int


@dataclass(frozen=True)
class Answers:
    """All the ratings, and how many files were given a second time."""

    ratings: Sequence[Rating]
    participants: int
    repeated: int


def read_key(path: Path) -> Key:
    """Read the key that was written with a survey; raises OptionError."""
    data = _read_json(path, "survey_key")
    try:
        pictures = {
            str(name): (str(each["scene"]), str(each["renderer"]))
            for name, each in data["pictures"].items()
        }
        sets = [[str(name) for name in each] for each in data["sets"]]
        survey = str(data["survey"])
    except (AttributeError, KeyError, TypeError) as error:
        raise OptionError(f"{path}: is not a whole key: {error!r}") from error
    for index, each in enumerate(sets):
        for name in each:
            if name not in pictures:
                raise OptionError(
                    f"{path}: sets[{index}]: {name} is not among the pictures"
                )
    return Key(survey, pictures, sets)


def read_answers(paths: Iterable[Path], key: Key) -> Answers:
    """Read files of answers; a file given twice counts once.

    Two people do not see the same random order and answer alike, so files
    of equal content are copies of one. Raises OptionError, naming file and
    JSON path, for anything but one whole set of ratings of 1 to 10 of the
    key's survey.
    """
    files: dict[str, list[tuple[int, str, int]]] = {}
    count = 0
    for path in paths:
        ratings = _read_one(path, key)
        count += 1
        digest = hashlib.sha256(repr(ratings).encode()).hexdigest()
        files[digest] = ratings
    found = [
        Rating(participant, position, index, *key.pictures[name], rating)
        for participant, digest in enumerate(sorted(files))
        for position, (index, name, rating) in enumerate(files[digest])
    ]
    return Answers(found, len(files), count - len(files))


def _read_one(path: Path, key: Key) -> list[tuple[int, str, int]]:
    """Set, picture and rating, in the order in which they were shown."""
    data = _read_json(path, "survey_answers")
    if data.get("survey") != key.survey:
        raise OptionError(
            f"{path}: survey: these answers belong to another survey than "
            "the key"
        )
    if data.get("consent") is not True:
        raise OptionError(f"{path}: consent: was not given")
    ratings = data.get("ratings")
    if not isinstance(ratings, list):
        raise OptionError(f"{path}: ratings: is missing or no list")
    found = [
        _read_rating(each, f"{path}: ratings[{index}]")
        for index, each in enumerate(ratings)
    ]
    expected = Counter(
        (index, name) for index, names in enumerate(key.sets) for name in names
    )
    if Counter((index, name) for index, name, _ in found) != expected:
        raise OptionError(
            f"{path}: ratings: are not one of each of the {expected.total()} "
            "pictures that were shown"
        )
    return found


def _read_rating(data: Any, where: str) -> tuple[int, str, int]:
    entry = data if isinstance(data, dict) else {}
    index, name = entry.get("set"), entry.get("picture")
    if type(index) is not int or not isinstance(name, str):
        raise OptionError(f"{where}: does not name a set and a picture")
    rating = entry.get("rating")
    if type(rating) is not int or not LOWEST <= rating <= HIGHEST:
        raise OptionError(
            f"{where}.rating: {rating!r} is no whole number from {LOWEST} to "
            f"{HIGHEST}"
        )
    return index, name, rating


def _read_json(path: Path, kind: str) -> dict[str, Any]:
    try:
        data = json.loads(path.read_bytes())
    except OSError as error:
        raise OptionError(f"{path}: cannot read: {error.strerror}") from error
    except (ValueError, RecursionError) as error:
        raise OptionError(f"{path}: not valid JSON: {error}") from error
    if not isinstance(data, dict) or kind not in data:
        raise OptionError(f"{path}: has no {kind}: a file of another kind")
    if data[kind] != _VERSION:
        raise OptionError(
            f"{path}: {kind}: version {data[kind]!r} is not {_VERSION}; it "
            "was written by another version of moka"
        )
    return data
