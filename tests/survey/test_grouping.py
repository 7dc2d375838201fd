"""From file names to scenes and renderers."""

from pathlib import Path

import pytest

from moka.core.errors import OptionError
from moka.survey.grouping import group, pairs_of


def names(*paths: str, pattern: str = "{scene}@{renderer}") -> list[list[str]]:
    groups = group(map(Path, paths), pattern)
    return [
        [f"{entry.scene}:{entry.renderer}" for entry in entries]
        for entries in groups
    ]


def test_scenes_and_renderers_are_sorted() -> None:
    assert names("b@y.png", "a@y.exr", "x/b@x.png", "a@x.jpg") == [
        ["a:x", "a:y"],
        ["b:x", "b:y"],
    ]


def test_only_the_last_suffix_is_cut_off() -> None:
    assert names("a.1k@x.v2.png", "a.1k@y.png") == [["a.1k:x.v2", "a.1k:y"]]


def test_a_folder_per_renderer() -> None:
    found = names("in/x/a.png", "in/y/a.png", pattern="{renderer}/{scene}")
    assert found == [["a:x", "a:y"]]


def test_a_pattern_is_no_regular_expression() -> None:
    found = names("a.+x.png", "a.+y.png", pattern="{scene}.+{renderer}")
    assert found == [["a:x", "a:y"]]


def test_all_pairs_of_each_scene() -> None:
    paths = ["a@x.png", "a@y.png", "a@z.png", "b@x.png", "b@y.png"]
    pairs = pairs_of(group(map(Path, paths)))
    assert [
        f"{first.scene}{first.renderer}{second.renderer}"
        for first, second in pairs
    ] == ["axy", "axz", "ayz", "bxy"]
    assert all(first.scene == second.scene for first, second in pairs)


@pytest.mark.parametrize(
    ("paths", "pattern", "message"),
    [
        (["a.png"], "{scene}@{renderer}", "a.png: the name does not have the"),
        (["a@x.png"], "{scene}@{renderer}", "the only picture of a"),
        (
            ["a@x.png", "a@x.exr"],
            "{scene}@{renderer}",
            "a@x.exr: a@x.png already shows a by x",
        ),
        (["a@x.png"], "{scene}", "needs {scene} and {renderer}, each once"),
        (["a@x.png"], "{scene}{scene}{renderer}", "each once"),
    ],
)
def test_a_mistake_names_the_file(
    paths: list[str], pattern: str, message: str
) -> None:
    with pytest.raises(OptionError) as caught:
        group(map(Path, paths), pattern)
    assert message in str(caught.value)
