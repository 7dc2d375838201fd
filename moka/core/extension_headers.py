"""Headers of the image formats that extensions of glTF bring.

Sources: WebP container specification (Google) and RFC 9649; AVIF 1.1 (AOM)
with ISO/IEC 14496-12 (boxes) and 23008-12 (ispe); KTX 2.0 (Khronos).
"""

from collections.abc import Callable, Iterator

__all__ = ["KTX2_IDENTIFIER", "extension_media_type", "extension_pixel_size"]

KTX2_IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"

_AVIF_BRANDS = (b"avif", b"avis")
# Boxes of which one of these is worth opening on the way to the sizes.
_AVIF_PATH = (b"meta", b"iprp", b"ipco")

Read = Callable[[int, int], bytes]


def extension_media_type(head: bytes) -> str | None:
    """The media type of a file that begins with ``head``, at least 32 bytes
    of it, None if it is of no such format."""
    if head[:4] == b"RIFF" and head[8:12] == b"WEBP":
        return "image/webp"
    if head.startswith(KTX2_IDENTIFIER):
        return "image/ktx2"
    if head[4:8] == b"ftyp" and any(
        head[start : start + 4] in _AVIF_BRANDS for start in range(8, 32, 4)
    ):
        return "image/avif"
    return None


def extension_pixel_size(read: Read) -> tuple[int, int] | None:
    """Width and height; ``read`` gives bytes from a place on.

    None if the header is broken or of another format.
    """
    head = read(0, 32)
    kind = extension_media_type(head)
    if kind == "image/webp":
        return _webp_size(head)
    if kind == "image/avif":
        return _avif_size(read)
    if kind == "image/ktx2" and len(head) >= 28:
        return _little(head[20:24]), _little(head[24:28])
    return None


def _webp_size(head: bytes) -> tuple[int, int] | None:
    if len(head) < 30:
        return None
    match head[12:16]:
        case b"VP8X":
            return 1 + _little(head[24:27]), 1 + _little(head[27:30])
        case b"VP8L":
            bits = _little(head[21:25])
            return 1 + (bits & 0x3FFF), 1 + (bits >> 14 & 0x3FFF)
        case b"VP8 ":
            # The upper two bits scale what a browser shows, not the texels.
            return _little(head[26:28]) & 0x3FFF, _little(head[28:30]) & 0x3FFF
    return None


def _avif_size(read: Read) -> tuple[int, int] | None:
    """The largest extents of any item: tiles of a grid are smaller."""
    start, end = 0, 1 << 63
    for name in _AVIF_PATH:
        found = next((box for box in _boxes(read, start, end, name)), None)
        if found is None:
            return None
        # The box of metadata has a version and flags before its children.
        start, end = found[0] + (4 if name == b"meta" else 0), found[1]
    sizes = [
        (_big(data[4:8]), _big(data[8:12]))
        for first, _ in _boxes(read, start, end, b"ispe")
        if len(data := read(first, 12)) == 12
    ]
    return max(sizes, key=lambda size: size[0] * size[1], default=None)


def _boxes(
    read: Read, start: int, end: int, name: bytes
) -> Iterator[tuple[int, int]]:
    """Where the contents of boxes called ``name`` begin and end."""
    while start < end and len(head := read(start, 16)) >= 8:
        size, header = _big(head[:4]), 8
        if size == 1:
            size, header = _big(head[8:16]), 16
        if size < header:  # 0 is a box that runs to the end of the file
            size = end - start if size == 0 else header
        if head[4:8] == name:
            yield start + header, start + size
        start += size


def _little(data: bytes) -> int:
    return int.from_bytes(data, "little")


def _big(data: bytes) -> int:
    return int.from_bytes(data, "big")
