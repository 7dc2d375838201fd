"""Shader source: what the text is, and what a person reads in an error."""

from pathlib import Path

import pytest

from moka.backend.contexts import open_context
from moka.commands.descriptors import ShaderText
from moka.core.errors import ShaderError
from moka.core.resources import shader_folder
from moka.graphics.shader_source import (
    explain_log,
    load_shader,
    preprocess_shader,
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "include").mkdir()
    return tmp_path


def write(folder: Path, **files: str) -> None:
    for name, text in files.items():
        suffix = "frag" if name == "main" else "glsl"
        place = folder if name == "main" else folder / "include"
        (place / f"{name}.{suffix}").write_text(text)


def test_the_head_is_version_then_sorted_defines_then_injected_text(folder):
    write(folder, main="void main() {}\n")
    text = load_shader(
        "main.frag",
        {"MOKA_B": 2, "MOKA_A": "vec3(1.0)", "MOKA_C": True, "MOKA_D": ""},
        injected="struct S { int a; };",
        version=430,
        folder=folder,
    )
    assert text.source.splitlines() == [
        "#version 430 core",
        "#define MOKA_A vec3(1.0)",
        "#define MOKA_B 2",
        "#define MOKA_C 1",
        "#define MOKA_D",
        "struct S { int a; };",
        "#line 10001 1",
        "void main() {}",
    ]
    assert text.files == ("main.frag (generated head)", "main.frag")


def test_equal_permutations_are_equal_texts(folder):
    write(folder, main="void main() {}\n")
    one = load_shader("main.frag", {"MOKA_A": 1, "MOKA_B": 2}, folder=folder)
    two = load_shader("main.frag", {"MOKA_B": 2, "MOKA_A": 1}, folder=folder)
    assert one == two


def test_a_file_included_twice_appears_once_and_lines_are_counted(folder):
    write(
        folder,
        main='#include "include/a.glsl"\n#include "include/b.glsl"\nmain\n',
        a="a1\na2\n",
        b='#include "include/a.glsl"\nb2\n',
    )
    text = load_shader("main.frag", folder=folder)
    assert text.files[1:] == ("main.frag", "include/a.glsl", "include/b.glsl")
    assert text.source.splitlines()[1:] == [
        "#line 10001 1",
        "#line 20001 2",
        "a1",
        "a2",
        "#line 10002 1",
        "#line 30001 3",
        "#line 30002 3",
        "b2",
        "#line 10003 1",
        "main",
    ]


def test_a_source_in_memory_includes_files(folder):
    write(folder, a="a1\n")
    text = preprocess_shader(
        '#include "include/a.glsl"\nmain\n',
        {"MOKA_A": 1},
        name="triangle",
        folder=folder,
    )
    assert text.files[1:] == ("triangle", "include/a.glsl")
    assert text.source.splitlines()[1:] == [
        "#define MOKA_A 1",
        "#line 10001 1",
        "#line 20001 2",
        "a1",
        "#line 10002 1",
        "main",
    ]


@pytest.mark.parametrize(
    ("files", "message"),
    [
        (
            {"main": '\n#include "include/gone.glsl"\n'},
            r"main\.frag:2: cannot read shader .*gone\.glsl: No such file",
        ),
        (
            {
                "main": '#include "include/a.glsl"\n',
                "a": '#include "include/b.glsl"\n',
                "b": '\n#include "include/a.glsl"\n',
            },
            r"include/b\.glsl:2: files include each other: include/a\.glsl "
            r"-> include/b\.glsl -> include/a\.glsl",
        ),
        (
            {"main": '#if MOKA_A\n#include "include/a.glsl"\n#endif', "a": ""},
            r"main\.frag:2: .*depends on a condition",
        ),
        ({"main": "#include <a.glsl>\n"}, r"main\.frag:1: expected #include"),
    ],
)
def test_a_wrong_include_is_an_error_with_its_line(folder, files, message):
    write(folder, **files)
    with pytest.raises(ShaderError, match=message) as caught:
        load_shader("main.frag", folder=folder)
    assert "\n" not in str(caught.value)


def test_a_missing_shader_is_an_error(folder):
    with pytest.raises(ShaderError, match=r"cannot read shader .*no\.frag"):
        load_shader("no.frag", folder=folder)


