"""OpenEXR files: linear radiance and further layers, through OpenEXR.

Layers are named ``normal.XYZ``: what stands behind the last dot are the
channels ``normal.X``, ``normal.Y`` and ``normal.Z`` of the file. A name
without a dot is one channel.
"""

import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from moka.core.atomic_file import image_file
from moka.core.errors import ImageFileError

__all__ = ["EXR_COMPRESSIONS", "read_exr", "store_exr", "write_exr"]

Layers: TypeAlias = Mapping[str, NDArray[Any]]

#: The names that OpenEXR has for them; the last three lose precision.
EXR_COMPRESSIONS = {
    "none": "NO_COMPRESSION",
    "rle": "RLE_COMPRESSION",
    "zips": "ZIPS_COMPRESSION",
    "zip": "ZIP_COMPRESSION",
    "piz": "PIZ_COMPRESSION",
    "pxr24": "PXR24_COMPRESSION",
    "b44": "B44_COMPRESSION",
    "dwaa": "DWAA_COMPRESSION",
}

_LARGEST_HALF = 65504.0

_MAGIC = b"\x76\x2f\x31\x01"

#: More pixels than this are a broken header rather than a picture.
_MOST_PIXELS = 1 << 28

#: By the number that stands for them in the file.
_PIXEL_TYPES = (np.uint32, np.float16, np.float32)

#: Orders in which the channels of a layer are put together.
_CHANNEL_ORDERS = ("RGBA", "XYZ", "UVW")


def write_exr(
    path: str | os.PathLike[str],
    pixels: NDArray[np.floating[Any]],
    *,
    half: bool = False,
    compression: str | None = None,
    layers: Layers | None = None,
) -> None:
    """Write linear RGB or RGBA ``pixels`` of shape (H, W, 3 or 4).

    They are stored as float32, or as half floats, which end at 65504.
    ``layers`` are (H, W) or (H, W, C) of float32, float16 or uint32 and are
    stored as such. Without ``compression`` (one of EXR_COMPRESSIONS) half
    floats are zipped, to about a third of their size, and float32 is not:
    its mantissas shrink to 0.6 of their size in seven times the time.
    A file at ``path`` is replaced at once or not at all. Raises
    ImageFileError when it cannot be written.
    """
    with image_file(path) as temporary:
        store_exr(
            temporary,
            pixels,
            half=half,
            compression=compression,
            layers=layers,
        )


def store_exr(
    path: Path,
    pixels: NDArray[np.floating[Any]],
    *,
    half: bool = False,
    compression: str | None = None,
    layers: Layers | None = None,
) -> None:
    """:func:`write_exr` straight into ``path``; raises OSError."""
    import OpenEXR

    compression = compression or ("zip" if half else "none")
    if compression not in EXR_COMPRESSIONS:
        raise ValueError(f"unknown EXR compression {compression!r}")
    height, width, count = pixels.shape
    if half:
        pixels = np.clip(pixels, -_LARGEST_HALF, _LARGEST_HALF)
    stored = pixels.astype(np.float16 if half else np.float32, copy=False)
    # The library ignores strides: what it gets has to be contiguous.
    channels = {"RGBA"[:count]: np.ascontiguousarray(stored)}
    for name, layer in (layers or {}).items():
        if layer.shape[:2] != (height, width):
            raise ValueError(f"layer {name!r} has another size")
        planes = np.atleast_3d(layer)
        for index, channel in enumerate(_channel_names(name)):
            channels[channel] = np.ascontiguousarray(planes[:, :, index])
    header = {
        "compression": getattr(OpenEXR, EXR_COMPRESSIONS[compression]),
        "type": OpenEXR.scanlineimage,
    }
    try:
        OpenEXR.File(header, channels).write(str(path))
    except RuntimeError as error:
        raise OSError(_reason(error)) from error


