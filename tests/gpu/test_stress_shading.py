"""Light at the limits of directions, materials and lamps.

Squares of one pixel, each with a normal of its own, make n.v and n.l what
they seldom are; the oracle is glTF 2.0's appendix B in float64, with the
guards that the shaders document: n.v is at least 1e-4, alpha at least 0.002
and the distance to a lamp at least a tenth of a millimetre.
"""

import itertools
import math

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from moka.core.errors import OptionError
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.material import AlphaMode, Material
from moka.model.geometry import quad
from moka.model.lights import LightKind, PunctualLight
from moka.model.mesh import Primitive
from moka.scene.scene import Scene
from tests.support.oracles.specular import ggx, schlick, smith_correlated
from tests.support.pictures import (
    draw_radiance,
    looking,
    placed_at,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

Array = NDArray[np.float64]

COSINES = (1, 0.9, 0.5, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 0)
N_DOT_V = np.array([*COSINES, *(-c for c in COSINES[:-1])])
ROUGHNESS = (0.0, 1e-4, 1e-3, 0.045, 0.5, 1.0)
# Black and white, dielectric and metal: F0 of 0.04, 0 and 1.
MATERIALS = [
    Material(
        base_colour_factor=(colour, colour, colour, 1),
        metallic_factor=float(metal),
        roughness_factor=roughness,
    )
    for colour, metal, roughness in itertools.product((0, 1), (0, 1), ROUGHNESS)
]
BRDFS = ("gltf", "karis", "blinn-phong")
MODES = (
    {"ibl": "split-sum"},
    {"ibl": "filtered"},
    {"ibl": "reference", "reference_samples": 16},
)


def normals_of(n_dot_v: ArrayLike) -> Array:
    """Unit vectors (N, 3) at these cosines from +Z, leaning towards +X."""
    cosine = np.asarray(n_dot_v, float)
    zero = np.zeros_like(cosine)
    return np.stack((np.sqrt(1.0 - cosine**2), zero, cosine), axis=-1)


def row_of_squares(normals: ArrayLike, **attributes: ArrayLike) -> Primitive:
    """Squares of edge 2 side by side around x = 0, each with its normal.

    ``attributes`` are of a square each, as the normals are.
    """
    normals = np.asarray(normals, float)
    count = len(normals)
    left = 2.0 * np.arange(count) - count
    corners = np.array([(0, -1, 0), (2, -1, 0), (2, 1, 0), (0, 1, 0)])
    positions = np.repeat(left, 4)[:, None] * (1, 0, 0)
    values = {"NORMAL": normals, **attributes}
    return Primitive(
        {
            "POSITION": positions + np.tile(corners, (count, 1)),
            **{name: np.repeat(v, 4, axis=0) for name, v in values.items()},
        },
        (4 * np.arange(count)[:, None] + np.array([0, 1, 2, 0, 2, 3])).reshape(
            -1
        ),
    )


def scene_of_rows(
    rows: list[tuple[Primitive, Material]],
    environment: Environment | None = None,
    lights: object = (),
) -> Scene:
    """Rows of squares from the top down."""
    top = len(rows) - 1
    items = [
        (primitive, material, placed_at(0, top - 2 * index, 0))
        for index, (primitive, material) in enumerate(rows)
    ]
    return scene_of(items, environment, "transparent", lights)


def draw_rows(
    device: GraphicsDevice, scene: Scene, columns: int, **settings: object
) -> NDArray[np.float32]:
    """A pixel a square: (rows, columns, 4)."""
    rows = len(scene.models[0].model.meshes)
    camera = square_camera(float(rows), 5.0)
    size = (columns, rows)
    return draw_radiance(device, scene, camera, size, **settings)


def sun_from(direction: ArrayLike, lux: float = 1.0) -> list:
    """A directional light that comes from ``direction``."""
    camera = looking(-np.asarray(direction, float))
    light = PunctualLight(LightKind.DIRECTIONAL, intensity=lux)
    return [(light, camera.transform.world_matrix)]


def reflected(
    material: Material, n_dot_v: Array, n_dot_l: Array, h: Array
) -> Array:
    """Radiance (N, 3) of 1 lux; ``h`` (N, 2) are n.h and v.h."""
    n_dot_v = np.clip(n_dot_v, 1e-4, 1.0)
    n_dot_l = np.clip(n_dot_l, 0.0, 1.0)
    alpha = np.array(max(material.roughness_factor**2, 0.002))
    colour = np.array(material.base_colour_factor[:3])
    metal = material.metallic_factor
    f0 = 0.04 * (1.0 - metal) + colour * metal
    fresnel = schlick(np.clip(h[:, 1:], 0.0, 1.0), f0)
    safe = np.maximum(n_dot_l, 1e-100)
    n_dot_h = np.clip(np.abs(h[:, 0]), 1e-9, 1.0)
    lobe = ggx(n_dot_h, alpha) * smith_correlated(safe, n_dot_v, alpha)
    base = (1.0 - fresnel) * colour * (1.0 - metal) / math.pi
    return (fresnel * lobe[:, None] + base) * n_dot_l[:, None]


def bounds_of(
    material: Material, normals: Array, light: Array
) -> tuple[Array, Array]:
    """The least and greatest of the oracle within float32's rounding.

    Three times 1e-7 is what a unit vector's components are uncertain by,
    which is everything where a cosine is 1e-6.
    """
    normals = normals.astype(np.float32).astype(float)
    half = light + np.array([0.0, 0.0, 1.0])
    length = np.linalg.norm(half)
    # Opposite directions have none; one at a right angle stands in.
    half = half / length if length > 1e-5 else np.zeros(3)
    n_dot_v, n_dot_l = normals[:, 2], normals @ light
    h = np.stack((normals @ half, np.full(len(normals), half[2])), axis=-1)
    values = [
        reflected(material, n_dot_v + dv, n_dot_l + dl, h)
        for dv, dl in itertools.product((-3e-7, 0.0, 3e-7), repeat=2)
    ]
    return np.min(values, axis=0), np.max(values, axis=0)


LIGHTS = {
    "with the view": (0.0, 0.0, 1.0),
    "mirrored at half": (math.sin(1.4), 0.0, math.cos(1.4)),
    "along the horizon": (1.0, 0.0, 1e-6),
    "across": (0.0, 1.0, 1e-3),
    "from behind": (0.6, 0.0, -0.8),
    "against the view": (1e-6, 0.0, -1.0),
}


@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS.keys())
def test_every_angle_and_material_is_as_the_formula_says(
    egl_device: GraphicsDevice, light: tuple[float, float, float]
) -> None:
    normals = normals_of(N_DOT_V)
    direction = np.array(light) / np.linalg.norm(light)
    primitive = row_of_squares(normals)
    scene = scene_of_rows(
        [(primitive, material) for material in MATERIALS],
        lights=sun_from(direction),
    )
    single = {"multiscatter": False}
    picture = draw_rows(egl_device, scene, len(normals), **single)
    assert np.isfinite(picture).all()
    assert (picture >= 0.0).all()
    for material, row in zip(MATERIALS, picture[..., :3], strict=True):
        least, greatest = bounds_of(material, normals, direction)
        # The half vector is within 1e-7, of a lobe as narrow as 0.002.
        assert (row >= least * 0.998 - 1e-9).all(), material
        assert (row <= greatest * 1.002 + 1e-9).all(), material
    half = draw_rows(
        egl_device, scene, len(normals), float_output=False, **single
    )
    # Ten bits of mantissa, and steps of 6e-8 below 6e-5.
    limited = np.minimum(picture, 65504.0)
    assert np.allclose(half, limited, rtol=2.0**-10, atol=1.2e-7)


