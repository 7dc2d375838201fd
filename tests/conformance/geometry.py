"""Topologies, vertex attributes and nodes."""

import math

import numpy as np

from tests.conformance.case import SIZE, Case
from tests.conformance.painting import Array, black, inside, paint
from tests.conformance.scene_file import SceneFile

__all__ = ["GEOMETRY"]

_COLOURS = np.array(
    [
        (0.8, 0.2, 0.1),
        (0.1, 0.7, 0.2),
        (0.1, 0.3, 0.9),
        (0.8, 0.7, 0.1),
        (0.7, 0.1, 0.7),
        (0.1, 0.7, 0.7),
    ]
)
_PLACES = [(x, y) for y in (0.5, -0.5) for x in (-0.65, 0.0, 0.65)]
_HALF = 0.25
_SQUARE = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * _HALF


def six_squares(x: Array, y: Array) -> Array:
    """A square of each colour in two rows of three."""
    radiance = black(x)
    for place, colour in zip(_PLACES, _COLOURS, strict=True):
        paint(radiance, inside(x, y, place, _HALF), colour)
    return radiance


def triangles() -> bytes:
    """A square as triangles, strip and fan, indexed above and not below."""
    file = SceneFile()
    orders = {4: [0, 1, 2, 0, 2, 3], 5: [0, 1, 3, 2], 6: [0, 1, 2, 3]}
    for number, (place, colour) in enumerate(
        zip(_PLACES, _COLOURS, strict=True)
    ):
        mode = (4, 5, 6)[number % 3]
        order = orders[mode]
        corners = {"POSITION": _SQUARE if number < 3 else _SQUARE[order]}
        indices = order if number < 3 else None
        file.node(
            file.mesh(corners, indices, file.material(colour), mode), place
        )
    return file.glb()


def _pixel(column: float, row: float) -> tuple[float, float, float]:
    """The place of a pixel's centre."""
    return (
        (column + 0.5) / SIZE * 2 - 1,
        1 - (row + 0.5) / SIZE * 2,
        0.0,
    )


def points() -> bytes:
    """One point in six, in rows that take their colours in turn."""
    file = SceneFile()
    places = np.array(
        [_pixel(c, r) for r in range(2, SIZE, 6) for c in range(2, SIZE, 6)]
    )
    colours = _COLOURS[np.arange(len(places)) % 6]
    file.node(
        file.mesh({"POSITION": places, "COLOR_0": colours}, None, None, 0)
    )
    return file.glb()


def painted_points(x: Array, _y: Array) -> Array:
    """Single pixels."""
    radiance = black(x)
    count = len(range(2, SIZE, 6))
    radiance[2::6, 2::6] = _COLOURS[np.arange(count**2) % 6].reshape(
        count, count, 3
    )
    return radiance


def lines() -> bytes:
    """A pair of lines, a strip of three and a closed loop."""
    file = SceneFile()
    for mode, corners, colour in (
        (1, [(20, 20), (139, 20), (20, 30), (139, 30)], _COLOURS[0]),
        (3, [(20, 50), (60, 50), (60, 130), (20, 130)], _COLOURS[1]),
        (2, [(90, 50), (139, 50), (139, 130), (90, 130)], _COLOURS[2]),
    ):
        places = np.array([_pixel(*corner) for corner in corners])
        file.node(
            file.mesh({"POSITION": places}, None, file.material(colour), mode)
        )
    return file.glb()


def painted_lines(x: Array, _y: Array) -> Array:
    """Rows and columns of single pixels."""
    radiance = black(x)
    radiance[20, 20:140] = radiance[30, 20:140] = _COLOURS[0]
    radiance[50, 20:61] = radiance[130, 20:61] = _COLOURS[1]
    radiance[50:131, 60] = _COLOURS[1]
    radiance[50, 90:140] = radiance[130, 90:140] = _COLOURS[2]
    radiance[50:131, 139] = radiance[50:131, 90] = _COLOURS[2]
    return radiance


def _ramp(x: Array, y: Array) -> Array:
    return np.stack([(x + 1) / 2, (y + 1) / 2, np.full_like(x, 0.6)], -1)


def vertex_colours() -> bytes:
    """Three bands: float32 without alpha, 8 bits and 16 bits with it."""
    file = SceneFile()
    for number, (dtype, width) in enumerate((("f4", 3), ("u1", 4), ("u2", 4))):
        low, high = 1 - 2 * (number + 1) / 3, 1 - 2 * number / 3
        corners = np.array(
            [(-1, low, 0), (1, low, 0), (1, high, 0), (-1, high, 0)]
        )
        colours = np.ones((4, 4))
        colours[:, :3] = _ramp(corners[:, 0], corners[:, 1])
        scale = {"f4": 1, "u1": 255, "u2": 65535}[dtype]
        stored = colours[:, :width] * scale
        stored = stored if dtype == "f4" else np.rint(stored)
        colour = file.accessor(stored, dtype, normalized=dtype != "f4")
        file.node(
            file.mesh(
                {"POSITION": corners, "COLOR_0": colour},
                [0, 1, 2, 0, 2, 3],
                file.material(),
            )
        )
    return file.glb()


