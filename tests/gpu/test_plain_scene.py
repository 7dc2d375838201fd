"""What a file does not use costs it nothing: programs, counters, pixels.

Modules are pinned by tests/test_render_modules.py, words of shaders by
tests/renderer/test_pose_texture.py and tests/material.
"""

from typing import Any

import numpy as np
import pytest

from moka.app.render import render_request
from moka.app.render_request import RenderRequest
from moka.core.statistics import Statistics
from moka.material.description import Feature, describe_material
from moka.model import load_model
from tests.conformance.features import FEATURES
from tests.conformance.scene_file import SceneFile

pytestmark = pytest.mark.gpu


def plain() -> bytes:
    file = SceneFile()
    file.node(file.square(file.material((0.8, 0.2, 0.1), lit=True), 0.5))
    return file.glb()


def drawn(file: Any, **options: Any) -> tuple[np.ndarray, dict[str, int]]:
    """Radiance and counters, time left out."""
    statistics = Statistics()
    request = RenderRequest(
        file, size=(32, 32), environment="furnace", backend="egl", **options
    )
    image = render_request(
        request, statistics, want_pixels=True, want_display=False
    )
    assert image.pixels is not None
    return image.pixels, dict(statistics.counts)


def test_a_plain_scene_pays_nothing_after_all_others() -> None:
    pixels, counts = drawn(plain())
    assert pixels[..., :3].any()
    assert counts["objects"] == counts["permutations"] == 1
    # The surface, what is behind it, and the display.
    assert counts["gl_draws"] == 3
    assert counts["textures_loaded"] == 0
    for cases in FEATURES.values():
        drawn(cases[0].file())
        drawn(cases[-1].file())
    again, others = drawn(plain())
    assert others == counts
    np.testing.assert_array_equal(again, pixels)


def test_a_plain_material_asks_for_nothing() -> None:
    model = load_model(plain())
    (primitive,) = model.meshes[0].primitives
    description = describe_material(model.materials[0], primitive.attributes)
    assert description.features == Feature.VERTEX_NORMAL | Feature.DIFFUSE
    assert not description.textures
    assert description.attributes == ("POSITION", "NORMAL")
    assert not model.animations
    assert not model.skins
    assert not model.variants
    assert model.rest_pose is None
