"""Renders the examples into docs/images/gallery and writes docs/gallery.md.

Run by `make gallery`, from anywhere.
"""

import ast
import importlib.util
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent
EXAMPLES = DOCS.parent / "examples"
PICTURES = DOCS / "images" / "gallery"
SIZE = (640, 360)

INTRODUCTION = """\
# Gallery

Each of these pictures is made by a short program in `examples/`, which the
tests run. `make gallery` renders them and writes this page.
"""


def main() -> None:
    """Render what is named, or everything, and write the page."""
    wanted = sys.argv[1:]
    PICTURES.mkdir(parents=True, exist_ok=True)
    parts = [INTRODUCTION]
    for path in sorted(EXAMPLES.glob("*.py")):
        if not wanted or path.stem in wanted:
            render(path)
        parts.append(section(path))
    (DOCS / "gallery.md").write_text("\n".join(parts), encoding="utf-8")


def render(path: Path) -> None:
    """The picture of one example."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.render(SIZE).save(PICTURES / f"{path.stem}.png")
    print(path.stem)


def section(path: Path) -> str:
    """Title, picture and text of one example, from its docstring."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
    assert text is not None, path
    title, _, rest = text.partition("\n\n")
    command, _, rest = rest.partition("\n\n")
    return (
        f"## {title.rstrip('.')}\n\n"
        f"![{title}](images/gallery/{path.stem}.png)\n\n"
        f"{rest}\n\n"
        f"```console\n$ {command.strip()}\n```\n"
    )


if __name__ == "__main__":
    main()
