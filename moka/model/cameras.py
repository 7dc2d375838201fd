"""Cameras of glTF: what they see, not where they stand.

Source: glTF 2.0 specification, section 3.10 (cameras).
"""

import math

from msgspec import Struct

from moka.model import schema
from moka.model.source import GltfSource

__all__ = ["CameraDescription", "Orthographic", "Perspective", "read_cameras"]


class Perspective(Struct, frozen=True):
    """A perspective projection.

    ``yfov`` is the whole vertical angle in radians, ``aspect`` width by
    height or None for that of the image, ``near`` and ``far`` distances in
    metres along the view axis, ``far`` possibly infinite.
    """

    yfov: float
    aspect: float | None = None
    near: float = 0.01
    far: float = math.inf


class Orthographic(Struct, frozen=True):
    """A parallel projection.

    ``xmag`` and ``ymag`` are half the width and the height of what is seen,
    in metres, ``near`` and ``far`` distances along the view axis.
    """

    xmag: float
    ymag: float
    near: float
    far: float


class CameraDescription(Struct, frozen=True):
    """A named projection; a node places it, looking down its -Z axis."""

    projection: Perspective | Orthographic
    name: str = ""


def read_cameras(source: GltfSource) -> list[CameraDescription]:
    """All cameras; raises ModelError for one that could show nothing."""
    return [
        CameraDescription(_projection(source, index, camera), camera.name)
        for index, camera in enumerate(source.document.cameras)
    ]


def _projection(
    source: GltfSource, index: int, camera: schema.Camera
) -> Perspective | Orthographic:
    path = f"cameras[{index}].{camera.type}"
    if camera.type == "perspective" and camera.perspective:
        return _perspective(source, path, camera.perspective)
    if camera.type == "orthographic" and camera.orthographic:
        return _orthographic(source, path, camera.orthographic)
    raise source.error(path, "is missing")


def _perspective(
    source: GltfSource, path: str, camera: schema.Perspective
) -> Perspective:
    far = math.inf if camera.zfar is None else camera.zfar
    if not 0 < camera.yfov < math.pi:
        raise source.error(f"{path}.yfov", "must lie between 0 and pi")
    if camera.aspect_ratio is not None and camera.aspect_ratio <= 0:
        raise source.error(f"{path}.aspectRatio", "must be greater than 0")
    if not 0 < camera.znear < far:
        raise source.error(
            f"{path}.znear", "must be greater than 0 and less than zfar"
        )
    return Perspective(camera.yfov, camera.aspect_ratio, camera.znear, far)


def _orthographic(
    source: GltfSource, path: str, camera: schema.Orthographic
) -> Orthographic:
    for name in ("xmag", "ymag"):
        if getattr(camera, name) == 0:
            raise source.error(f"{path}.{name}", "must not be 0")
    if not 0 <= camera.znear < camera.zfar:
        raise source.error(
            f"{path}.znear", "must be at least 0 and less than zfar"
        )
    return Orthographic(camera.xmag, camera.ymag, camera.znear, camera.zfar)
