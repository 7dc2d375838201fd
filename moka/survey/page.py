"""Builds the page of a survey: one HTML file that asks for nothing else.

Style and script stand in the page itself, and its content security policy
forbids everything but these two, by their hashes, and pictures of its own
folder: the page cannot send anything anywhere.
"""

import base64
import hashlib
import html
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources

__all__ = ["SURROUND", "Page", "build_page"]

#: The grey around the pictures, sRGB-encoded: neutral, as dim as a room in
#: which a monitor is looked at, and bright text on it is easy to read.
SURROUND = 0x2E / 255


@dataclass(frozen=True)
class Page:
    """What a page shows.

    ``sets`` are the file names of the pictures that are shown together,
    ``sizes`` the width and height of each file.
    """

    survey: str
    title: str
    notice: str
    contact: str
    credits: Sequence[str]
    sets: Sequence[Sequence[str]]
    sizes: Mapping[str, tuple[int, int]]


def build_page(page: Page) -> str:
    """The HTML text of ``page``."""
    code = round(255 * SURROUND)
    style = _read("page.css").replace(
        "SURROUND", f"#{code:02x}{code:02x}{code:02x}"
    )
    script = _read("page.js")
    fields = {
        "POLICY": (
            "default-src 'none'; img-src 'self' file:; base-uri 'none'; "
            f"form-action 'none'; style-src '{_hash(style)}'; "
            f"script-src '{_hash(script)}'"
        ),
        "TITLE": html.escape(page.title),
        "STYLE": style,
        "SCRIPT": script,
        "DATA": _data(page),
        "NOTICE": _paragraphs(page.notice),
        "COUNT": str(len(page.sets)),
        "PAGES": "page" if len(page.sets) == 1 else "pages",
        "CONTACT": html.escape(page.contact or "whoever gave you this survey"),
        "CREDITS": _credits(page.credits),
    }
    return re.sub(
        r"\{\{([A-Z]+)\}\}", lambda match: fields[match[1]], _read("page.html")
    )


def _read(name: str) -> str:
    return resources.files("moka.survey").joinpath(name).read_text("utf-8")


def _hash(text: str) -> str:
    """The source expression of Content Security Policy level 3, 2.3.1."""
    digest = hashlib.sha256(text.encode()).digest()
    return f"sha256-{base64.b64encode(digest).decode()}"


def _data(page: Page) -> str:
    data = {
        "survey": page.survey,
        "sets": [
            [
                {
                    "name": name,
                    "width": page.sizes[name][0],
                    "height": page.sizes[name][1],
                }
                for name in each
            ]
            for each in page.sets
        ],
    }
    # No text can end the element that it stands in.
    return json.dumps(data).replace("<", "\\u003c")


def _paragraphs(text: str) -> str:
    blocks = (block.strip() for block in re.split(r"\n\s*\n", text))
    return "\n".join(
        f"<p>{html.escape(block)}</p>" for block in blocks if block
    )


def _credits(lines: Sequence[str]) -> str:
    if not lines:
        return ""
    items = "\n".join(f"<li>{html.escape(line)}</li>" for line in lines)
    return f"<h2>Credits</h2>\n<ul>\n{items}\n</ul>"
