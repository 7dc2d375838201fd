"""What kind of image bytes are, and its pixel size, without decoding it.

Sources: ISO/IEC 15948 (PNG), section 11.2.1; ITU-T T.81 (JPEG), annex B; the
headers of other formats are read by the module next to this.
"""

from collections.abc import Callable
from typing import TypeVar

from moka.core.encoded_image import EncodedImage
from moka.core.errors import ImageFileError

__all__ = [
    "has_deep_texels",
    "image_media_type",
    "media_type",
    "pixel_size",
]

_PNG = b"\x89PNG\r\n\x1a\n"
_JPEG = b"\xff\xd8\xff"
# Start of frame, all coding processes; C4, C8 and CC are other segments.
_FRAMES = {*range(0xC0, 0xD0)} - {0xC4, 0xC8, 0xCC}

Read = Callable[[int, int], bytes]
_Answer = TypeVar("_Answer")


def media_type(data: bytes | memoryview) -> str | None:
    """The media type of what moka decodes, None if ``data`` is nothing of it.

    PNG and JPEG are glTF's own, the others come with extensions.
    """
    head = bytes(data[:32])
    if head.startswith(_PNG):
        return "image/png"
    if head.startswith(_JPEG):
        return "image/jpeg"
    from moka.core.extension_headers import extension_media_type

    return extension_media_type(head)


def image_media_type(image: EncodedImage) -> str | None:
    """:func:`media_type` of an image, of which no more than that is read."""
    return _ask(image, lambda read: media_type(read(0, 32)))


def pixel_size(image: EncodedImage) -> tuple[int, int] | None:
    """Width and height; None if the header is broken or of another format.

    Only headers are read. Raises ImageFileError if the file is gone.
    """
    return _ask(image, _size)


def has_deep_texels(image: EncodedImage) -> bool:
    """Whether its texels have 16 bits, which of all formats PNG's may have.

    Raises ImageFileError if the file is gone.
    """
    return _ask(image, _is_deep)


def _ask(image: EncodedImage, question: Callable[[Read], _Answer]) -> _Answer:
    """What ``question`` makes of the bytes at a place, read as needed."""
    if image.path is None:
        data = image.read()
        return question(lambda start, count: bytes(data[start : start + count]))
    try:
        with open(image.path, "rb") as file:

            def read(start: int, count: int) -> bytes:
                file.seek(start)
                return file.read(count)

            return question(read)
    except OSError as error:
        raise ImageFileError(
            f"{image.where}: cannot read {image.path}: {error.strerror}"
        ) from error


def _is_deep(read: Read) -> bool:
    head = read(0, 25)
    return head.startswith(_PNG) and head[24:] == b"\x10"


def _size(read: Read) -> tuple[int, int] | None:
    head = read(0, 24)
    if head.startswith(_PNG):
        if head[12:16] != b"IHDR" or len(head) < 24:
            return None
        return _integer(head[16:20]), _integer(head[20:24])
    if head.startswith(_JPEG):
        return _jpeg_size(read)
    from moka.core.extension_headers import extension_pixel_size

    return extension_pixel_size(read)


def _jpeg_size(read: Read) -> tuple[int, int] | None:
    """Walk the segments, whose lengths stand after their markers."""
    start = 2
    while len(segment := read(start, 9)) == 9 and segment[0] == 0xFF:
        if segment[1] == 0xFF:  # markers may be padded with FF
            start += 1
        elif segment[1] in _FRAMES:
            return _integer(segment[7:9]), _integer(segment[5:7])
        else:
            start += 2 + max(2, _integer(segment[2:4]))
    return None


def _integer(data: bytes) -> int:
    return int.from_bytes(data, "big")
