"""Passes over the six faces of a cube map, and a cube to run them on."""

import numpy as np

from moka.lighting.samples import cosine_samples, ggx_prefilter_samples, pack
from tests.support.gpu import gpu
from tests.support.oracles import environment as oracle


def cube_face_block(face, size, *, subdivisions=1, source_lod=0.0) -> bytes:
    integers = np.array([face, size, subdivisions], np.int32)
    return integers.tobytes() + np.float32(source_lod).tobytes()


def draw_cube(name, size, textures, *, defines=None, blocks=None, **block):
    """The six faces (6, size, size, 3) that pass ``name`` draws."""
    return np.stack(
        [
            gpu().draw(
                name,
                (size, size),
                defines=defines or {},
                textures=textures,
                blocks={
                    "CubeFace": cube_face_block(face, size, **block),
                    **(blocks or {}),
                },
            )[..., :3]
            for face in range(6)
        ]
    )


def texel_directions(size: int) -> np.ndarray:
    """Unit vectors (6, size, size, 3): the inverse of OpenGL's table.

    Found as those that the oracle's table maps to each texel's centre.
    """
    centre = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    b, a = np.meshgrid(centre, centre, indexing="ij")
    one = np.ones_like(a)
    faces = np.stack(
        [
            np.stack(vector, axis=-1)
            for vector in (
                (one, -b, -a),
                (-one, -b, a),
                (a, one, b),
                (a, -one, -b),
                (a, -b, one),
                (-a, -b, -one),
            )
        ]
    )
    directions = faces / np.linalg.norm(faces, axis=-1, keepdims=True)
    face, uv = oracle.cube_face(directions)
    assert (face == np.arange(6)[:, None, None]).all()
    assert np.abs(uv * 2.0 - 1.0 - np.stack((a, b), axis=-1)).max() < 1e-12
    return directions


def smooth(d: np.ndarray) -> np.ndarray:
    """Radiance that tells all directions apart."""
    x, y, z = np.moveaxis(d, -1, 0)
    return np.stack((1.0 + x, 1.0 + y * z, 2.0 + z), axis=-1)


def prefilter(cube, roughness, count=256, size=8):
    return draw_cube(
        "prefilter_specular.frag",
        size,
        {"environment_cube": cube},
        defines={"MOKA_SAMPLE_COUNT": count},
        blocks={
            "PrefilterSamples": pack(
                ggx_prefilter_samples(roughness, count, 64), count
            )
        },
    )


def convolve(cube, count=256, size=8):
    return draw_cube(
        "prefilter_irradiance.frag",
        size,
        {"environment_cube": cube},
        defines={"MOKA_SAMPLE_COUNT": count},
        blocks={"PrefilterSamples": pack(cosine_samples(count, 64), count)},
    )