@pytest.mark.parametrize("brdf", BRDFS)
@pytest.mark.parametrize("multiscatter", [True, False])
def test_no_model_of_reflection_breaks_at_any_angle(
    egl_device: GraphicsDevice, brdf: str, multiscatter: bool
) -> None:
    primitive = row_of_squares(normals_of(N_DOT_V))
    rows = [(primitive, material) for material in MATERIALS]
    for diffuse, light in itertools.product(
        ("lambert", "oren-nayar", "burley"), list(LIGHTS.values())[:3]
    ):
        scene = scene_of_rows(rows, lights=sun_from(light))
        for float_output in (True, False):
            picture = draw_rows(
                egl_device,
                scene,
                len(N_DOT_V),
                brdf=brdf,
                diffuse=diffuse,
                multiscatter=multiscatter,
                float_output=float_output,
            )
            assert np.isfinite(picture).all()
            assert (picture >= 0.0).all()


@pytest.mark.parametrize("mode", MODES, ids=[mode["ibl"] for mode in MODES])
@pytest.mark.parametrize("brdf", BRDFS)
def test_an_environment_lights_every_angle(
    egl_device: GraphicsDevice, mode: dict, brdf: str
) -> None:
    """A sky of 0.5 to 1.5 lights nothing by more, and no white metal less.

    Normals that face away are shaded as at a grazing angle.
    """
    rows = np.linspace(1.5, 0.5, 32, dtype=np.float32)
    sky = Environment(np.tile(rows[:, None, None], (1, 64, 3)))
    primitive = row_of_squares(normals_of(N_DOT_V))
    scene = scene_of_rows(
        [(primitive, material) for material in MATERIALS], sky
    )
    picture = draw_rows(egl_device, scene, len(N_DOT_V), brdf=brdf, **mode)
    assert np.isfinite(picture).all()
    assert (picture >= 0.0).all()
    if brdf == "gltf":
        assert picture[..., :3].max() <= 1.6
        white = picture[-len(ROUGHNESS) :, :, :3]
        # Sixteen samples a pixel and energy compensation that is right on
        # average are the reason for so little.
        assert white.min() >= (0.3 if mode["ibl"] == "reference" else 0.45)