def quantised() -> bytes:
    """Squares of KHR_mesh_quantization, one of each type of positions."""
    file = SceneFile()
    file.uses("KHR_mesh_quantization")
    file.gltf.extensionsRequired = ["KHR_mesh_quantization"]
    kinds = [
        ("i1", True, 127),
        ("u1", True, 255),
        ("i2", True, 32767),
        ("u2", True, 65535),
        ("i1", False, 1),
        ("u2", False, 1),
    ]
    for (dtype, normalized, top), place, colour in zip(
        kinds, _PLACES, _COLOURS, strict=True
    ):
        unit = _SQUARE / _HALF
        offset = 0.0
        if dtype[0] == "u":
            # Unsigned ones cannot lie left of the origin: the node moves it.
            unit, offset = (unit + 1) / 2 * (1, 1, 0), _HALF
        scale = 2 * _HALF if dtype[0] == "u" else _HALF
        positions = file.accessor(
            unit * top, dtype, normalized=normalized, limits=True
        )
        file.node(
            file.mesh(
                {"POSITION": positions},
                [0, 1, 2, 0, 2, 3],
                file.material(colour),
            ),
            np.array(place) - offset,
            scale=[scale] * 3,
        )
    return file.glb()


def sparse() -> bytes:
    """Zeros, of which a sparse accessor puts four elsewhere."""
    file = SceneFile()
    for place, colour in zip(_PLACES, _COLOURS, strict=True):
        positions = file.accessor(np.zeros((4, 3)), limits=True)
        accessor = file.gltf.accessors[positions]
        accessor.bufferView = accessor.byteOffset = None
        accessor.min = _SQUARE.min(axis=0).tolist()
        accessor.max = _SQUARE.max(axis=0).tolist()
        accessor.sparse = {
            "count": 4,
            "indices": {
                "bufferView": file.view(bytes([0, 1, 2, 3])),
                "componentType": 5121,
            },
            "values": {
                "bufferView": file.view(_SQUARE.astype("<f4").tobytes())
            },
        }
        file.node(
            file.mesh(
                {"POSITION": positions},
                [0, 1, 2, 0, 2, 3],
                file.material(colour),
            ),
            place,
        )
    return file.glb()


def nodes() -> bytes:
    """Each square gets to its place in another way."""
    file = SceneFile()
    meshes = [
        file.mesh({"POSITION": _SQUARE}, [0, 1, 2, 0, 2, 3], file.material(c))
        for c in _COLOURS
    ]
    places = np.array(_PLACES)
    file.node(meshes[0], places[0])
    matrix = np.eye(4)
    matrix[:2, 3] = places[1]
    file.node(meshes[1], matrix=matrix.T.reshape(-1).tolist())
    # A quarter turn, then a step along the turned axes.
    quarter = [0, 0, math.sqrt(0.5), math.sqrt(0.5)]
    step = file.node(meshes[2], (places[2][1], -places[2][0]))
    file.node(rotation=quarter, children=[step])
    # Mirrored: its triangles wind the other way, and still face us.
    file.node(meshes[3], places[3], scale=[-1, 1, 1])
    inner = file.node(meshes[4], places[4] * 2, scale=[2, 2, 2])
    file.node(scale=[0.5, 0.5, 0.5], children=[inner])
    # Back and forth, five levels deep.
    deepest = file.node(meshes[5], places[5])
    for turn in (1, -1, 1, -1):
        half = math.pi / 7 * turn
        rotation = [0, 0, math.sin(half), math.cos(half)]
        deepest = file.node(rotation=rotation, children=[deepest])
    return file.glb()


GEOMETRY = [
    Case(
        "Triangles, strips and fans",
        "six squares: triangles, a strip and a fan, above with indices",
        "painted",
        triangles,
        six_squares,
    ),
    Case(
        "Points",
        "a grid of points, each one pixel, in six colours",
        "painted",
        points,
        painted_points,
    ),
    Case(
        "Lines, strips and loops",
        "two lines; a strip, open at its left; a closed loop",
        "painted; the ends of a line may lack or have a pixel",
        lines,
        painted_lines,
        allowed=10 / SIZE**2,
    ),
    Case(
        "Vertex colours",
        "one ramp through three bands: float32, 8 bits, 16 bits",
        "painted",
        vertex_colours,
        _ramp,
    ),
    Case(
        "KHR_mesh_quantization",
        "six squares: int8, uint8, int16, uint16, normalised; int8, uint16",
        "painted",
        quantised,
        six_squares,
    ),
    Case(
        "Sparse accessors",
        "six squares, of accessors that have nothing but sparse values",
        "painted",
        sparse,
        six_squares,
    ),
    Case(
        "Nodes",
        "six squares: moved, by a matrix, turned, mirrored, scaled, nested",
        "painted",
        nodes,
        six_squares,
    ),
]
