"""Decodes the JPEG files that are like most, as fast as libjpeg-turbo can.

Into four bytes a pixel, as graphics drivers hold them. CPU time of the five
2048x2048 textures of a helmet, as a ratio to Pillow, numpy.asarray and a
fourth channel: simplejpeg 0.30 to 0.52, Pillow read in place 0.49 to 0.67,
imagecodecs 0.66 to 0.81, OpenCV 0.68 to 0.84 for baseline files, and 0.81,
0.87, 0.89, 0.90 for a progressive one. To import simplejpeg takes 1 ms, each
of the others 10 to 20.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["decode_common_jpeg"]


def decode_common_jpeg(
    data: bytes | memoryview, most_pixels: int
) -> NDArray[np.uint8] | None:
    """Texels (H, W, C) of grey (C = 1) or YCbCr (3); None of anything else.

    Three channels are a view of four, see
    :func:`moka.core.decode.with_alpha`. None too for files that are broken
    or unusual, of which another decoder may make more, and for those of more
    than ``most_pixels``.
    """
    import simplejpeg

    try:
        height, width, space, _ = simplejpeg.decode_jpeg_header(data)
        if height * width > most_pixels or space not in ("Gray", "YCbCr"):
            return None
        colours = "GRAY" if space == "Gray" else "RGBA"
        texels: NDArray[Any] = simplejpeg.decode_jpeg(data, colours)
    except ValueError:
        return None
    return texels[:, :, :3]
