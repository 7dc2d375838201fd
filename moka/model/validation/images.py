"""Images: that they are there, and what they say they are.

Only headers are read; texels are not decoded.
"""

from typing import Any

from moka.core.errors import ModelError
from moka.model.container import read_file
from moka.model.uri import UriError, decode_data_uri, is_data_uri, resolve
from moka.model.validation.context import CheckedFile
from moka.model.validation.issues import Place

__all__ = ["check_images"]

_FORMATS = {
    b"\x89PNG\r\n\x1a\n": "image/png",
    b"\xff\xd8\xff": "image/jpeg",
    b"\xabKTX 20\xbb\r\n\x1a\n": "image/ktx2",
}
_CORE = ("image/jpeg", "image/png")
# What images of other kinds need.
_EXTENSIONS = {
    "image/webp": "EXT_texture_webp",
    "image/avif": "EXT_texture_avif",
    "image/ktx2": "KHR_texture_basisu",
}


def check_images(file: CheckedFile) -> None:
    """Check all images and the textures that use them."""
    used = file.document.get("extensionsUsed")
    used = used if isinstance(used, list) else []
    for number, image in file.all("images"):
        _check_image(file, image, ("images", number), used)
    for number, texture in file.all("textures"):
        source = file.get("images", texture.get("source"))
        kind = source.get("mimeType") if source else None
        if isinstance(kind, str) and kind not in _CORE:
            file.add(
                "TEXTURE_INVALID_IMAGE_MIME_TYPE",
                ("textures", number, "source"),
                f"images[{texture['source']}] is {kind}, which needs an "
                "extension",
            )


def _check_image(
    file: CheckedFile, image: dict[str, Any], place: Place, used: list[Any]
) -> None:
    uri, kind = image.get("uri"), image.get("mimeType")
    if ("uri" in image) == ("bufferView" in image):
        file.add("ONE_OF_MISMATCH", place, "needs either bufferView or uri")
    known = kind in _CORE or _EXTENSIONS.get(str(kind)) in used
    if isinstance(kind, str) and not known:
        file.add(
            "VALUE_NOT_IN_LIST",
            (*place, "mimeType"),
            f"is {kind!r}, not one of {', '.join(_CORE)}",
        )
    if "bufferView" in image and kind is None:
        file.add(
            "UNSATISFIED_DEPENDENCY",
            (*place, "bufferView"),
            "needs mimeType beside it",
        )
    if isinstance(uri, str) and is_data_uri(uri) and file.is_container:
        file.add("DATA_URI_GLB", (*place, "uri"), "a .glb has a chunk for data")
    if ("uri" in image) == ("bufferView" in image):
        return
    data = _data(file, image, place)
    if data is None:
        return
    found = _format_of(data)
    if found is None:
        file.add("IMAGE_UNRECOGNIZED_FORMAT", place, "is no known format")
        return
    if isinstance(kind, str) and found != kind:
        name = "uri" if isinstance(uri, str) else "bufferView"
        file.add(
            "IMAGE_MIME_TYPE_INVALID",
            (*place, name),
            f"is {found}, not {kind} as mimeType says",
        )
    if found in _CORE and _ends_early(data, found):
        file.add("IMAGE_UNEXPECTED_EOS", place, "ends within its header")


def _data(
    file: CheckedFile, image: dict[str, Any], place: Place
) -> memoryview | None:
    uri = image.get("uri")
    if not isinstance(uri, str):
        _check_view(file, image, place)
        return file.view_bytes(image.get("bufferView"))
    try:
        if is_data_uri(uri):
            return memoryview(decode_data_uri(uri))
        return memoryview(read_file(resolve(uri, file.folder)))
    except (UriError, ModelError) as error:
        code = "INVALID_URI" if is_data_uri(uri) else "IO_ERROR"
        file.add(code, (*place, "uri"), str(error))
        return None


def _check_view(file: CheckedFile, image: dict[str, Any], place: Place) -> None:
    view = file.get("bufferViews", image.get("bufferView")) or {}
    where = (*place, "bufferView")
    if "byteStride" in view:
        file.add(
            "IMAGE_BUFFER_VIEW_WITH_BYTESTRIDE",
            where,
            "the buffer view of an image must not have a stride",
        )
    if "target" in view:
        file.add(
            "BUFFER_VIEW_TARGET_OVERRIDE",
            where,
            "the buffer view is for vertices or indices",
        )


def _format_of(data: memoryview) -> str | None:
    start = bytes(data[:12])
    for magic, kind in _FORMATS.items():
        if start.startswith(magic):
            return kind
    if start[:4] == b"RIFF" and start[8:] == b"WEBP":
        return "image/webp"
    if start[4:12] in (b"ftypavif", b"ftypavis"):
        return "image/avif"
    return None


def _ends_early(data: memoryview, kind: str) -> bool:
    """Whether the header that tells the size is not whole."""
    if kind == "image/png":
        return len(data) < 33
    return len(data) < 4