@pytest.mark.parametrize(
    ("name", "value"),
    [("A", 1), ("MOKA_a", 1), ("MOKA_A", "1\n2"), ("MOKA_A", "1\\")],
)
def test_a_define_that_cannot_be_one_is_an_error(folder, name, value):
    write(folder, main="")
    with pytest.raises(ShaderError, match=r"main\.frag: #define"):
        load_shader("main.frag", {name: value}, folder=folder)


@pytest.mark.parametrize(
    ("log", "expected"),
    [
        (  # Mesa through ModernGL; it lost the number of the file
            "GLSL Compiler failed\n\nfragment_shader\n====\n"
            "0:20012(5): warning: `b' used uninitialized\n"
            "0:20012(5): error: `a' undeclared\n"
            "0:20013(5): error: `c' undeclared\n",
            "b.glsl:12: `a' undeclared",
        ),
        (
            "2:20001(9): preprocessor error: syntax error",
            "b.glsl:1: syntax error",
        ),
        (
            '2(20012) : error C1503: undefined variable "a"',
            'b.glsl:12: undefined variable "a"',
        ),
        (
            "ERROR: 2:20012: 'a' : undeclared identifier",
            "b.glsl:12: 'a' : undeclared identifier",
        ),
        ("0:3(1): error: bad", "head:3: bad"),
        ("0:99999(1): error: bad", "line 99999: bad"),
        (
            "GLSL Linker failed\n\nerror: unresolved `f'",
            "a.frag: unresolved `f'",
        ),
        ("", "a.frag: failed without a message"),
    ],
)
def test_a_log_is_explained_by_file_and_line(log, expected):
    text = ShaderText("", ("head", "a.frag", "b.glsl"))
    assert explain_log(log, text) == expected


@pytest.mark.parametrize(
    ("log", "expected"),
    [
        # Mesa has no lines for what two shaders do to each other.
        ("error: `f' differs\n", "a.vert and a.frag: `f' differs"),
        (
            "Vertex info\n-----------\n0(20012) : error C1: bad `f'\n",
            "b.glsl:12: bad `f'",
        ),
        (
            "Vertex info\n-----------\n0(10003) : warning C7: well\n\n"
            "Fragment info\n-------------\n0(20007) : error C1: bad `f'\n"
            "(0) : error C2003: incompatible options for link\n",
            "c.glsl:7: bad `f'",
        ),
        (
            "Vertex info\n-----------\n(0) : error C5145: no gl_Position\n",
            "a.vert: (0) : error C5145: no gl_Position",
        ),
        # In whose line?
        ("ERROR: 0:20003: bad", "a.vert and a.frag: ERROR: 0:20003: bad"),
        ("", "a.vert and a.frag: failed without a message"),
    ],
)
def test_a_log_of_the_linker_names_the_shaders_it_is_about(log, expected):
    vertex = ShaderText("", ("head", "a.vert", "b.glsl"))
    fragment = ShaderText("", ("head", "a.frag", "c.glsl"))
    assert explain_log(log, vertex, fragment) == expected


@pytest.mark.gpu
@pytest.mark.parametrize(
    ("broken", "line"),
    [
        ("float a;\nfloat f() { return b; }", 2),  # a semantic error
        ("\n\nfloat f() { return 1.0 }", 3),  # a syntax error
        ("\n#if A(\n#endif", 2),  # an error of the preprocessor
    ],
)
def test_the_driver_agrees(folder, broken, line):
    import moderngl

    write(
        folder,
        main='#include "include/good.glsl"\n#include "include/bad.glsl"\n'
        "void main() {}\n",
        good="\n\n\n",
        bad=broken,
    )
    text = load_shader("main.frag", {"MOKA_A": 1}, folder=folder)
    # Not one that ModernGL makes: that would stay current on this thread.
    with (
        open_context("egl") as context,
        pytest.raises(moderngl.Error) as caught,
    ):
        context.gl.program(
            vertex_shader="#version 330 core\nvoid main() {}\n",
            fragment_shader=text.source,
        )
    explanation = explain_log(str(caught.value), text)
    assert explanation.startswith(f"include/bad.glsl:{line}: ")


def test_every_include_of_the_shaders_can_be_read():
    for path in shader_folder().glob("*.[vf]*"):
        assert load_shader(path.name).files[1] == path.name
