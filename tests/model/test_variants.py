"""KHR_materials_variants: names, and materials by variant."""

from typing import Any

import pytest

from moka.core.errors import ModelError
from moka.model import Model, load_model
from tests.support.gltf_file import GltfFile


def shoes(mappings: list[dict[str, Any]]) -> Model:
    """Two variants, three materials, one primitive with ``mappings``."""
    file = GltfFile()
    for shade in (0.1, 0.2, 0.3):
        file.unlit(shade, shade, shade, 1)
    mesh = file.quad(
        material=0,
        extensions={"KHR_materials_variants": {"mappings": mappings}},
    )
    file.node(mesh=mesh)
    file.document["extensions"] = {
        "KHR_materials_variants": {
            "variants": [{"name": "beach"}, {"name": "street"}]
        }
    }
    return load_model(file.glb())


def test_a_primitive_has_a_material_for_each_variant() -> None:
    model = shoes([{"material": 2, "variants": [1]}])
    assert model.variants == ("beach", "street")
    primitive = model.meshes[0].primitives[0]
    assert primitive.of_variant(None) is primitive
    assert primitive.of_variant(0) is primitive
    other = primitive.of_variant(1)
    assert other.material is model.materials[2]
    assert primitive.material is model.materials[0]
    # The same geometry, and the same object again.
    assert other.geometry is primitive.geometry
    assert primitive.of_variant(1) is other
    assert model.unsupported_extensions == ()


def test_a_variant_is_chosen_by_name_or_number() -> None:
    model = shoes([])
    assert model.variant_index("street") == model.variant_index(1) == 1
    assert model.variant_index(None) is None
    for wrong in ("shore", 2, -1):
        with pytest.raises(ModelError) as caught:
            model.variant_index(wrong)
        assert str(caught.value) == (
            f"a model: there is no variant {wrong!r}; choose from 0 'beach', "
            "1 'street'"
        )


def test_a_model_may_have_none() -> None:
    model = load_model(b'{"asset": {"version": "2.0"}}')
    assert model.variants == ()
    with pytest.raises(ModelError, match="a model: the model has no variants"):
        model.variant_index("beach")


@pytest.mark.parametrize(
    ("mappings", "message"),
    [
        (
            [{"material": 3, "variants": [0]}],
            "mappings[0].material: there is no materials[3], the file has 3",
        ),
        (
            [{"material": 1, "variants": [0, 2]}],
            "mappings[0].variants[1]: there is no variants[2], the file has 2",
        ),
        (
            [
                {"material": 1, "variants": [0]},
                {"material": 2, "variants": [0]},
            ],
            "mappings[1].variants[0]: variant 0 has a material already",
        ),
    ],
)
def test_says_what_is_wrong(
    mappings: list[dict[str, Any]], message: str
) -> None:
    with pytest.raises(ModelError) as caught:
        shoes(mappings)
    prefix = "meshes[0].primitives[0].extensions.KHR_materials_variants."
    assert prefix + message in str(caught.value)