@pytest.mark.parametrize("mode", MODES[:2], ids=["split-sum", "filtered"])
def test_a_normal_turned_away_is_lit_as_one_at_a_grazing_angle(
    egl_device: GraphicsDevice, mode: dict
) -> None:
    """Also exactly away, where the view has no direction across it."""
    generator = np.random.default_rng(5)
    sky = Environment(generator.uniform(0.9, 1.1, (16, 32, 3)))
    normals = normals_of([1.0, 1e-4, -1e-3, -0.5, -0.999, -1.0])
    scene = scene_of_rows(
        [(row_of_squares(normals), material) for material in MATERIALS], sky
    )
    picture = draw_rows(egl_device, scene, len(normals), **mode)[..., :3]
    for row in picture:
        assert np.allclose(row[2:], row[1], rtol=0.25, atol=1e-3)


def lamp(
    distance: float, **fields: object
) -> list[tuple[PunctualLight, np.ndarray]]:
    """A point light of 1 cd, or a spot, this far before the origin."""
    kind = fields.pop("kind", LightKind.POINT)
    return [(PunctualLight(kind, **fields), placed_at(0, 0, distance))]


MATT = Material(metallic_factor=1.0, roughness_factor=1.0)


def shade_of_centre(
    device: GraphicsDevice, lights: list, material: Material = MATT
) -> float:
    """Of a square at the origin that faces lamp and camera.

    A white metal of roughness 1 reflects 1 / (4 pi) of the irradiance.
    """
    scene = scene_of([(quad(2.0), material, np.eye(4))], lights=lights)
    picture = draw_radiance(
        device, scene, square_camera(1.0, 5.0), (5, 5), multiscatter=False
    )
    assert np.isfinite(picture).all()
    assert (picture >= 0.0).all()
    return float(picture[2, 2, 0]) * 4.0 * math.pi


@pytest.mark.parametrize(
    ("distance", "tolerance"),
    # The camera is 5 m away, where float32 has steps of 5e-7 m.
    [(1e-4, 0.02), (0.01, 1e-3), (1.0, 1e-4), (1e6, 1e-4), (1e17, 1e-4)],
)
def test_a_lamp_at_any_distance(
    egl_device: GraphicsDevice, distance: float, tolerance: float
) -> None:
    value = shade_of_centre(egl_device, lamp(distance, intensity=1e6))
    assert value == pytest.approx(1e6 / distance**2, rel=tolerance)


