"""Reads pictures to look at or to compare: PNG, JPEG and EXR files."""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.core.decode import decode_image
from moka.core.encoded_image import EncodedImage
from moka.core.errors import ImageFileError

__all__ = ["DISPLAY_SUFFIXES", "RADIANCE_SUFFIXES", "Picture", "read_picture"]

DISPLAY_SUFFIXES: Sequence[str] = (".png", ".jpg", ".jpeg")
RADIANCE_SUFFIXES: Sequence[str] = (".exr",)


@dataclass(frozen=True)
class Picture:
    """What a picture file holds, with where it came from.

    ``pixels`` are float32 (H, W, 4), top row first. Either they are
    ``linear`` Rec.709 radiance with associated alpha, as in an EXR file, or
    what a display is sent: sRGB-encoded, 0..1, alpha not associated.
    """

    path: Path
    pixels: NDArray[np.float32]
    linear: bool

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.pixels.shape[1], self.pixels.shape[0]

    def shown(
        self, tone_map: str = "neutral", exposure: float = 0.0
    ) -> "Picture":
        """The picture as a display is sent it.

        Radiance goes the way of ``moka render``'s PNG files, rounding to 8
        bits included: exposed, tone mapped, sRGB-encoded. A picture for a
        display stays as it is. Raises OptionError for an unknown tone map.
        """
        if not self.linear:
            return self
        from moka.core.image import Image

        codes = Image(self.pixels).to_display(tone_map, exposure)
        return Picture(self.path, _to_unit(codes), linear=False)


def read_picture(path: str | os.PathLike[str]) -> Picture:
    """Read a .png, .jpg, .jpeg or .exr file.

    Grey becomes RGB, and alpha 1 where the file has none; of an EXR file
    only the colour of its first part is read. Raises ImageFileError for
    another ending and for anything missing, broken or not finite.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix in RADIANCE_SUFFIXES:
        from moka.core.exr import read_exr

        pixels, _ = read_exr(path)
        _require_finite(path, pixels)
        return Picture(path, pixels, linear=True)
    if suffix not in DISPLAY_SUFFIXES:
        raise ImageFileError(
            f"{path}: cannot read pictures of this kind; use "
            f"{', '.join((*DISPLAY_SUFFIXES, *RADIANCE_SUFFIXES))}"
        )
    texels = decode_image(EncodedImage(str(path), data=_bytes_of(path)))
    return Picture(path, _to_unit(_to_rgba(texels)), linear=False)


def _bytes_of(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise ImageFileError(
            f"{path}: cannot read the picture: {error.strerror}"
        ) from error


def _to_rgba(texels: NDArray[Any]) -> NDArray[Any]:
    height, width, channels = texels.shape
    rgba = np.full((height, width, 4), np.iinfo(texels.dtype).max, texels.dtype)
    has_alpha = channels in (2, 4)
    rgba[:, :, :3] = texels[:, :, : channels - has_alpha]
    if has_alpha:
        rgba[:, :, 3] = texels[:, :, -1]
    return rgba


def _to_unit(codes: NDArray[Any]) -> NDArray[np.float32]:
    return codes.astype(np.float32) / np.float32(np.iinfo(codes.dtype).max)


def _require_finite(path: Path, pixels: NDArray[np.float32]) -> None:
    broken = ~np.isfinite(pixels).all(axis=2)
    if broken.any():
        row, column = np.argwhere(broken)[0]
        raise ImageFileError(
            f"{path}: pixels that are not finite: "
            f"{np.count_nonzero(broken)}, the first in column {column} of "
            f"row {row}"
        )
