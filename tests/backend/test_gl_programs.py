"""Programs are begun, all of them, before anything is asked of one."""

import pytest

from moka.backend import gl_constants as c
from moka.backend.gl_programs import BindingPoints, GlProgram
from moka.commands.descriptors import ProgramDescriptor, ShaderText
from moka.core.errors import ShaderError
from tests.support.paper_driver import PaperDriver


def describe(
    vertex: str = "vertex", fragment: str = "fragment"
) -> ProgramDescriptor:
    return ProgramDescriptor(
        ShaderText(vertex, ("head", "a.vert")),
        ShaderText(fragment, ("head", "a.frag")),
        "program a",
    )


def explain(log: str, *texts: ShaderText) -> str:
    return " ".join([*(text.files[1] for text in texts), "|", log])


def test_all_link_before_the_first_question() -> None:
    driver = PaperDriver()
    programs = [GlProgram(driver.functions, describe()) for _ in range(3)]
    assert {name for name, *_ in driver.calls} == {
        *("CreateProgram", "CreateShader", "ShaderSource"),
        *("CompileShader", "AttachShader", "LinkProgram"),
    }
    assert driver.called("LinkProgram") == [(each.name,) for each in programs]
    driver.calls.clear()
    for program in programs:
        program.finish(BindingPoints(), explain)
    # One question where all is well, and nothing is made any more.
    statuses = [
        each[0]
        for each in driver.called("GetProgramiv")
        if each[1] == c.LINK_STATUS
    ]
    assert statuses == [each.name for each in programs]
    assert not driver.called("GetShaderiv")
    assert driver.alive == {each.name for each in programs}


def test_what_is_outside_of_blocks_is_a_sampler() -> None:
    uniforms = {
        "cube": -1,
        "block_member": 0,
        "texels": -1,
        "array[0]": -1,
        "gl_DepthRange.near": -1,
    }
    driver = PaperDriver(
        ["position", "gl_VertexID", "instance_data"],
        uniforms,
        {"Frame": 64, "Lights": 512},
    )
    points = BindingPoints()
    assert points.point("Lights") == 0
    program = GlProgram(driver.functions, describe())
    program.finish(points, explain)
    assert program.samplers == {"cube": 0, "texels": 1, "array": 2}
    # Location, unit: in the program that is current.
    assert driver.called("Uniform1i") == [(0, 0), (2, 1), (3, 2)]
    assert driver.called("UseProgram") == [(program.name,)]
    assert points.units == 3
    assert program.attributes == {"position": 0, "instance_data": 2}
    # Index of the block, binding point of its name.
    assert program.blocks == {"Frame": (1, 64), "Lights": (0, 512)}
    assert driver.called("UniformBlockBinding") == [
        (program.name, 0, 1),
        (program.name, 1, 0),
    ]


@pytest.mark.parametrize("places", [(), (0,), (99,), (0, 17, 98), (40, 41)])
def test_samplers_are_found_among_many_members(places: tuple[int, ...]) -> None:
    uniforms = {
        f"uniform_{index}": -1 if index in places else 0 for index in range(100)
    }
    driver = PaperDriver(uniforms=uniforms, blocks={"Materials": 16384})
    program = GlProgram(driver.functions, describe())
    program.finish(BindingPoints(), explain)
    expected = [f"uniform_{place}" for place in places]
    assert list(program.samplers) == expected
    asked = sum(each[1] for each in driver.called("GetActiveUniformsiv"))
    assert asked <= 100
    if places == (99,):
        # Where the last ones are all that there are, others are not looked at.
        assert asked < 20


def test_units_are_those_of_the_program_that_reads_most() -> None:
    points = BindingPoints()
    for uniforms in ({}, {"a": -1, "b": -1}, {"a": -1}):
        driver = PaperDriver(uniforms=uniforms)
        GlProgram(driver.functions, describe()).finish(points, explain)
    assert points.units == 2


@pytest.mark.parametrize(
    ("descriptor", "message"),
    [
        (describe("broken"), "a.vert | log of broken"),
        (describe(fragment="broken f"), "a.frag | log of broken f"),
        (describe("broken v", "broken f"), "a.vert | log of broken v"),
        (describe("apart"), "a.vert a.frag | log of the linker"),
    ],
)
def test_the_shader_at_fault_is_explained(
    descriptor: ProgramDescriptor, message: str
) -> None:
    driver = PaperDriver()
    program = GlProgram(driver.functions, descriptor)
    with pytest.raises(ShaderError) as caught:
        program.finish(BindingPoints(), explain)
    assert str(caught.value) == message
    program.release()
    assert not driver.alive


@pytest.mark.parametrize("is_finished", [True, False])
def test_what_is_released_leaves_nothing(is_finished: bool) -> None:
    driver = PaperDriver()
    program = GlProgram(driver.functions, describe())
    if is_finished:
        program.finish(BindingPoints(), explain)
    assert driver.alive
    program.release()
    assert not driver.alive
