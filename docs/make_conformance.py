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
from tests.conformance.case import SIZE, Case, Outcome  # noqa: E402
from tests.conformance.features import FEATURES  # noqa: E402

PICTURES = DOCS / "images" / "conformance"
GAP = 8

INTRODUCTION = f"""\
# Conformance

What glTF files must look like, and what moka makes of them. Each row is a
small file that `tests/conformance` writes with pygltflib: on the left moka's
picture of it, on the right the expectation, which is made without moka's
renderer wherever that is possible. *Painted* is a formula that gives the
radiance of every pixel in float64; otherwise it is the picture of another
file, which says the same in plainer words.

The figure is the number of pixels, of {SIZE} x {SIZE}, whose linear radiance
is further off than the tolerance in any channel. This page was made by `make
conformance`, which rendered every picture and computed every figure and every
verdict; `tests/gpu/test_conformance.py` holds the same cases to the same
bounds whenever the tests run.
"""


def main() -> None:
    """Run every case; a failing one is shown as such, and is an error."""
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
            rows.append(row(case, outcome))
        parts.append(section(subject, rows))
    count = sum(map(len, FEATURES.values()))
    summary = f"{count - len(failed)} of {count} cases pass.\n"
    page = "\n".join([INTRODUCTION, summary, *parts])
    (DOCS / "conformance.md").write_text(page, encoding="utf-8")
    print(summary, end="")
    if failed:
        sys.exit("failed: " + ", ".join(failed))


def section(subject: str, rows: list[str]) -> str:
    """A table of cases."""
    head = "| what | moka, expectation | one must see | off | |"
    return "\n".join(
        [f"## {subject}\n", head, "| --- | --- | --- | --- | --- |", *rows, ""]
    )


def row(case: Case, outcome: Outcome) -> str:
    """A line of the table, and its picture."""
    name = "-".join(filter(None, map(alphanumeric, case.title.split())))
    pair = (displayed(outcome.picture), displayed(outcome.expected))
    gap = np.full((SIZE, GAP, 3), 255, np.uint8)
    picture = Image.fromarray(np.hstack([pair[0], gap, pair[1]]))
    picture.save(PICTURES / f"{name}.png", optimize=True)
    pixels = round(outcome.differing * SIZE**2)
    allowed = round(case.allowed * SIZE**2)
    cells = [
        case.title,
        f"![{case.title}](images/conformance/{name}.png)",
        f"{case.sees}. Expected: {case.by}.",
        f"{pixels} of at most {allowed} by {case.tolerance:g}",
        "pass" if outcome.passed else "**fail**",
    ]
    return "| " + " | ".join(cells) + " |"


def alphanumeric(word: str) -> str:
    """What of a word a file name may have."""
    return "".join(c for c in word.lower() if c.isalnum() or c == "_")


def displayed(radiance: NDArray[np.float64]) -> NDArray[np.uint8]:
    """sRGB, neither exposed nor tone mapped."""
    return encode_srgb8(np.clip(radiance, 0, 1).astype(np.float32))


if __name__ == "__main__":
    main()
