"""Every case of the conformance page holds."""

from pathlib import Path

import pytest

from tests.conformance.case import Case
from tests.conformance.features import FEATURES

pytestmark = pytest.mark.gpu

DOCS = Path(__file__).resolve().parents[2] / "docs"
CASES = [case for cases in FEATURES.values() for case in cases]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.title)
def test_a_feature_looks_as_it_must(case: Case) -> None:
    outcome = case.run()
    assert outcome.passed, (
        f"{outcome.differing:.2%} of the pixels are further off than "
        f"{case.tolerance}; the mean difference is {outcome.mean:.5f}"
    )
    # An expectation of nothing would be met by nothing.
    assert outcome.expected.std() > 0.01


def test_titles_are_told_apart() -> None:
    assert len({case.title for case in CASES}) == len(CASES)


def test_the_page_has_every_case() -> None:
    page = (DOCS / "conformance.md").read_text(encoding="utf-8")
    rows = [line.split(" | ") for line in page.splitlines() if "![" in line]
    assert [cells[0].removeprefix("| ") for cells in rows] == [
        case.title for case in CASES
    ], "run make conformance"
    assert all(cells[-1] == "pass |" for cells in rows)
    for cells in rows:
        picture = cells[1].rpartition("(")[2].removesuffix(")")
        assert (DOCS / picture).is_file()
