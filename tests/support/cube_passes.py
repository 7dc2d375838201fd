"""Passes over the six faces of a cube map, and a cube to run them on."""

import numpy as np

from moka.lighting.samples import cosine_samples, ggx_prefilter_samples, pack
from tests.support.gpu import gpu
from tests.support.oracles import environment as oracle


def draw_cube(name, size, textures, *, defines=None, blocks=None):
    """The six faces (6, size, size, 3) that pass ``name`` draws at once."""
    return gpu().draw_outputs(
        name,
        (size, size),
        6,
        defines=defines or {},
        textures=textures,
        blocks=blocks or {},
    )[..., :3]


def resample(image, size, subdivisions=1, *, face=None):
    """A map (H, W, 3 or 4) as a cube, or as that one ``face`` of it."""
    name = "equirectangular_to_cube.frag"
    textures = {"environment_map": gpu().texture(image)}
    defines = {"MOKA_SIZE": size, "MOKA_SUBDIVISIONS": subdivisions}
    if face is None:
        return draw_cube(name, size, textures, defines=defines)
    defines["MOKA_FACE"] = face
    return gpu().draw(name, (size, size), defines=defines, textures=textures)[
        ..., :3
    ]


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
