"""Which mip levels of its textures a still picture can show.

A level is chosen by how far texture coordinates move from pixel to pixel. Of
a scene and a camera that stay as they are this is known before anything is
decoded, so that levels which are finer than any that would be read need not
be made. Everything here errs on their side: hidden surfaces count as seen,
and whatever is not understood counts as read in full.
"""

import threading
from collections.abc import Iterable
from itertools import count

import numpy as np

from moka.commands.descriptors import (
    Filter,
    MipmapMode,
    SamplerDescriptor,
)
from moka.core.maths import Array
from moka.material.material import Texture
from moka.material.parameters import uv_matrix
from moka.model.mesh import Primitive
from moka.model.triangles import triangle_corners
from moka.renderer.footprints import Footprints, footprints
from moka.scene.camera import Camera
from moka.scene.scene import Scene

__all__ = ["SampledLevels", "StillPicture"]

# How much of a texture's visible area may miss a level that is left out, each
# pixel with the weight that the level has there: triangles whose coordinates
# collapse, and steps a little below two texels.
_NEGLIGIBLE = 1e-3

# With fewer texels than this for each triangle, to measure the triangles
# costs more than the levels. A draw costs as much as so many triangles.
_TEXELS_PER_TRIANGLE = 16
_TRIANGLES_PER_DRAW = 256

# So many triangles are worth a look at a part of them first.
_MANY = 4096
_SAMPLE = 16

# Triangles measured at a time, so that temporaries stay small.
_BLOCK = 1 << 14

_numbers = count(1)


class StillPicture:
    """A scene through a camera, neither of which moves, ``size`` in pixels.

    ``visible`` (D,) tells which draws may be seen, as of the scene's last
    update, ``number`` tells pictures apart.
    """

    def __init__(
        self, scene: Scene, camera: Camera, size: tuple[int, int]
    ) -> None:
        aspect = size[0] / size[1]
        self.number = next(_numbers)
        self.size = size
        self.visible = scene.visible(camera, aspect)
        self._key = _key(scene, camera, size)
        self._primitives = scene.drawables.primitives
        # Draws of one primitive side by side.
        draws = np.flatnonzero(self.visible)
        primitive = scene.drawables.primitive[draws]
        order = np.argsort(primitive, kind="stable")
        draws = draws[order]
        self._mirrored = scene.drawables.mirrored[draws]
        drawn, first = np.unique(primitive[order], return_index=True)
        ends = np.append(first, len(draws))[1:]
        self._draws_of = {
            index: range(start, end)
            for index, start, end in zip(
                drawn.tolist(), first.tolist(), ends.tolist(), strict=True
            )
        }
        clip = camera.projection_matrix(aspect, reversed_z=True)
        clip = clip @ camera.view_matrix
        # What overflows is not finite, and read in full.
        with np.errstate(over="ignore", invalid="ignore"):
            world = scene.transforms.world[scene.drawables.row[draws]]
            self._clip: Array = clip @ world
        self._lock = threading.Lock()
        self._measured: dict[object, Footprints | None] = {}

    def shows(
        self, scene: Scene, camera: Camera, size: tuple[int, int]
    ) -> bool:
        """Whether this is still the same picture."""
        return self._key == _key(scene, camera, size) and np.array_equal(
            self.visible, scene.visible(camera, size[0] / size[1])
        )

    @property
    def drawn(self) -> list[int]:
        """Positions of the primitives that may be seen, in order."""
        return list(self._draws_of)

    def measure(
        self, primitive: int, texture: Texture, stride: int
    ) -> Footprints | None:
        """How a primitive reads ``texture``; None if that is not clear.

        ``primitive`` is its position among the scene's; one of ``stride``
        triangles is measured. In any thread.
        """
        key = (primitive, texture.uv_set, texture.transform, stride)
        with self._lock:
            if key not in self._measured:
                self._measured[key] = self._measure(primitive, texture, stride)
            return self._measured[key]

    def effort(self, primitive: int) -> int:
        """What :meth:`measure` costs, in triangles."""
        triangles = self._primitives[primitive].element_count
        draws = len(self._draws_of[primitive])
        return draws * (triangles + _TRIANGLES_PER_DRAW)

    def _measure(
        self, index: int, texture: Texture, stride: int
    ) -> Footprints | None:
        primitive = self._primitives[index]
        coordinates = _coordinates(primitive, texture)
        corners = triangle_corners(primitive)[::stride]
        if coordinates is None or not len(corners):
            return None
        positions = primitive.attributes["POSITION"]
        double_sided = bool(
            primitive.material and primitive.material.double_sided
        )
        measured = []
        for draw in self._draws_of[index]:
            for start in range(0, len(corners), _BLOCK):
                block = corners[start : start + _BLOCK]
                footprint = footprints(
                    positions[block],
                    coordinates[block],
                    self._clip[draw],
                    self.size,
                    front=None
                    if double_sided
                    else 1 - 2 * self._mirrored[draw],
                )
                if footprint is None:
                    return None
                measured.append(footprint)
        return Footprints(
            np.concatenate([each.steps for each in measured], axis=1),
            np.concatenate([each.areas for each in measured]),
        )


