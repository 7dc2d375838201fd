"""What goes to the GPU of a primitive that needs tangents."""

import subprocess
import sys

import numpy as np

from moka.model import Primitive, quad
from moka.renderer.vertices import vertices_of

WANTED = ("POSITION", "NORMAL", "TANGENT_OF_UV_0", "TEXCOORD_0")


def test_tangents_are_made_for_the_set_that_is_asked_for() -> None:
    base = quad()
    turned = base.attributes["TEXCOORD_0"][:, ::-1]
    primitive = Primitive(
        {**base.attributes, "TEXCOORD_1": turned}, base.indices
    )
    for number, along in ((0, (1, 0, 0)), (1, (0, -1, 0))):
        name = f"TANGENT_OF_UV_{number}"
        made = vertices_of(primitive, (*WANTED[:2], name))
        assert made.count == primitive.vertex_count
        np.testing.assert_allclose(
            made.attributes[name][:, :3], [along] * made.count, atol=1e-6
        )


def test_what_needs_none_is_passed_on_and_imports_nothing() -> None:
    primitive = quad()
    made = vertices_of(primitive, ("POSITION", "NORMAL"))
    assert made.attributes is primitive.attributes
    code = (
        "import sys\nfrom moka.model import quad\n"
        "from moka.renderer.vertices import vertices_of\n"
        "vertices_of(quad(), ('POSITION', 'NORMAL'))\n"
        "print('moka.model.tangents' in sys.modules)"
    )
    output = subprocess.run(
        [sys.executable, "-c", code], check=True, capture_output=True, text=True
    ).stdout
    assert output.strip() == "False"
