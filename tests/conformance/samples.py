"""Sample models against ray casting in float64."""

from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct

import moka
from moka.model.cameras import Perspective
from tests.conformance.case import Outcome
from tests.conformance.painting import Array
from tests.support.oracles.gltf_file import FileOracle
from tests.support.oracles.ray_caster import Seen, cast, surfaces

__all__ = ["DEPTH_ERROR", "RAYS", "SAMPLES", "Sample"]

#: Rays along a side of a picture.
RAYS = 288
#: By how much of it depth may be off, before a pixel counts as wrong.
DEPTH_ERROR = 1e-3
# Colours are compared as means of so many pixels a side, since trilinear
# filtering blurs over more than one.
_FINE = 3
_SLOPE = 0.4
# From the right and from above.
_TOWARDS = np.array((0.45, 0.35, 0.82)) / np.linalg.norm((0.45, 0.35, 0.82))


class Sample(Struct, frozen=True):
    """A model, and the moment at which it is seen.

    No more than a share of ``allowed`` pixels may have a wrong depth, or be
    covered in one picture only, and base colours may differ by ``colour`` on
    average. ``credit`` is given where the model is in the public domain, so
    that its picture may be shown.
    """

    path: str
    shows: str
    animation: int | None = None
    time: float = 0.0
    allowed: float = 0.001
    colour: float = 0.015
    credit: str = ""

    @property
    def title(self) -> str:
        """The name of the file, without folder and ending."""
        return Path(self.path).stem

    def run(self, assets: Path) -> Outcome:
        """Base colours of moka beside those of the rays."""
        path = assets / "models" / self.path
        expected, camera = _expected(path, self.animation, self.time)
        image = moka.render(
            path,
            camera=camera,
            size=(RAYS, RAYS),
            environment="none",
            samples=1,
            animation=self.animation,
            time=self.time,
            aov=("depth", "albedo"),
        )
        depth = image.layers["depth"].astype(float)
        albedo = image.layers["albedo"][..., :3].astype(float)
        found, wanted = np.isfinite(depth), np.isfinite(expected.depth)
        both = found & wanted
        wrong = found != wanted
        wrong[both] = abs(depth[both] / expected.depth[both] - 1) > DEPTH_ERROR
        right = _blocks(both & ~wrong).all(axis=(1, 3))
        pictures = [
            _blocks(colours).mean(axis=(1, 3))
            for colours in (
                np.where(found[..., None], albedo, 0),
                expected.colour,
            )
        ]
        differing = float(wrong.sum() / wanted.sum())
        mean = float(np.abs(pictures[0] - pictures[1])[right].mean())
        return Outcome(
            *pictures,
            differing,
            mean,
            differing <= self.allowed and mean <= self.colour,
        )


def _blocks(pixels: Array) -> Array:
    """(H, W, ...) as (H / 3, 3, W / 3, 3, ...)."""
    side = len(pixels) // _FINE
    return pixels.reshape(side, _FINE, side, _FINE, *pixels.shape[2:])


def _expected(
    path: Path, animation: int | None, time: float
) -> tuple[Seen, moka.Camera]:
    """What the rays see, and the camera in which that is to be seen."""
    parts = list(surfaces(FileOracle(path), animation, time))
    corners = np.concatenate([part.corners.reshape(-1, 3) for part in parts])
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    distance = 1.05 * radius * np.sqrt(1 + 1 / _SLOPE**2)
    eye = middle + distance * _TOWARDS
    camera = moka.Camera(
        Perspective(2 * np.arctan(_SLOPE), near=distance / 100)
    )
    camera.transform.position = tuple(eye)
    camera.transform.look_at(tuple(middle))
    right = np.cross((0.0, 1.0, 0.0), _TOWARDS)
    right /= np.linalg.norm(right)
    view: Any = np.eye(4)
    view[:3, :3] = right, np.cross(_TOWARDS, right), _TOWARDS
    view[:3, 3] = -view[:3, :3] @ eye
    return cast(parts, view, _SLOPE, RAYS), camera


SAMPLES = [
    # Where masks are cut is a matter of how alpha is filtered.
    Sample(
        "AlphaBlendModeTest.glb",
        "one pane opaque, blended, and cut at three values of alpha",
        allowed=0.03,
    ),
    Sample(
        "Avocado/Avocado.gltf", "textures of a fruit", credit="Microsoft, CC0"
    ),
    Sample(
        "BoomBox/BoomBox.gltf", "textures of a radio", credit="Microsoft, CC0"
    ),
    Sample("BoxInterleaved.glb", "attributes that share one view"),
    Sample("CesiumMilkTruck.glb", "wheels that turn, at 0.5 s", 0, 0.5),
    Sample("ClearCoatTest/ClearCoatTest.gltf", "spheres and labels"),
    Sample(
        "ClearcoatWicker.glb",
        "a woven sphere",
        credit="Eric Chadwick, CC0",
    ),
    Sample("DamagedHelmet/DamagedHelmet.gltf", "a worn helmet"),
    Sample("Duck.glb", "nodes that have matrices"),
    Sample("Michelle.glb", "a dancer, at 1 s", 0, 1.0),
    Sample(
        "MorphStressTest.gltf",
        "columns of morph targets, at 0.7 s",
        0,
        0.7,
        credit="Khronos Group, CC0",
    ),
    Sample("Soldier.glb", "two skins on one skeleton, running", 1, 0.4),
    Sample(
        "Suzanne/Suzanne.gltf",
        "a monkey's head",
        credit="Norbert Nopper, public domain",
    ),
    Sample(
        "TextureTransformTest/TextureTransformTest.gltf",
        "arrows that point to the middle of a mark; green ticks",
    ),
    Sample("cube.glb", "a cube"),
    Sample("cubevc.glb", "a cube with a colour at its vertices"),
    Sample("nested.glb", "nodes below nodes"),
]
