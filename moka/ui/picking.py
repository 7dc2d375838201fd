"""What is under a pixel: which object, and where in the world."""

from collections.abc import Mapping

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.commands.commands import Readback
from moka.commands.sort_key import SortKey
from moka.model.cameras import Orthographic
from moka.renderer.frame_order import PASS_READ
from moka.renderer.renderer import Renderer
from moka.renderer.surface_values import unpack_values
from moka.scene.camera import Camera
from moka.scene.scene import Scene

__all__ = ["Pick", "begin_pick", "finish_pick", "point_at"]

_NAMES = ("object-id", "depth")


class Pick(Struct, frozen=True):
    """An object's number, as of the AOV ``object-id``, and a point (3,)."""

    number: int
    point: NDArray[np.float64]


def begin_pick(
    renderer: Renderer,
    scene: Scene,
    camera: Camera,
    pixel: tuple[int, int],
    commands: CommandList,
) -> dict[str, Readback]:
    """Record what tells of ``pixel``, x and y from the upper left corner.

    To be given to :func:`finish_pick` when all of it has arrived.
    """
    targets = renderer.draw_values(scene, camera, _NAMES, commands)
    x, y = pixel
    place = (x, renderer.size[1] - 1 - y, 1, 1)
    return targets.read(commands, SortKey(PASS_READ), place)


def finish_pick(
    read: Mapping[str, Readback],
    camera: Camera,
    pixel: tuple[int, int],
    size: tuple[int, int],
) -> Pick | None:
    """What was under ``pixel`` of a picture of ``size``; None for nothing."""
    values = unpack_values(_NAMES, read)
    number = int(values["object-id"][0, 0])
    if not number:
        return None
    depth = float(values["depth"][0, 0])
    return Pick(number, point_at(camera, pixel, size, depth))


def point_at(
    camera: Camera,
    pixel: tuple[int, int],
    size: tuple[int, int],
    depth: float,
) -> NDArray[np.float64]:
    """The point (3,) behind the centre of a pixel.

    ``depth`` is its distance along the view axis in metres.
    """
    width, height = size
    projection = camera.projection_matrix(width / height, reversed_z=True)
    clip = np.array(
        [
            2 * (pixel[0] + 0.5) / width - 1,
            1 - 2 * (pixel[1] + 0.5) / height,
        ]
    )
    distance = 1.0 if isinstance(camera.projection, Orthographic) else depth
    # x_clip w = scale x + shift z + offset, where z is -depth and w is
    # the distance of a perspective.
    shift, offset = projection[:2, 2], projection[:2, 3]
    across = (clip * distance + shift * depth - offset) / np.diag(projection)[
        :2
    ]
    world = np.linalg.inv(camera.view_matrix)
    point: NDArray[np.float64] = world @ np.array([*across, -depth, 1.0])
    return point[:3]
