"""A hook of the documentation's build: shows Sphinx roles as code.

Docstrings say ``:class:`Model``` where an editor can follow the name; in
Markdown the role would stand in the text as it is.
"""

import re
from typing import Any

_ROLE = re.compile(r":(?:attr|class|data|func|meth|mod):(?=<code>)")


def on_page_content(html: str, **_: Any) -> str:
    """Called by mkdocs with the content of each page."""
    return _ROLE.sub("", html)
