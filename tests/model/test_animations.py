"""Animations as records: what is read, and what is refused."""

import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from moka.core.errors import ModelError
from moka.model import load_model
from moka.model.animation import AnimationTarget, Interpolation
from tests.model.files import glb, triangle
from tests.support.animated import AnimatedFile

UP = np.array([(0, 0, 0), (0, 1, 0), (0, 4, 0)], np.float32)
TIMES = [0.0, 0.5, 2.0]


def test_a_channel_holds_times_values_and_its_target() -> None:
    file = AnimatedFile(2)
    file.channel((1, "translation"), TIMES, UP)
    (animation,) = load_model(file.glb()).animations
    assert (animation.name, animation.duration) == ("move", 2.0)
    (channel,) = animation.channels
    assert channel.target == AnimationTarget("node", 1, "translation")
    assert channel.interpolation is Interpolation.LINEAR
    np.testing.assert_array_equal(channel.times, np.float32(TIMES))
    np.testing.assert_array_equal(channel.values, UP)


def test_cubic_splines_have_three_values_a_key() -> None:
    file = AnimatedFile()
    values = np.arange(2 * 3 * 3, dtype=np.float32).reshape(6, 3)
    file.channel((0, "scale"), [0, 1], values, "CUBICSPLINE")
    ((channel,),) = (a.channels for a in load_model(file.glb()).animations)
    np.testing.assert_array_equal(channel.values, values.reshape(2, 3, 3))


@pytest.mark.parametrize(
    ("dtype", "largest"), [("i1", 127), ("u1", 255), ("i2", 32767)]
)
def test_normalised_integers_become_floats(dtype: str, largest: int) -> None:
    file = AnimatedFile()
    quaternions = np.array([(0, 0, 0, largest), (largest, 0, 0, 0)], dtype)
    output = file.accessor(quaternions, normalized=True)
    file.channel((0, "rotation"), [0, 1], output)
    ((channel,),) = (a.channels for a in load_model(file.glb()).animations)
    assert channel.values.dtype == np.float32
    np.testing.assert_array_equal(channel.values, [(0, 0, 0, 1), (1, 0, 0, 0)])


def test_weights_are_grouped_by_keyframe() -> None:
    file = AnimatedFile()
    file.morph_targets(3)
    weights = np.arange(6, dtype=np.float32)
    file.channel((0, "weights"), [0, 1], weights)
    spline = np.arange(18, dtype=np.float32)
    file.channel(
        (0, "weights"), [0, 1], spline, "CUBICSPLINE", animation="spline"
    )
    first, second = load_model(file.glb()).animations
    np.testing.assert_array_equal(
        first.channels[0].values, weights.reshape(2, 3)
    )
    np.testing.assert_array_equal(
        second.channels[0].values, spline.reshape(2, 3, 3)
    )


def test_channels_share_the_times_that_the_file_shares() -> None:
    file = AnimatedFile()
    times = file.accessor(TIMES)
    file.channel((0, "translation"), times, UP)
    file.channel((0, "scale"), times, UP)
    (animation,) = load_model(file.glb()).animations
    first, second = animation.channels
    assert first.times is second.times


def test_targets_are_rows_of_the_tree_and_not_indices_of_the_file() -> None:
    file = AnimatedFile(2)
    file.document["nodes"][1]["children"] = [0]
    file.document["scenes"] = [{"nodes": [1]}]
    file.channel((0, "translation"), TIMES, UP)
    model = load_model(file.glb())
    target = model.animations[0].channels[0].target
    assert model.nodes.source[target.index] == 0
    assert target.index == 1


def test_the_rest_pose_keeps_the_parts_of_a_mirrored_node() -> None:
    file = AnimatedFile(3)
    file.document["nodes"][2] |= {
        "translation": [1, 2, 3],
        "rotation": [1, 0, 0, 0],
        "scale": [-1, 1, 2],
    }
    file.channel((2, "rotation"), [0], [(0.0, 0.0, 0.0, 1.0)])
    rest = load_model(file.glb()).rest_pose
    assert rest is not None
    np.testing.assert_array_equal(rest.nodes, [2])
    np.testing.assert_array_equal(rest.translation, [(1, 2, 3)])
    np.testing.assert_array_equal(rest.rotation, [(1, 0, 0, 0)])
    np.testing.assert_array_equal(rest.scale, [(-1, 1, 2)])


def test_weights_of_a_mesh_with_instances_are_those_of_each() -> None:
    file = AnimatedFile(2)
    file.morph_targets(2)
    places = file.accessor(np.zeros((3, 3)))
    file.document["nodes"][0]["extensions"] = {
        "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}
    }
    file.document["extensionsUsed"] = ["EXT_mesh_gpu_instancing"]
    file.channel((0, "weights"), [0, 1], np.eye(2).ravel())
    file.channel((0, "translation"), [0], [(1.0, 2.0, 3.0)])
    model = load_model(file.glb())
    *weights, moved = model.animations[0].channels
    rows = [channel.target.index for channel in weights]
    assert len(rows) == 3
    assert (model.nodes.mesh[rows] == 0).all()
    assert (model.nodes.parents[rows] == moved.target.index).all()


