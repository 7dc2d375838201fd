"""A hook of the documentation's build: the table of glTF extensions.

It is made from the one that the model reader consults, so that the page
cannot say anything else.
"""

from typing import Any

from moka.model.extensions import SUPPORTED_EXTENSIONS

_MARK = "<!-- supported extensions -->"


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Called by mkdocs with the text of each page."""
    if _MARK not in markdown:
        return markdown
    rows = [
        f"| `{name}` | {meaning} |"
        for name, meaning in sorted(SUPPORTED_EXTENSIONS.items())
    ]
    table = "\n".join(
        ["| extension | what it brings |", "| --- | --- |", *rows]
    )
    return markdown.replace(_MARK, table)
