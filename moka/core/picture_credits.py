"""Authors and copyright that picture files carry as metadata."""

import io
import os
from pathlib import Path
from typing import Any

from moka.core.errors import ImageFileError

__all__ = ["picture_credits"]

#: Keywords of PNG text (PNG, third edition, 11.3.3.2).
_PNG_KEYWORDS = ("Author", "Copyright")

#: EXIF 2.32, 4.6.4 A: Artist and Copyright.
_EXIF_TAGS = (0x013B, 0x8298)

#: OpenEXR's standard optional attribute for the name of the owner.
_EXR_ATTRIBUTE = "owner"


def picture_credits(path: str | os.PathLike[str]) -> list[str]:
    """The author and the copyright of a .png, .jpg or .exr file, if any.

    Raises ImageFileError for a file that is missing or broken.
    """
    path = Path(path)
    try:
        if path.suffix.lower() == ".exr":
            found = _of_exr(path)
        else:
            found = _of_image(path.read_bytes())
    # On hostile bytes a decoder may raise nearly anything.
    except Exception as error:
        raise ImageFileError(
            f"{path}: cannot read the metadata: "
            f"{getattr(error, 'strerror', None) or error}"
        ) from error
    return [text.strip() for text in found if text.strip()]


def _of_image(data: bytes) -> list[str]:
    from PIL import JpegImagePlugin, PngImagePlugin

    if data.startswith(b"\xff\xd8\xff"):
        with JpegImagePlugin.JpegImageFile(io.BytesIO(data)) as jpeg:
            values: list[Any] = [jpeg.getexif().get(tag) for tag in _EXIF_TAGS]
    else:
        with PngImagePlugin.PngImageFile(io.BytesIO(data)) as png:
            # Text may also stand behind the pixels; this reads those too.
            values = [png.text.get(word) for word in _PNG_KEYWORDS]
    return [str(value) for value in values if value]


def _of_exr(path: Path) -> list[str]:
    import OpenEXR

    owner = OpenEXR.InputFile(str(path)).header().get(_EXR_ATTRIBUTE, b"")
    return [owner.decode("utf-8", "replace")]
