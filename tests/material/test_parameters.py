"""Material rows hold the factors; transforms follow the extension."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.core.encoded_image import EncodedImage
from moka.material.material import Material, Texture, TextureTransform
from moka.material.parameters import (
    RowPart,
    material_layout,
    material_values,
    uv_matrix,
)

NUMBERS = st.floats(-10, 10)


@given(NUMBERS, NUMBERS, st.floats(-7, 7), NUMBERS, NUMBERS)
def test_uv_transforms_are_the_extensions_product(
    offset_u: float,
    offset_v: float,
    rotation: float,
    scale_u: float,
    scale_v: float,
) -> None:
    """KHR_texture_transform gives the three matrices, by columns, as GLSL."""
    translation = np.array([[1, 0, 0], [0, 1, 0], [offset_u, offset_v, 1]]).T
    c, s = np.cos(rotation), np.sin(rotation)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]).T
    scale = np.diag([scale_u, scale_v, 1.0])
    expected = (translation @ turn @ scale)[:2]
    got = uv_matrix(
        TextureTransform((offset_u, offset_v), rotation, (scale_u, scale_v))
    )
    assert got == pytest.approx(expected, abs=1e-12)


def test_rows_hold_what_the_material_says() -> None:
    material = Material(
        base_colour_factor=(0.1, 0.2, 0.3, 0.4),
        emissive_factor=(5, 6, 7),
        alpha_cutoff=0.25,
        metallic_factor=0.5,
        roughness_factor=0.75,
        normal_scale=2.0,
        occlusion_strength=0.125,
    )
    row = material_layout(1).pack(material_values(material))
    floats = row.view(np.float32)
    expected = [0.1, 0.2, 0.3, 0.4, 5, 6, 7, 0.25, 0.5, 0.75, 2, 0.125]
    assert floats == pytest.approx(expected)


def test_transforms_are_in_the_row_only_when_asked_for() -> None:
    plain = material_layout(1)
    moved = material_layout(1, RowPart.TRANSFORMS)
    assert moved.size == plain.size + 5 * 32
    image = EncodedImage("image", data=b"")
    material = Material(
        normal_texture=Texture(
            image, transform=TextureTransform(offset=(0.5, 0.25))
        )
    )
    row = moved.pack(material_values(material, RowPart.TRANSFORMS))
    assert row["normal_transform"][0].tolist() == [
        [1, 0, 0.5, 0],
        [0, 1, 0.25, 0],
    ]
    assert row["emissive_transform"][0].tolist() == [[1, 0, 0, 0], [0, 1, 0, 0]]


def test_a_dielectrics_reflectance_is_in_the_row_only_when_asked_for() -> None:
    plain = material_layout(1)
    layout = material_layout(1, RowPart.SPECULAR)
    assert layout.size == plain.size + 16
    for ior, f0 in ((0.0, 1.0), (1.0, 0.0), (1.5, 0.04), (3.0, 0.25)):
        material = Material(
            ior=ior, specular_factor=0.5, specular_colour_factor=(1, 0, 8)
        )
        row = layout.pack(material_values(material, RowPart.SPECULAR))
        assert row["dielectric_f0"][0] == pytest.approx([f0, 0, 8 * f0])
        assert row["specular_factor"][0] == 0.5
    both = material_layout(1, RowPart.SPECULAR | RowPart.TRANSFORMS)
    assert both.size == layout.size + 7 * 32