@pytest.mark.parametrize("distance", [0.0, 1e-6, 1e-12, 1e-30])
def test_a_lamp_on_the_surface_shines_along_it(
    egl_device: GraphicsDevice, distance: float
) -> None:
    """From there light comes from no direction, but not too much of it."""
    lights = lamp(distance, intensity=1e12)
    assert shade_of_centre(egl_device, lights) <= 1e20


@pytest.mark.parametrize("distance", [1e20, 1e30, 1e38, 1e300])
@pytest.mark.parametrize("kind", [LightKind.POINT, LightKind.SPOT])
def test_a_lamp_beyond_what_squares_hold_is_dark(
    egl_device: GraphicsDevice, distance: float, kind: LightKind
) -> None:
    lights = lamp(distance, kind=kind, intensity=1.0)
    assert shade_of_centre(egl_device, lights) <= 1e-30


@pytest.mark.parametrize("reach", [1e-300, 1e-30, 1.0, 1.001, 2.0, 1e30, 1e300])
def test_the_edge_of_a_lamps_range(
    egl_device: GraphicsDevice, reach: float
) -> None:
    value = shade_of_centre(egl_device, lamp(1.0, intensity=1.0, range=reach))
    # In logarithms, because the ratio is beyond a float64.
    exponent = -4.0 * math.log(reach)
    window = max(1.0 - math.exp(min(exponent, 1.0)), 0.0)
    assert value == pytest.approx(window, rel=1e-4, abs=1e-6)


@pytest.mark.parametrize(
    "angle", [0.0, 1e-9, 1e-3, 0.5, math.pi / 2 - 1e-9, math.pi / 2]
)
def test_a_spot_whose_cones_are_one(
    egl_device: GraphicsDevice, angle: float
) -> None:
    """All light within, none without, and a narrow edge in between."""
    items = [(quad(8.0), MATT, np.eye(4))]
    lights = lamp(
        1.0,
        kind=LightKind.SPOT,
        inner_cone_angle=angle,
        outer_cone_angle=angle,
    )
    size = 65
    picture = draw_radiance(
        egl_device,
        scene_of(items, lights=lights),
        square_camera(4.0, 5.0),
        (size, size),
    )
    assert np.isfinite(picture).all()
    x, y = np.meshgrid(*2 * [np.linspace(-1, 1, size) * 4 * 64 / 65])
    cosine = 1.0 / np.sqrt(1.0 + x * x + y * y)
    inside = cosine > math.cos(angle) + 1.1e-3
    outside = cosine < math.cos(angle) - 1e-6
    assert (picture[inside][:, 0] > 0.0).all()
    assert (picture[outside][:, 0] == 0.0).all()


@pytest.mark.parametrize("brdf", BRDFS)
def test_a_lamp_of_any_intensity(egl_device: GraphicsDevice, brdf: str) -> None:
    primitive = row_of_squares(normals_of(N_DOT_V))
    rows = [(primitive, material) for material in MATERIALS]
    for kind, intensity, float_output in itertools.product(
        LightKind, (0.0, 1e12, 1e38, 1e300), (True, False)
    ):
        lights = lamp(100.0, kind=kind, intensity=intensity)
        picture = draw_rows(
            egl_device,
            scene_of_rows(rows, lights=lights),
            len(N_DOT_V),
            brdf=brdf,
            float_output=float_output,
        )
        assert np.isfinite(picture).all()
        assert (picture >= 0.0).all()
        assert (picture[..., :3].max() > 0.0) == (intensity > 0.0)


@pytest.mark.parametrize("kind", LightKind)
def test_a_lamp_whose_node_has_no_size(
    egl_device: GraphicsDevice, kind: LightKind
) -> None:
    light = PunctualLight(kind)
    shade_of_centre(egl_device, [(light, np.diag([0.0, 0.0, 0.0, 1.0]))])


