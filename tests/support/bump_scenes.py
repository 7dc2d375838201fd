"""A bump as geometry, and the same bump as a normal map, written as glTF.

After the idea of Khronos's NormalTangentTest and NormalTangentMirrorTest:
seen from straight above, without shadows, both must look the same however
the texture lies on the plane. The files have no tangents: maps are baked for
those of MikkTSpace, which on a plane are known without it.
"""

import io
from typing import Any

import numpy as np
import pygltflib
from msgspec import Struct
from PIL import Image

__all__ = ["LAYOUTS", "Layout", "bump_by_geometry", "bump_by_normal_map"]

Array = np.ndarray[Any, Any]

_FLOAT, _UNSIGNED_SHORT = 5126, 5123
_TEXELS = 256


class Layout(Struct, frozen=True):
    """How a texture lies on the plane: (u, v) = matrix (x, y) + offset.

    Where ``mirrored`` that is said of x > 0; the other half reads the same
    texels, and shares the vertices between.
    """

    matrix: tuple[tuple[float, float], tuple[float, float]]
    offset: tuple[float, float]
    mirrored: bool = False


LAYOUTS = {
    # Upright: v runs downwards.
    "upright": Layout(((0.5, 0.0), (0.0, -0.5)), (0.5, 0.5)),
    "upside down": Layout(((-0.5, 0.0), (0.0, 0.5)), (0.5, 0.5)),
    "turned": Layout(((0.0, 0.5), (0.5, 0.0)), (0.5, 0.5)),
    "back to front": Layout(((-0.5, 0.0), (0.0, -0.5)), (0.5, 0.5)),
    # Where u and v are not at right angles, so are no derivatives of them.
    "sheared": Layout(((0.3, 0.2), (0.0, -0.5)), (0.5, 0.5)),
    "stretched": Layout(((0.5, 0.0), (0.1, -0.1)), (0.5, 0.5)),
    "mirrored": Layout(((1.0, 0.0), (0.0, -0.5)), (0.0, 0.5), True),
    "mirrored and sheared": Layout(
        ((0.6, 0.0), (0.3, -0.3)), (0.1, 0.35), True
    ),
}


def _normals(x: Array, y: Array) -> Array:
    """Unit normals (..., 3) of the height a (1 - x^2)^2 (1 - y^2)^2."""
    a = 0.6
    slope_x = -4 * a * x * (1 - x**2) * (1 - y**2) ** 2
    slope_y = -4 * a * y * (1 - y**2) * (1 - x**2) ** 2
    normals = np.stack([-slope_x, -slope_y, np.ones_like(x)], axis=-1)
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def bump_by_geometry(steps: int = 96) -> pygltflib.GLTF2:
    """The bump over the square from -1 to 1 as a mesh with its normals."""
    side = np.linspace(-1, 1, steps + 1)
    x, y = (each.reshape(-1) for each in np.meshgrid(side, side))
    height = 0.6 * (1 - x**2) ** 2 * (1 - y**2) ** 2
    first = np.arange(steps)[:, None] * (steps + 1) + np.arange(steps)
    corners = [0, 1, steps + 2, 0, steps + 2, steps + 1]
    return _file(
        {
            "POSITION": np.stack([x, y, height], axis=-1),
            "NORMAL": _normals(x, y),
        },
        first.reshape(-1, 1) + np.array(corners),
        None,
    )


def bump_by_normal_map(layout: Layout) -> pygltflib.GLTF2:
    """A flat square whose normal map makes it look like the bump."""
    columns = (-1, 0, 1)
    plane = np.array([(x, y) for y in (-1, 1) for x in columns], float)
    matrix, offset = np.array(layout.matrix), np.array(layout.offset)
    folded = plane.copy()
    if layout.mirrored:
        folded[:, 0] = np.abs(folded[:, 0])
    return _file(
        {
            "POSITION": np.column_stack([plane, np.zeros(6)]),
            "NORMAL": np.tile((0.0, 0.0, 1.0), (6, 1)),
            "TEXCOORD_0": folded @ matrix.T + offset,
        },
        np.array([0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4]),
        _baked(matrix, offset),
    )


def _baked(matrix: Array, offset: Array) -> bytes:
    """The normals of the bump in the frames of MikkTSpace, as a PNG."""
    centres = (np.arange(_TEXELS) + 0.5) / _TEXELS
    u, v = np.meshgrid(centres, centres)
    inverse = np.linalg.inv(matrix)
    plane = (np.stack([u, v], axis=-1) - offset) @ inverse.T
    # Outside the square no texel is read.
    plane = plane.clip(-1, 1)
    normals = _normals(plane[..., 0], plane[..., 1])
    tangent = np.array([*inverse[:, 0], 0.0])  # how the place moves with u
    tangent /= np.linalg.norm(tangent)
    # v runs down, so that a texture which is not mirrored turns clockwise.
    sign = -np.sign(np.linalg.det(matrix))
    bitangent = sign * np.cross((0.0, 0.0, 1.0), tangent)
    frame = np.stack([tangent, bitangent, (0.0, 0.0, 1.0)])
    texels = np.rint((normals @ frame.T + 1) * 127.5).astype(np.uint8)
    buffer = io.BytesIO()
    Image.fromarray(texels).save(buffer, "PNG")
    return buffer.getvalue()


def _file(
    attributes: dict[str, Array], indices: Array, normal_map: bytes | None
) -> pygltflib.GLTF2:
    gltf = pygltflib.GLTF2(
        scene=0,
        scenes=[pygltflib.Scene(nodes=[0])],
        nodes=[pygltflib.Node(mesh=0)],
        materials=[
            pygltflib.Material(
                pbrMetallicRoughness=pygltflib.PbrMetallicRoughness(
                    metallicFactor=0.0, roughnessFactor=0.6
                )
            )
        ],
    )
    binary = b""

    def add(data: bytes) -> int:
        nonlocal binary
        binary += bytes(-len(binary) % 4)
        gltf.bufferViews.append(
            pygltflib.BufferView(
                buffer=0, byteOffset=len(binary), byteLength=len(data)
            )
        )
        binary += data
        return len(gltf.bufferViews) - 1

    def accessor(array: Array, code: int, kind: str) -> int:
        gltf.accessors.append(
            pygltflib.Accessor(
                bufferView=add(array.tobytes()),
                componentType=code,
                count=len(array),
                type=kind,
            )
        )
        return len(gltf.accessors) - 1

    primitive = pygltflib.Primitive(
        attributes=pygltflib.Attributes(
            **{
                name: accessor(
                    array.astype("<f4"), _FLOAT, f"VEC{array.shape[1]}"
                )
                for name, array in attributes.items()
            }
        ),
        indices=accessor(
            indices.reshape(-1).astype("<u2"), _UNSIGNED_SHORT, "SCALAR"
        ),
        material=0,
    )
    positions = gltf.accessors[primitive.attributes.POSITION]
    places = attributes["POSITION"].astype("<f4")
    positions.min = places.min(axis=0).tolist()
    positions.max = places.max(axis=0).tolist()
    gltf.meshes = [pygltflib.Mesh(primitives=[primitive])]
    if normal_map is not None:
        gltf.images = [
            pygltflib.Image(bufferView=add(normal_map), mimeType="image/png")
        ]
        gltf.textures = [pygltflib.Texture(source=0)]
        gltf.materials[0].normalTexture = pygltflib.NormalMaterialTexture(
            index=0
        )
    gltf.buffers = [pygltflib.Buffer(byteLength=len(binary))]
    gltf.set_binary_blob(binary)
    return gltf
