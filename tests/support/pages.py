"""The pages that people read, and what these tell them to type."""

import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

__all__ = ["PAGES", "ROOT", "blocks", "command_lines", "id_of", "split"]

ROOT = Path(__file__).resolve().parents[2]
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *(
        path
        for path in sorted((ROOT / "docs").rglob("*.md"))
        if path.name not in ("changelog.md", "gallery.md")
    ),
]

_BLOCK = re.compile(
    r"(?:<!-- before:(?P<before>.*?)-->\s*)?"
    r"^```(?P<language>\w+)\n(?P<text>.*?)^```",
    re.DOTALL | re.MULTILINE,
)
# What stands indented, as in README, and begins like a command.
_INDENTED = re.compile(r"^    ((?:make|moka|pip) .*)$", re.MULTILINE)


def id_of(path: Path) -> str:
    return str(path.relative_to(ROOT))


def blocks(path: Path, *languages: str) -> list[re.Match[str]]:
    """Its blocks in one of these languages.

    A comment ``<!-- before: ... -->`` above one is Python: what a reader has
    in front of him there, but the page need not repeat.
    """
    text = path.read_text(encoding="utf-8")
    return [
        match
        for match in _BLOCK.finditer(text)
        if match["language"] in languages
    ]


def command_lines(path: Path) -> Iterator[tuple[str, str]]:
    """Its commands in order, each with the Python that comes before it.

    Those of consoles, and those that a Dockerfile and a pipeline would run.
    """
    if path.parent == ROOT:
        for line in _INDENTED.findall(path.read_text(encoding="utf-8")):
            yield line, ""
    for match in blocks(path, "console", "dockerfile", "yaml"):
        before = match["before"] or ""
        for line in _lines(match["language"], match["text"]):
            for command in line.split(" && "):
                yield command.strip(), before
                before = ""


def split(command: str) -> list[str]:
    """Its words, without a comment."""
    return shlex.split(command, comments=True)


def _lines(language: str, text: str) -> list[str]:
    joined = re.sub(r"\\\n\s*", " ", text)
    if language == "console":
        return re.findall(r"^\$ (.*)$", joined, re.MULTILINE)
    if language == "dockerfile":
        return re.findall(r"^RUN (.*)$", joined, re.MULTILINE)
    import yaml

    return list(_steps(yaml.safe_load(text)))


def _steps(node: Any) -> Iterator[str]:
    """What the steps of GitHub's and the scripts of GitLab's jobs run."""
    if isinstance(node, list):
        for each in node:
            yield from _steps(each)
    elif isinstance(node, dict):
        for key, value in node.items():
            if key in ("run", "script"):
                yield from [value] if isinstance(value, str) else value
            else:
                yield from _steps(value)
