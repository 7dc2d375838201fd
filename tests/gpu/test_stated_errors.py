"""The tables of docs/theory: complete, true, and about functions that exist.

Rows that state an error begin with a name in code and end in a number.
"""

import re
from pathlib import Path

import pytest

from tests.support.stated_errors import MEASURES

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs" / "theory").glob("*.md"))
ROW = re.compile(r"^\| `([^`]+)` \| `([^`]+)` \|.*\| ([\d.e-]+) \|$", re.M)

STATED = {
    name: (file, float(error))
    for page in PAGES
    for name, file, error in ROW.findall(page.read_text("utf-8"))
}

# The tables hold one driver's numbers; others round differently.
BETWEEN_DRIVERS = 2.0


def test_every_measure_has_a_row_and_every_row_a_measure() -> None:
    assert set(STATED) == set(MEASURES)


@pytest.mark.parametrize("name", sorted(STATED))
def test_a_row_names_what_is_in_its_file(name: str) -> None:
    file = STATED[name][0]
    folder = ROOT if file.startswith("moka/") else ROOT / "shaders"
    text = (folder / file).read_text("utf-8")
    function = name.split()[0]
    assert function == file or re.search(rf"\b{function}\(", text)


@pytest.mark.gpu
@pytest.mark.parametrize("name", MEASURES)
def test_no_function_is_worse_than_stated(name: str) -> None:
    assert MEASURES[name]() <= BETWEEN_DRIVERS * STATED[name][1]
