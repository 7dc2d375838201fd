"""Vertex arrays point attributes at buffers, instances at their rows."""

from types import SimpleNamespace
from typing import Any

import pytest

from moka.backend import gl_constants as c
from moka.backend.gl_programs import BindingPoints, GlProgram
from moka.backend.gl_vertex_arrays import (
    VertexSource,
    bind_instances,
    make_vertex_array,
)
from moka.commands.descriptors import (
    IndexType,
    ProgramDescriptor,
    ShaderText,
    Topology,
    VertexAttribute,
    VertexLayout,
)
from moka.commands.handles import Handle, ResourceKind
from moka.core.errors import DeviceError
from tests.support.paper_driver import PaperDriver

VERTICES = Handle(ResourceKind.BUFFER, 1, 0, 0)
INDICES = Handle(ResourceKind.BUFFER, 2, 0, 0)
INSTANCES = SimpleNamespace(glo=33)

LAYOUT = VertexLayout(
    (
        VertexAttribute("position", "f4", 3, 0),
        VertexAttribute("unread", "f4", 2, 12),
        VertexAttribute("colour", "u1", 4, 20, normalised=True),
    ),
    24,
)


def buffer_of(handle: Handle) -> Any:
    return SimpleNamespace(glo=10 + handle.index)


def program_of(driver: PaperDriver) -> GlProgram:
    text = ShaderText("text")
    program = GlProgram(
        driver.functions, ProgramDescriptor(text, text, "quads")
    )
    program.finish(BindingPoints(), lambda log, *_: log)
    driver.calls.clear()
    return program


def source_of(
    layout: VertexLayout | None, indices: Handle | None
) -> VertexSource:
    return VertexSource(
        *(Topology.TRIANGLES, layout, VERTICES, indices, IndexType.UINT16)
    )


def test_attributes_and_instances_have_their_places() -> None:
    driver = PaperDriver(
        ["position", "colour", "instance_row_1", "instance_data"]
    )
    gl, program = driver.functions, program_of(driver)
    array = make_vertex_array(
        gl, program, source_of(LAYOUT, INDICES), buffer_of, INSTANCES
    )
    assert driver.called("BindVertexArray") == [(array,)]
    assert driver.called("BindBuffer") == [
        (c.ELEMENT_ARRAY_BUFFER, 12),
        (c.ARRAY_BUFFER, 11),
        (c.ARRAY_BUFFER, 33),
    ]
    assert driver.called("VertexAttribPointer") == [
        (0, 3, c.FLOAT, False, 24, 0),
        (1, 4, c.UNSIGNED_BYTE, True, 24, 20),
        (2, 4, c.FLOAT, False, 64, 16),
    ]
    # Whole numbers stay whole.
    whole = [(3, 4, c.UNSIGNED_INT, 64, 48)]
    assert driver.called("VertexAttribIPointer") == whole
    enabled = driver.called("EnableVertexAttribArray")
    assert sorted(enabled) == [(0,), (1,), (2,), (3,)]
    assert sorted(driver.called("VertexAttribDivisor")) == [(2, 1), (3, 1)]

    driver.calls.clear()
    bind_instances(gl, program, INSTANCES, 5)
    assert driver.called("VertexAttribPointer") == [
        (2, 4, c.FLOAT, False, 64, 5 * 64 + 16)
    ]
    assert driver.called("VertexAttribIPointer") == [
        (3, 4, c.UNSIGNED_INT, 64, 5 * 64 + 48)
    ]


def test_without_buffers_nothing_is_pointed_at_them() -> None:
    driver = PaperDriver(["instance_row_0"])
    program = program_of(driver)
    make_vertex_array(
        driver.functions, program, source_of(None, None), buffer_of, INSTANCES
    )
    assert driver.called("BindBuffer") == [(c.ARRAY_BUFFER, 33)]
    assert driver.called("EnableVertexAttribArray") == [(0,)]


def test_a_missing_attribute_is_named_before_anything_is_made() -> None:
    driver = PaperDriver(["position", "tangent", "instance_data"])
    program = program_of(driver)
    with pytest.raises(DeviceError, match="quads: reads attribute 'tangent'"):
        make_vertex_array(
            *(driver.functions, program, source_of(LAYOUT, None)),
            *(buffer_of, INSTANCES),
        )
    assert not driver.calls