def test_a_channel_without_a_node_is_counted_and_left_out() -> None:
    file = AnimatedFile()
    file.channel((0, "translation"), TIMES, UP)
    del file.document["animations"][0]["channels"][0]["target"]["node"]
    model = load_model(file.glb())
    assert model.animations[0].channels == ()
    assert model.animations[0].duration == 0
    assert model.omitted == {"animation channels": 1}


def edited(path: str, value: Any) -> AnimatedFile:
    """A whole file with one thing of its first animation replaced."""
    file = AnimatedFile(2)
    file.channel((0, "translation"), TIMES, UP)
    place = file.document["animations"][0]
    *steps, last = path.split("/")
    for step in steps:
        place = place[int(step) if step.isdecimal() else step]
    if value is None:
        del place[last]
    else:
        place[last] = value
    return file


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (
            "channels/0/sampler",
            3,
            "animations[0].channels[0].sampler: there is no samplers[3]",
        ),
        ("channels/0/sampler", None, "animations[0].channels[0]: object"),
        (
            "channels/0/target/node",
            7,
            "animations[0].channels[0].target.node: there is no nodes[7]",
        ),
        (
            "channels/0/target/path",
            "colour",
            "animations[0].channels[0].target.path: invalid enum value",
        ),
        (
            "channels/0/target/path",
            "rotation",
            "animations[0].samplers[0].output: accessors[3] is VEC3, and "
            "rotation needs VEC4",
        ),
        (
            "channels/0/target/path",
            "weights",
            "animations[0].channels[0].target.node: nodes[0] has 0 morph",
        ),
        (
            "channels/0/target/path",
            "pointer",
            "animations[0].channels[0].target.extensions: KHR_animation_",
        ),
        (
            "samplers/0/interpolation",
            "BEZIER",
            "animations[0].samplers[0].interpolation: invalid enum value",
        ),
        (
            "samplers/0/interpolation",
            "CUBICSPLINE",
            "animations[0].samplers[0].output: accessors[3] has 3 elements, "
            "and the keyframes need 9",
        ),
        (
            "samplers/0/input",
            9,
            "there is no accessors[9], the file has 4",
        ),
        (
            "samplers/0/output",
            9,
            "animations[0].samplers[0].output: there is no accessors[9]",
        ),
        (
            "samplers/0/input",
            3,
            "animations[0].samplers[0].input: accessors[3] must hold times",
        ),
    ],
)
def test_a_broken_animation_is_refused(
    path: str, value: Any, message: str
) -> None:
    with pytest.raises(ModelError) as caught:
        load_model(edited(path, value).glb())
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ([0.0, 1.0, 1.0], "must increase; 1 s follows 1 s at keyframe 2"),
        ([0.0, 2.0, 1.0], "must increase; 1 s follows 2 s at keyframe 2"),
        ([-1.0, 0.0, 1.0], "must hold finite times from 0 s on"),
        ([0.0, 1.0, np.inf], "must hold finite times from 0 s on"),
        ([0.0, np.nan, 1.0], "must hold finite times from 0 s on"),
        ([0.0, 1.0], "has 3 elements, and the keyframes need 2"),
    ],
)
def test_times_that_make_no_sense_are_refused(
    times: list[float], message: str
) -> None:
    file = AnimatedFile()
    file.channel((0, "translation"), times, UP)
    with pytest.raises(
        ModelError, match=r"animations\[0\]\.samplers\[0\]\."
    ) as e:
        load_model(file.glb())
    assert message in str(e.value)


def test_a_spline_of_one_key_is_refused() -> None:
    file = AnimatedFile()
    file.channel((0, "translation"), [0], UP, "CUBICSPLINE")
    with pytest.raises(ModelError, match=r"input: has one keyframe"):
        load_model(file.glb())


def test_values_that_are_not_finite_are_refused() -> None:
    file = AnimatedFile()
    file.channel((0, "translation"), [0], [(0.0, np.nan, 0.0)])
    with pytest.raises(ModelError, match=r"accessors\[3\] has values that"):
        load_model(file.glb())


def test_integers_are_no_translation() -> None:
    file = AnimatedFile()
    output = file.accessor(np.zeros((1, 3), "i2"), normalized=True)
    file.channel((0, "translation"), [0], output)
    with pytest.raises(ModelError, match="must be floats for translation"):
        load_model(file.glb())


def test_two_channels_of_one_target_are_refused() -> None:
    file = AnimatedFile()
    file.channel((0, "translation"), TIMES, UP)
    file.channel((0, "translation"), TIMES, UP)
    with pytest.raises(
        ModelError,
        match=r"channels\[1\]\.target: is the same as that of "
        r"animations\[0\]\.channels\[0\]",
    ):
        load_model(file.glb())


def test_a_matrix_cannot_be_animated() -> None:
    file = AnimatedFile()
    file.document["nodes"][0]["matrix"] = np.eye(4).ravel().tolist()
    file.channel((0, "translation"), TIMES, UP)
    with pytest.raises(ModelError, match=r"target\.node: nodes\[0\] has a mat"):
        load_model(file.glb())


def test_a_model_without_animation_imports_nothing_of_it() -> None:
    program = (
        "import sys; from moka.model import load_model;"
        "load_model(sys.stdin.buffer.read());"
        "print([m for m in sys.modules if 'anim' in m])"
    )
    result = subprocess.run(
        [sys.executable, "-c", program],
        input=glb(triangle()),
        capture_output=True,
        check=True,
    )
    assert result.stdout.strip() == b"[]"
