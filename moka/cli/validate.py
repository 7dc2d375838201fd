"""Check a glTF file against the rules of the specification."""

import argparse
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from moka.model.validation.issues import Report

__all__ = ["add_arguments", "execute"]

INVALID = 1

#: A fault of an exporter is in every accessor of a file.
SHOWN = 5


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka validate``."""
    parser.add_argument(
        "model", metavar="MODEL", type=Path, help=".gltf or .glb file"
    )
    parser.add_argument(
        "--json", action="store_true", help="print JSON instead of text"
    )
    parser.add_argument(
        "--all",
        action="store_true",
        help=f"print every issue, not the first {SHOWN} of each kind",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print what is wrong; 1 if anything is an error, else 0.

    Raises ModelError for a file that cannot be read.
    """
    from moka.model.validation.validate import validate

    report = validate(arguments.model)
    if arguments.json:
        import json

        print(json.dumps(_as_json(report), indent=2))
    else:
        print(_as_text(arguments.model, report, all_of_them=arguments.all))
    return 0 if report.is_valid else INVALID


def _as_json(report: "Report") -> dict[str, object]:
    from moka.model.validation.issues import Severity

    return {
        "valid": report.is_valid,
        "counts": {
            severity.value: report.count(severity) for severity in Severity
        },
        "issues": [
            {
                "code": issue.code,
                "severity": issue.severity.value,
                "path": issue.path,
                "message": issue.message,
            }
            for issue in report.issues
        ],
    }


def _as_text(model: Path, report: "Report", *, all_of_them: bool) -> str:
    from moka.model.validation.issues import Severity

    lines = []
    seen = Counter[str]()
    of_code = Counter(issue.code for issue in report.issues)
    for issue in report.issues:
        seen[issue.code] += 1
        if all_of_them or seen[issue.code] <= SHOWN:
            lines.append(
                f"{issue.severity.value}: {issue.path or 'the file'}: "
                f"{issue.message} ({issue.code})"
            )
        elif seen[issue.code] == SHOWN + 1:
            more = of_code[issue.code] - SHOWN
            lines.append(f"    and {more} more of {issue.code}; see --all")
    counts = ", ".join(
        f"{report.count(severity)} {name}"
        for severity, name in (
            (Severity.ERROR, "errors"),
            (Severity.WARNING, "warnings"),
            (Severity.INFORMATION, "remarks"),
        )
    )
    verdict = "valid" if report.is_valid else "not valid"
    return "\n".join([*lines, f"{model}: {verdict}: {counts}"])