def read_exr(
    path: str | os.PathLike[str],
) -> tuple[NDArray[np.float32], dict[str, NDArray[Any]]]:
    """The RGBA pixels (H, W, 4) of a file's first part, and its layers.

    Pixels are linear float32, top row first, of the data window; a file of
    luminance only (``Y``) becomes grey, one without alpha opaque. Layers
    are float32 or uint32, (H, W) or (H, W, C). Raises ImageFileError for
    what is missing, broken, deep, or has subsampled channels.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            if file.read(len(_MAGIC)) != _MAGIC:
                raise ValueError("it does not begin as one")
        with _silent_library():
            channels = _read_channels(path)
    except FileNotFoundError as error:
        raise ImageFileError(f"{path}: no such file") from error
    # What the library raises depends on where in a file it fails.
    except (OSError, RuntimeError, TypeError, ValueError) as error:
        raise ImageFileError(
            f"{path}: not a readable EXR file: {_reason(error)}"
        ) from error

    shape = next(iter(channels.values())).shape
    pixels = np.ones((*shape, 4), np.float32)
    grey = channels.pop("Y", None)
    found = grey is not None
    for index, name in enumerate("RGBA"):
        plane = channels.pop(name, None)
        found |= plane is not None and name != "A"
        if plane is not None:
            pixels[:, :, index] = plane
        elif name != "A":
            pixels[:, :, index] = 0.0 if grey is None else grey
    if not found:
        raise ImageFileError(
            f"{path}: has none of the channels R, G, B and Y, but "
            f"{', '.join(sorted(channels)) or 'alpha only'}"
        )
    return pixels, _join_layers(channels)


def _read_channels(path: Path) -> dict[str, NDArray[Any]]:
    import OpenEXR

    try:
        file = OpenEXR.InputFile(str(path))
    except OSError as error:
        raise ValueError("its header is broken") from error
    header = file.header()
    window = header["dataWindow"]
    width = window.max.x - window.min.x + 1
    height = window.max.y - window.min.y + 1
    if not 0 < width * height <= _MOST_PIXELS:
        raise ValueError(f"its size of {width} x {height} is not plausible")
    if not file.isComplete():
        raise ValueError("it ends too early")
    descriptions = header["channels"]
    if any(
        (channel.xSampling, channel.ySampling) != (1, 1)
        for channel in descriptions.values()
    ):
        raise ValueError("subsampled channels are not supported")
    channels = {}
    for name, description in descriptions.items():
        dtype = _PIXEL_TYPES[description.type.v]
        plane = np.frombuffer(file.channel(name), dtype)
        if dtype == np.float16:
            plane = plane.astype(np.float32)
        channels[name] = plane.reshape(height, width)
    return channels


def _channel_names(layer: str) -> list[str]:
    prefix, dot, letters = layer.rpartition(".")
    return [f"{prefix}.{letter}" for letter in letters] if dot else [layer]


def _join_layers(channels: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Channels of one layer as one array, the reverse of _channel_names."""
    layers: dict[str, NDArray[Any]] = {}
    suffixes: dict[str, list[str]] = {}
    for name in channels:
        prefix, dot, suffix = name.rpartition(".")
        if dot and len(suffix) == 1:
            suffixes.setdefault(prefix, []).append(suffix)
        else:
            layers[name] = channels[name]
    for prefix, letters in suffixes.items():
        order = "".join(sorted(letters))
        for known in _CHANNEL_ORDERS:
            if set(letters) <= set(known):
                order = "".join(c for c in known if c in letters)
        planes = [channels[f"{prefix}.{letter}"] for letter in order]
        joined = planes[0] if len(planes) == 1 else np.dstack(planes)
        layers[f"{prefix}.{order}"] = joined
    return layers


def _reason(error: Exception) -> str:
    """What an error says, without the file name that OpenEXR puts first."""
    text: str = getattr(error, "strerror", None) or str(error)
    return text.rpartition('". ')[2].rstrip(".")


@contextmanager
def _silent_library() -> Iterator[None]:
    """Keeps OpenEXR from printing a broken file's errors itself.

    It writes them to the process's standard error, beside raising them.
    """
    sys.stderr.flush()
    try:
        saved = os.dup(2)
    except OSError:  # there is no standard error that could be written to
        yield
        return
    try:
        with Path(os.devnull).open("wb") as nowhere:
            os.dup2(nowhere.fileno(), 2)
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)
