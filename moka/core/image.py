"""A rendered picture: linear radiance, and how a display shows it."""

import os
from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.core.aov import exr_layer
from moka.core.atomic_file import image_file
from moka.core.colour import encode_srgb8
from moka.core.errors import ImageFileError, OptionError
from moka.core.png import encode_png

__all__ = ["Image"]

#: Rows tone mapped at a time, so that temporaries stay in the cache.
_ROWS = 16


class Image:
    """A picture as it leaves the renderer.

    ``pixels`` are float32 (H, W, 4), top row first: linear Rec.709 radiance
    multiplied by alpha (associated), then alpha. ``tone_map``, ``exposure``
    (in EV) and ``gamma`` (None for sRGB) are how it is shown unless asked
    otherwise. ``display`` is the picture as uint8 (H, W, 4) that the GPU
    already made with just these, encoded and with alpha not associated; one
    of the two may be missing where nobody needs it. ``layers`` are further
    values (H, W) or (H, W, C) that an EXR file takes along, by the names of
    :data:`moka.core.aov.AOVS` or as :mod:`moka.core.exr` describes them.
    """

    def __init__(
        self,
        pixels: NDArray[np.float32] | None,
        *,
        tone_map: str = "neutral",
        exposure: float = 0.0,
        gamma: float | None = None,
        display: NDArray[np.uint8] | None = None,
        layers: Mapping[str, NDArray[Any]] | None = None,
    ) -> None:
        shapes = {a.shape for a in (pixels, display) if a is not None}
        if len(shapes) != 1:
            raise ValueError("pixels and display are missing or differ in size")
        self._shape = shapes.pop()
        if len(self._shape) != 3 or self._shape[2] != 4:
            raise ValueError(f"not RGBA pixels: shape {self._shape}")
        self.tone_map = tone_map
        self.exposure = exposure
        self.gamma = gamma
        self.layers = dict(layers or {})
        self._pixels = pixels
        self._display = display

    def __repr__(self) -> str:
        width, height = self.size
        return f"Image({width} x {height})"

    @property
    def pixels(self) -> NDArray[np.float32]:
        """Linear radiance and alpha, float32 (H, W, 4), top row first.

        Raises ImageFileError if the picture was made for a display only.
        """
        if self._pixels is None:
            raise ImageFileError(
                "this picture was made for a display only; "
                "render it again with its pixels"
            )
        return self._pixels

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        height, width, _ = self._shape
        return width, height

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        tone_map: str | None = None,
        exposure: float | None = None,
        gamma: float | None = None,
        half: bool = False,
    ) -> None:
        """Write a .png or .exr file, whole or not at all.

        A .png is what :meth:`to_display` gives for the first three options.
        An .exr holds the linear pixels, never exposed, and the layers; as
        half floats if ``half``. Raises ImageFileError for another suffix
        and when the file cannot be written.
        """
        self.save_all(
            [path], tone_map=tone_map, exposure=exposure, gamma=gamma, half=half
        )

    def save_all(
        self,
        paths: Iterable[str | os.PathLike[str]],
        *,
        tone_map: str | None = None,
        exposure: float | None = None,
        gamma: float | None = None,
        half: bool = False,
    ) -> None:
        """:meth:`save` to every path, or to none if one of them fails."""
        with ExitStack() as files:
            for path in paths:
                suffix = Path(path).suffix.lower()
                if suffix == ".png":
                    shown = self.to_display(tone_map, exposure, gamma)
                    file = files.enter_context(image_file(path))
                    file.write_bytes(encode_png(shown))
                elif suffix == ".exr":
                    from moka.core.exr import store_exr

                    pixels = self.pixels
                    file = files.enter_context(image_file(path))
                    layers = {
                        exr_layer(name): values
                        for name, values in self.layers.items()
                    }
                    store_exr(file, pixels, half=half, layers=layers)
                else:
                    raise ImageFileError(
                        f"{os.fspath(path)}: cannot write images of this "
                        "kind; use .png or .exr"
                    )

    def to_display(
        self,
        tone_map: str | None = None,
        exposure: float | None = None,
        gamma: float | None = None,
    ) -> NDArray[np.uint8]:
        """The picture for a display: uint8 (H, W, 4), top row first.

        Exposed, tone mapped, sRGB-encoded; alpha is linear and no longer
        associated with the colour. What is None is as the picture was
        rendered. ``gamma`` puts the power 1 / gamma in the place of the
        sRGB curve. Raises OptionError for an unknown tone map and for a
        gamma that is not positive.
        """
        name = self.tone_map if tone_map is None else tone_map
        stops = self.exposure if exposure is None else exposure
        if gamma is None:
            gamma = self.gamma
        shown_as = (name, stops, gamma)
        as_rendered = shown_as == (self.tone_map, self.exposure, self.gamma)
        if self._display is not None and as_rendered:
            return self._display
        if gamma is not None and not gamma > 0.0:
            raise OptionError(f"a gamma of {gamma} is not positive")
        from moka.core.tone_map import tone_map as map_tones

        shown = np.empty(self._shape, np.uint8)
        for start in range(0, len(shown), _ROWS):
            rows = self.pixels[start : start + _ROWS]
            colour, alpha = rows[:, :, :3], rows[:, :, 3:]
            if alpha.min() < 1.0:
                # Where nothing covers a pixel, its colour means nothing.
                colour = np.where(alpha > 0.0, colour / _or_one(alpha), 0.0)
            mapped = map_tones(colour, name, stops)
            block = shown[start : start + _ROWS]
            if gamma is None:
                block[:, :, :3] = encode_srgb8(mapped)
            else:
                block[:, :, :3] = _to_codes(mapped ** (1.0 / gamma))
            block[:, :, 3:] = _to_codes(alpha)
        return shown

    def _repr_png_(self) -> bytes:
        return encode_png(self.to_display())


def _or_one(alpha: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.where(alpha > 0.0, alpha, np.float32(1))


def _to_codes(values: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
    codes: NDArray[np.uint8] = np.empty(values.shape, np.uint8)
    np.rint(255.0 * np.clip(values, 0.0, 1.0), out=codes, casting="unsafe")
    return codes
