"""Every case of the conformance page holds."""

import re
from pathlib import Path

import pytest

from moka.model.validation.issues import Severity
from moka.model.validation.validate import validate
from tests.conformance.case import Case
from tests.conformance.elsewhere import ELSEWHERE
from tests.conformance.features import FEATURES
from tests.conformance.samples import SAMPLES, Sample

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


@pytest.mark.assets
@pytest.mark.parametrize("sample", SAMPLES, ids=lambda sample: sample.title)
def test_a_sample_looks_as_rays_see_it(sample: Sample, assets: Path) -> None:
    outcome = sample.run(assets)
    assert outcome.passed, (
        f"depth is wrong in {outcome.differing:.3%} of the pixels; base "
        f"colours differ by {outcome.mean:.4f}"
    )
    # The model is there at all.
    assert outcome.expected.max() > 0.1


@pytest.mark.assets
def test_every_sample_is_there(assets: Path) -> None:
    models = assets / "models"
    assert sorted(sample.path for sample in SAMPLES) == sorted(
        str(path.relative_to(models)) for path in models.rglob("*.gl[bt]*")
    )


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.title)
def test_the_file_of_a_feature_is_valid(case: Case, tmp_path: Path) -> None:
    path = tmp_path / "case.glb"
    path.write_bytes(case.glb())
    errors = [
        issue
        for issue in validate(path).issues
        if issue.severity is Severity.ERROR
    ]
    assert not errors


def test_titles_are_told_apart() -> None:
    titles = [each.title for each in (*CASES, *SAMPLES)]
    assert len(set(titles)) == len(titles)


@pytest.mark.parametrize("test", ELSEWHERE.values())
def test_what_is_held_elsewhere_is(test: str) -> None:
    path, _, name = test.partition("::")
    text = (DOCS.parent / path).read_text(encoding="utf-8")
    assert f"\ndef {name}(" in text


def test_the_page_has_every_case() -> None:
    page = (DOCS / "conformance.md").read_text(encoding="utf-8")
    told = re.findall(r"^\|.*?\*\*(.+?)\*\*.*?\b(pass|FAIL)\b", page, re.M)
    assert [title for title, _ in told] == [
        each.title for each in (*CASES, *SAMPLES)
    ], "run make conformance"
    assert {verdict for _, verdict in told} == {"pass"}
    for test in ELSEWHERE.values():
        assert f"`{test}`" in page, "run make conformance"
    for name in re.findall(r"\((images/.*?)\)", page):
        assert (DOCS / name).is_file()