def test_two_hundred_and_fifty_six_lamps_and_no_more(
    egl_device: GraphicsDevice,
) -> None:
    one = lamp(1.0, intensity=1.0)
    assert shade_of_centre(egl_device, 256 * one) == pytest.approx(
        256 * shade_of_centre(egl_device, one), rel=1e-4
    )
    with pytest.raises(OptionError, match=r"257 lights shine; .* up to 256"):
        shade_of_centre(egl_device, 257 * one)


def test_suns_that_find_no_room_beside_lamps_are_named(
    egl_device: GraphicsDevice,
) -> None:
    sky = np.full((128, 256, 3), 0.1, np.float32)
    sky[40, 100] = 1e6
    scene = scene_of(
        [(quad(2.0), MATT, np.eye(4))],
        Environment(sky),
        lights=256 * lamp(1.0),
    )
    with pytest.raises(OptionError, match=r"256 lights and 1 sun.*suns"):
        draw_radiance(egl_device, scene, square_camera())
    picture = draw_radiance(egl_device, scene, square_camera(), suns="off")
    assert np.isfinite(picture).all()


@pytest.mark.parametrize("alpha_mode", AlphaMode)
@pytest.mark.parametrize("unlit", [True, False])
@pytest.mark.parametrize(
    ("value", "taken_for"),
    [(math.nan, 0), (math.inf, 1), (1e38, 1), (-1, 0), (-math.inf, 0)],
)
def test_vertex_colours_that_are_none(
    egl_device: GraphicsDevice,
    alpha_mode: AlphaMode,
    unlit: bool,
    value: float,
    taken_for: float,
) -> None:
    """They are a part of light, so they end at 0 and 1; NaN is 0."""
    up = normals_of([1.0])
    material = Material(alpha_mode=alpha_mode, unlit=unlit, metallic_factor=0.5)
    shown = [
        draw_rows(
            egl_device,
            scene_of_rows(
                [(row_of_squares(up, COLOR_0=[[colour] * 4]), material)],
                Environment.uniform((1.0, 1.0, 1.0)),
                sun_from((0.0, 0.0, 1.0)),
            ),
            1,
        )
        for colour in (value, taken_for)
    ]
    assert np.array_equal(*shown)
    assert np.isfinite(shown[0]).all()


def test_vertex_colours_stay_within_theirs_at_edges(
    egl_device: GraphicsDevice,
) -> None:
    """Interpolated for a pixel whose centre is outside, they would not."""
    corners = np.array([(-0.9, -0.8, 0), (0.93, -0.76, 0), (0.1, 0.89, 0)])
    colours = np.array([(0, 0.5, 1, 1), (1, 0.5, 0, 1), (0, 0.5, 0, 1)])
    triangle = Primitive({"POSITION": corners, "COLOR_0": colours})
    material = Material(unlit=True)
    scene = scene_of([(triangle, material, np.eye(4))], None, "transparent")
    picture = draw_radiance(
        egl_device, scene, square_camera(), (12, 12), samples=4
    )
    covered = picture[picture[..., 3] > 0]
    assert np.allclose(covered[:, 1], 0.5 * covered[:, 3], atol=1e-6)
    assert (covered[:, :3] >= 0.0).all()
    assert (covered[:, [0, 2]].sum(axis=1) <= covered[:, 3] + 1e-5).all()


@pytest.mark.parametrize("float_output", [True, False])
def test_emission_of_any_strength(
    egl_device: GraphicsDevice, float_output: bool
) -> None:
    for strength in (1e5, 1e30, 1e38, 1e300):
        glow = Material(emissive_factor=(strength, 0, 0))
        scene = scene_of([(quad(2.0), glow, np.eye(4))])
        for samples in (1, 4):
            picture = draw_radiance(
                egl_device,
                scene,
                square_camera(),
                (4, 4),
                samples=samples,
                float_output=float_output,
            )
            assert np.isfinite(picture).all()
            least = min(strength, 1e30) if float_output else 65504
            assert picture[1, 1, 0] >= 0.999 * least