class SampledLevels:
    """The levels of one texture that ``picture`` can show.

    ``reads`` are positions of primitives among the scene's, and what of
    their materials reads the texture.
    """

    def __init__(
        self, picture: StillPicture, reads: Iterable[tuple[int, Texture]]
    ) -> None:
        self._picture = picture
        self._reads = list(reads)

    def finest(self, width: int, height: int) -> int:
        """The finest level that is read of a texture of this size.

        OpenGL 4.6, 8.14.1, leaves drivers a choice of how they measure a
        step in both directions at once; the smallest they may is the larger
        of the two.
        """
        picture = self._picture
        effort = sum(
            picture.effort(primitive)
            for primitive in {primitive for primitive, _ in self._reads}
        )
        if effort * _TEXELS_PER_TRIANGLE > width * height:
            return 0
        # Where a part of the triangles needs the finest level, so does it all.
        level = 0
        for stride in (_SAMPLE, 1) if effort > _MANY else (1,):
            level = self._finest_of(width, height, stride)
            if not level:
                break
        return level

    def _finest_of(self, width: int, height: int, stride: int) -> int:
        """By one of ``stride`` triangles."""
        picture = self._picture
        exact: list[Array] = []
        areas: list[Array] = []
        for primitive, texture in self._reads:
            measured = picture.measure(primitive, texture, stride)
            if texture.sampler.mipmap is MipmapMode.NONE or measured is None:
                return 0
            steps = np.maximum(
                width * measured.steps[0], height * measured.steps[1]
            )
            exact.append(steps / _largest_step(texture.sampler))
            areas.append(measured.areas)
        return _level(
            np.concatenate(exact),
            np.concatenate(areas),
            picture.size[0] * picture.size[1] // stride,
            max(width, height).bit_length() - 1,
        )


def _level(steps: Array, areas: Array, pixels: int, last: int) -> int:
    """The finest level that is not negligible."""
    allowed = _NEGLIGIBLE * min(areas.sum(), pixels)
    with np.errstate(divide="ignore"):
        # A step of 2 texels of the full size reads level 1 alone.
        sampled = np.log2(steps)
    for level in range(last):
        weights = np.clip(level + 1 - sampled, 0.0, 1.0)
        if weights @ areas > allowed:
            return level
    return last


def _largest_step(sampler: SamplerDescriptor) -> float:
    """The step, in texels, up to which a sampler may read its finest level.

    An anisotropic one divides it. With these filters magnification begins
    half a level later (OpenGL 4.6, 8.14), and would reach a level of which
    the nearest texel should be read.
    """
    late = sampler.magnify is Filter.LINEAR and sampler.minify is Filter.NEAREST
    return sampler.anisotropy * (2.0**0.5 if late else 1.0)


def _coordinates(primitive: Primitive, texture: Texture) -> Array | None:
    """The texture coordinates (N, 2) of what stays where its arrays say."""
    if primitive.targets is not None or primitive.influence_sets:
        return None
    uv = primitive.attributes.get(f"TEXCOORD_{texture.uv_set}")
    if uv is None:
        return None
    coordinates = uv.astype(np.float64)
    if texture.transform is not None:
        coordinates = coordinates @ uv_matrix(texture.transform)[:, :2].T
    return coordinates


def _key(scene: Scene, camera: Camera, size: tuple[int, int]) -> object:
    return (
        id(scene),
        scene.structure_version,
        scene.transforms.version,
        camera.view_matrix.tobytes(),
        camera.projection,
        size,
    )
