"""Compares two pictures of the same thing, by numbers and by a picture.

Two EXR files are compared as linear radiance. As soon as one of the two is
a PNG or JPEG file, both are compared as a display shows them, sRGB-encoded
in 0..1; an EXR file is tone mapped for that just as ``moka render`` does.

A pixel that is not opaque has the colour it gives to a black background,
and its alpha is one more value to compare. FLIP knows no alpha: it looks at
both pictures over black and over white, and each pixel counts with the
larger error.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from moka.bench.flip import flip_display, flip_radiance, magma
from moka.bench.metrics import psnr, relative_rmse, rmse
from moka.core.colour import encode_srgb8
from moka.core.errors import ImageFileError, OptionError
from moka.core.exr import write_exr
from moka.core.picture_file import Picture, read_picture
from moka.core.png import write_png

__all__ = ["METRICS", "Comparison", "compare_files", "compare_pictures"]

Pixels: TypeAlias = NDArray[np.float32]

METRICS = ("flip", "psnr", "rmse", "rel-rmse")


@dataclass(frozen=True)
class Comparison:
    """How a picture differs from a reference.

    ``values`` hold what was asked for, by the names of METRICS: ``flip``
    the mean error of 0..1; ``psnr`` in decibel, its peak 1 or, for
    radiance, the largest value of the reference's colours; ``rmse`` in the
    unit of the pictures; ``rel-rmse`` that over the root mean square of the
    reference. ``difference`` is float32: the errors (H, W) of FLIP if it
    was asked for, else the absolute difference (H, W, 3) of the colours.
    """

    values: dict[str, float]
    difference: Pixels
    linear: bool

    def save_difference(self, path: str | os.PathLike[str]) -> None:
        """Write the difference as a .png or .exr file.

        An .exr holds the numbers. A .png shows FLIP's errors in the colour
        map magma, from black for 0 to pale yellow for 1, and an absolute
        difference as it is, radiance sRGB-encoded and 1 or more white.
        Raises ImageFileError for another ending and when it cannot be
        written.
        """
        suffix = Path(path).suffix.lower()
        if suffix == ".exr":
            write_exr(path, np.broadcast_to(_rgb(self.difference), self._shape))
        elif suffix == ".png":
            write_png(path, self._coloured())
        else:
            raise ImageFileError(
                f"{os.fspath(path)}: cannot write a difference of this kind; "
                "use .png or .exr"
            )

    @property
    def _shape(self) -> tuple[int, int, int]:
        return (*self.difference.shape[:2], 3)

    def _coloured(self) -> NDArray[np.uint8]:
        if self.difference.ndim == 2:
            return magma(self.difference)
        if self.linear:
            return encode_srgb8(self.difference)
        codes: NDArray[np.uint8] = np.rint(255.0 * self.difference).astype(
            np.uint8
        )
        return codes


def compare_files(
    reference: str | os.PathLike[str],
    test: str | os.PathLike[str],
    metrics: Sequence[str] = METRICS,
    *,
    tone_map: str = "neutral",
    exposure: float = 0.0,
) -> Comparison:
    """:func:`compare_pictures` of two files; raises ImageFileError too."""
    return compare_pictures(
        read_picture(reference),
        read_picture(test),
        metrics,
        tone_map=tone_map,
        exposure=exposure,
    )


def compare_pictures(
    reference: Picture,
    test: Picture,
    metrics: Sequence[str] = METRICS,
    *,
    tone_map: str = "neutral",
    exposure: float = 0.0,
) -> Comparison:
    """Compare ``test`` with ``reference`` by each of ``metrics``.

    ``tone_map`` and ``exposure`` (EV) are those of an EXR file that is
    compared with a picture for displays. Raises OptionError for pictures of
    different sizes, for an unknown metric or tone map, and for FLIP where
    the package flip-evaluator is missing.
    """
    for name in metrics:
        if name not in METRICS:
            raise OptionError(
                f"unknown metric {name!r}; known are {', '.join(METRICS)}"
            )
    if reference.size != test.size:
        raise OptionError(
            f"{test.path}: is {_size(test)}, but {reference.path} is "
            f"{_size(reference)}; only pictures of one size can be compared"
        )
    linear = reference.linear and test.linear
    if not linear:
        reference = reference.shown(tone_map, exposure)
        test = test.shown(tone_map, exposure)
    first, second = _associated(reference), _associated(test)
    # Opaque alphas would only dilute the error of the colours.
    opaque = bool((first[:, :, 3] == 1).all() and (second[:, :, 3] == 1).all())
    compared = (
        (first[:, :, :3], second[:, :, :3]) if opaque else (first, second)
    )

    values: dict[str, float] = {}
    difference = np.abs(second - first)[:, :, :3]
    for name in metrics:
        if name == "flip":
            difference = _flip(first, second, linear=linear, opaque=opaque)
            values[name] = float(difference.mean(dtype=np.float64))
        elif name == "psnr":
            peak = float(first[:, :, :3].max()) if linear else 1.0
            values[name] = psnr(*compared, peak)
        elif name == "rmse":
            values[name] = rmse(*compared)
        else:
            values[name] = relative_rmse(*compared)
    return Comparison(values, difference, linear)


def _flip(
    first: Pixels, second: Pixels, *, linear: bool, opaque: bool
) -> Pixels:
    flip = flip_radiance if linear else flip_display
    errors = flip(first[:, :, :3], second[:, :, :3])
    if opaque:
        return errors
    return np.maximum(errors, flip(_over_white(first), _over_white(second)))


def _over_white(pixels: Pixels) -> Pixels:
    return pixels[:, :, :3] + (1 - pixels[:, :, 3:])


def _associated(picture: Picture) -> Pixels:
    if picture.linear:
        return picture.pixels
    # A display's picture is blended as it is encoded, as viewers do.
    pixels = picture.pixels.copy()
    pixels[:, :, :3] *= pixels[:, :, 3:]
    return pixels


def _rgb(values: Pixels) -> Pixels:
    return values if values.ndim == 3 else values[:, :, np.newaxis]


def _size(picture: Picture) -> str:
    width, height = picture.size
    return f"{width} x {height}"
