"""A scene as one frame sees it."""

from collections.abc import Hashable
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.renderer.scene_materials import SceneMaterials
from moka.renderer.view import View
from moka.scene.scene import Scene

if TYPE_CHECKING:
    from moka.renderer.pose_texture import PoseTexture

__all__ = ["FrameScene", "radiance_key"]


class FrameScene(Struct, frozen=True, eq=False):
    """``scene``, updated, seen by ``view``.

    ``materials`` are those of all that is in it, ``visible`` (V,) the numbers
    of the drawables that the camera sees. ``poses`` is the texture of what
    moves within itself, None where nothing does.
    """

    scene: Scene
    materials: SceneMaterials
    view: View
    visible: NDArray[np.intp]
    poses: "PoseTexture | None"


def radiance_key(
    frame: FrameScene, prepared: object, lights: NDArray[np.void]
) -> Hashable:
    """All that radiance depends on: the same while samples add up.

    ``prepared`` is the key of what has been prepared for the scene,
    ``lights`` the rows of its lights.
    """
    scene, view = frame.scene, frame.view
    return (
        prepared,
        id(scene.environment),
        scene.environment_rotation,
        scene.environment_intensity,
        scene.background == "environment",
        scene.background_blur,
        scene.transforms.version,
        scene.pose_version,
        scene.visibility_version,
        scene.live_materials and scene.live_materials.version,
        view.position.tobytes(),
        view.clip_from_world.tobytes(),
        lights.tobytes(),
    )
