"""URIs of glTF buffers and images: data URIs and relative file names.

Sources: RFC 2397 (data URIs), glTF 2.0 section 2.8 (URIs): only data URIs
and relative paths are read; nothing is ever fetched from a network.
"""

import binascii
import re
from base64 import b64decode
from pathlib import Path
from urllib.parse import unquote, unquote_to_bytes

__all__ = ["UriError", "decode_data_uri", "is_data_uri", "quote", "resolve"]

_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")


class UriError(ValueError):
    """What is wrong with a URI, to be completed with where it stands."""


def is_data_uri(uri: str) -> bool:
    """Whether ``uri`` carries its data in itself."""
    return uri[:5].lower() == "data:"


def decode_data_uri(uri: str) -> bytes:
    """The data of a base64 or percent-encoded data URI.

    Raises UriError if it is cut off or not base64.
    """
    header, comma, body = uri.partition(",")
    if not comma:
        raise UriError(f"the data URI {quote(uri)} has no comma")
    if not header.lower().endswith(";base64"):
        return unquote_to_bytes(body)
    if "%" in header or "%" in body:
        body = unquote(body)
    try:
        return b64decode(body, validate=True)
    except (binascii.Error, ValueError) as error:
        reason = str(error).removesuffix(".").lower()
        raise UriError(
            f"the data URI {quote(uri)} is not base64: {reason}"
        ) from error


def resolve(uri: str, folder: Path | None) -> Path:
    """The file that a relative ``uri`` names, seen from ``folder``.

    Raises UriError for absolute paths and other schemes, or if the model
    came from memory and has no folder.
    """
    name = unquote(uri)
    scheme = _SCHEME.match(uri) or _SCHEME.match(name)
    if scheme:
        raise UriError(
            f"the URI {quote(uri)} has the scheme {scheme[0]!r}; only data "
            "URIs and relative paths are read"
        )
    if name.startswith(("/", "\\")):
        raise UriError(
            f"the URI {quote(uri)} is absolute; make it relative to the model"
        )
    if not name or "\0" in name:
        raise UriError(f"the URI {quote(uri)} names no file")
    if folder is None:
        raise UriError(
            f"the URI {quote(uri)} is relative, but a model from memory has "
            "no folder; load it from its path or embed the data"
        )
    return folder / name


def quote(text: str) -> str:
    """``text`` in quotes on one line, cut off if it is long."""
    return repr(text if len(text) <= 64 else text[:60] + "...")
