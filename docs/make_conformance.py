"""Renders the cases of tests/conformance and writes docs/conformance.md.

Run by `make conformance`, from anywhere. Nothing on the page is written by
hand that was not measured while it was made.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

DOCS = Path(__file__).resolve().parent
# The cases belong to the tests, which run them too.
sys.path.insert(0, str(DOCS.parent))

from moka.core.colour import encode_srgb8  # noqa: E402
from moka.model import load_model  # noqa: E402
from tests.conformance.case import SIZE, Case, Outcome  # noqa: E402
from tests.conformance.elsewhere import ELSEWHERE  # noqa: E402
from tests.conformance.features import FEATURES  # noqa: E402
from tests.conformance.samples import (  # noqa: E402
    DEPTH_ERROR,
    RAYS,
    SAMPLES,
    Sample,
)

ASSETS = DOCS.parents[1] / "shared" / "assets"
PICTURES = DOCS / "images" / "conformance"
GAP = 8

INTRODUCTION = f"""\
# Conformance

What glTF files must look like, and what moka makes of them. Each row is a
small file that `tests/conformance` writes with pygltflib: on the left moka's
picture of it, beside it the expectation, which is made without moka's
renderer wherever that is possible. *Painted* is a formula that gives the
radiance of every pixel in float64; otherwise it is the picture of another
file, which says the same in plainer words.

The figure is how many of {SIZE} x {SIZE} pixels have a linear radiance that
is further off than the tolerance in any channel. This page was made by `make
conformance`, which rendered every picture and computed every figure and every
verdict; `tests/gpu/test_conformance.py` holds the same cases to the same
bounds whenever the tests run.
"""

SAMPLE_INTRODUCTION = f"""\
## Sample models

Depth and base colour of real models, posed by their animations, against rays
in float64: `tests/support/oracles/ray_caster.py` reads a file with pygltflib,
poses its triangles by the formulas of the specification and asks for each of
{RAYS} x {RAYS} pixels which of them is hit first. The first figure is the
share of the model's pixels whose depth is off by more than {DEPTH_ERROR:.1%}
or that only one of the two has; the second is by how much base colours differ
on average, as means of three by three pixels. Lighting is not part of it.
What a file says beyond that and moka leaves out is in the last but one column.
"""

CREDITS = """
Base colours again, moka's and those of the rays, of the models that are in
the public domain:
"""


def main() -> None:
    """Run every case; a failing one is shown as such, and is an error."""
    if not ASSETS.is_dir():
        sys.exit(f"the sample models are not in {ASSETS}")
    PICTURES.mkdir(parents=True, exist_ok=True)
    for old in PICTURES.glob("*.png"):
        old.unlink()
    failed = []
    parts = []
    for subject, cases in FEATURES.items():
        rows = []
        for case in cases:
            outcome = case.run()
            if not outcome.passed:
                failed.append(case.title)
            rows.append(case_row(case, outcome))
        head = "moka, expectation | what one must see "
        parts.append(f"## {subject}\n\n{table(head, rows)}")
    rows, shown = [], []
    for sample in SAMPLES:
        outcome = sample.run(ASSETS)
        if not outcome.passed:
            failed.append(sample.title)
        rows.append(sample_row(sample, outcome))
        # Pictures of the others are not ours to give away.
        if sample.credit:
            text = f"{sample.title}, {sample.credit}"
            shown.append(f"| {picture(sample.title, outcome)} | {text} |")
    head = "model | what | depth off | colour off | left out | "
    parts.append(SAMPLE_INTRODUCTION + "\n" + table(head, rows))
    parts.append(CREDITS.lstrip() + "\n" + table("moka, rays | model ", shown))
    parts.append(elsewhere())
    count = sum(map(len, FEATURES.values())) + len(SAMPLES)
    summary = f"{count - len(failed)} of {count} cases pass.\n"
    page = "\n".join([INTRODUCTION, summary, *parts])
    (DOCS / "conformance.md").write_text(page, encoding="utf-8")
    print(summary, end="")
    if failed:
        sys.exit("failed: " + ", ".join(failed))


def elsewhere() -> str:
    """A table of claims and their tests, which say pass or fail."""
    rows = [f"| {claim} | `{test}` |" for claim, test in ELSEWHERE.items()]
    return (
        "## What no single picture shows\n\nThese are held by other tests.\n\n"
        + table("what | test ", rows)
    )


def table(head: str, rows: list[str]) -> str:
    """Markdown of a table."""
    rule = " --- |" * (head.count("|") + 1)
    return "\n".join([f"| {head}|", f"|{rule}", *rows, ""])


def case_row(case: Case, outcome: Outcome) -> str:
    """A line of a table, and its picture."""
    compared = (SIZE // case.block) ** 2
    off = round(outcome.differing * compared)
    allowed = round(case.allowed * compared)
    of = "pixels" if case.block == 1 else f"of {compared} means"
    lines = [
        f"**{case.title}**: {verdict(outcome)}",
        f"{case.sees[0].upper()}{case.sees[1:]}.",
        f"Expected: {case.by}.",
        f"{off} {of} off by more than {case.tolerance:g}, allowed {allowed}.",
    ]
    return f"| {picture(case.title, outcome)} | {'<br>'.join(lines)} |"


def sample_row(sample: Sample, outcome: Outcome) -> str:
    """A line of the table of samples."""
    model = load_model(ASSETS / "models" / sample.path)
    cells = [
        f"**{sample.title}**",
        sample.shows,
        f"{outcome.differing:.3%}, allowed {sample.allowed:.1%}",
        f"{outcome.mean:.4f}, allowed {sample.colour:g}",
        ", ".join(f"`{name}`" for name in model.unsupported_extensions),
        verdict(outcome),
    ]
    return "| " + " | ".join(cells) + " |"


def verdict(outcome: Outcome) -> str:
    """How the check ended."""
    return "pass" if outcome.passed else "FAIL"


def picture(title: str, outcome: Outcome) -> str:
    """Markdown of the two pictures, which are written."""
    name = "-".join(filter(None, map(alphanumeric, title.split())))
    pair = (displayed(outcome.picture), displayed(outcome.expected))
    gap = np.full((len(pair[0]), GAP, 3), 255, np.uint8)
    both = Image.fromarray(np.hstack([pair[0], gap, pair[1]]))
    both.save(PICTURES / f"{name}.png", optimize=True)
    # A table would shrink it to a stamp.
    style = '{ style="max-width: none" }'
    return f"![{title}](images/conformance/{name}.png){style}"


def alphanumeric(word: str) -> str:
    """What of a word a file name may have."""
    return "".join(c for c in word.lower() if c.isalnum() or c == "_")


def displayed(radiance: NDArray[np.float64]) -> NDArray[np.uint8]:
    """sRGB, neither exposed nor tone mapped."""
    return encode_srgb8(np.clip(radiance, 0, 1).astype(np.float32))


if __name__ == "__main__":
    main()
