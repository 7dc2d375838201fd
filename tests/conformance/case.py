"""A file, what one must see of it, and how far moka is from that."""

from collections.abc import Callable
from typing import Any

import numpy as np
from msgspec import Struct, field
from numpy.typing import NDArray

import moka
from moka.model.cameras import Orthographic

__all__ = ["SIZE", "SLANTED_EDGES", "Case", "Outcome", "Painter", "plane"]

#: Pixels along a side of every picture.
SIZE = 160
#: Drivers round corners to 1/256 of a pixel, so that a few pixels whose
#: centre a slanted edge just touches may fall to either side of it.
SLANTED_EDGES = 20 / SIZE**2

Array = NDArray[Any]
#: Radiance (H, W, 3) in float64 at the places x, y (H, W) of pixel centres.
Painter = Callable[[Array, Array], Array]


class Outcome(Struct, frozen=True):
    """A picture (H, W, 3) beside what it should be, both linear radiance.

    ``differing`` is the share of pixels further apart than the tolerance,
    ``mean`` the mean of the absolute differences.
    """

    picture: Array
    expected: Array
    differing: float
    mean: float
    passed: bool


class Case(Struct, frozen=True):
    """A scene seen from +Z, in parallel: x and y from -1 to 1, y upwards.

    ``sees`` says what one must see, ``by`` how the expectation is made. That
    is either ``painted``, a formula for every pixel in float64, or the
    picture of ``plain``, a file that says the same in plainer words. No more
    than a share of ``allowed`` pixels may differ by more than ``tolerance``
    in any channel; where single pixels are a matter of chance, means of
    ``block`` by ``block`` of them are compared. ``options`` go to
    :func:`moka.render`, for both files.
    """

    title: str
    sees: str
    by: str
    file: Callable[[], Any]
    painted: Painter | None = None
    plain: Callable[[], Any] | None = None
    tolerance: float = 2e-3
    allowed: float = 0.0
    block: int = 1
    options: dict[str, Any] = field(default_factory=dict)

    def glb(self) -> bytes:
        """The bytes of the file."""
        file = self.file()
        return (
            file if isinstance(file, bytes) else b"".join(file.save_to_bytes())
        )

    def run(self) -> Outcome:
        """Render, and compare."""
        picture = self._render(self.glb())
        if self.painted is not None:
            expected = np.broadcast_to(
                self.painted(*plane()), picture.shape
            ).astype(np.float64)
        else:
            assert self.plain is not None, self.title
            expected = self._render(self.plain())
        difference = np.abs(self._means(picture) - self._means(expected))
        differing = float((difference.max(axis=2) > self.tolerance).mean())
        return Outcome(
            picture,
            expected,
            differing,
            float(difference.mean()),
            bool(differing <= self.allowed and np.isfinite(picture).all()),
        )

    def _means(self, radiance: Array) -> Array:
        count = SIZE // self.block
        blocks = radiance.reshape(count, self.block, count, self.block, 3)
        return np.asarray(blocks.mean(axis=(1, 3)))

    def _render(self, file: Any) -> Array:
        camera = moka.Camera(Orthographic(1.0, 1.0, 0.01, 100.0))
        camera.transform.position = (0, 0, 5)
        options: dict[str, Any] = {
            "environment": "none",
            "background": "#000000",
            "samples": 1,
            "camera": camera,
        }
        image = moka.render(file, size=(SIZE, SIZE), **(options | self.options))
        assert image.pixels is not None
        return np.asarray(image.pixels[..., :3], np.float64)


def plane() -> tuple[Array, Array]:
    """x and y (H, W) of the centres of the pixels."""
    centres = (np.arange(SIZE) + 0.5) / SIZE * 2.0 - 1.0
    x, y = np.meshgrid(centres, -centres)
    return x, y
