"""Reads animations, and finds what is wrong with them before they play.

Source: glTF 2.0 specification, section 3.11 (animations), and
KHR_animation_pointer.
"""

import math
from typing import Literal

import msgspec
import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from moka.model import schema
from moka.model.accessors import AccessorReader
from moka.model.animation import (
    PROPERTIES,
    Animation,
    AnimationChannel,
    AnimationTarget,
    Interpolation,
    RestPose,
)
from moka.model.nodes import NodeTree
from moka.model.source import GltfSource

__all__ = ["read_animations"]

_FLOAT = 5126
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
_TRANSFORM = ("translation", "rotation", "scale")


class _Target(schema.Property):
    path: Literal["translation", "rotation", "scale", "weights", "pointer"]
    node: schema.Index | None = None


class _Channel(schema.Property):
    sampler: schema.Index
    target: _Target


class _Sampler(schema.Property):
    input: schema.Index
    output: schema.Index
    interpolation: Literal["LINEAR", "STEP", "CUBICSPLINE"] = "LINEAR"


class _Animation(schema.Property):
    channels: list[_Channel]
    samplers: list[_Sampler]
    name: str = ""


def read_animations(
    source: GltfSource, nodes: NodeTree, light_count: int
) -> tuple[list[Animation], RestPose | None, int]:
    """All animations, the rest pose of what they move, and what is left out.

    The last is the number of channels that move nothing that moka draws.
    Raises ModelError, naming the JSON path, for times that do not increase,
    values of a wrong type or number, references to nothing, two channels of
    one target, and animated nodes with a matrix.
    """
    reader = _AnimationReader(source, nodes, light_count)
    animations = [
        reader.animation(f"animations[{index}]", raw)
        for index, raw in enumerate(source.document.animations)
    ]
    return animations, _rest_pose(source, nodes, animations), reader.left_out


class _AnimationReader:
    """What the animations of one file share: accessors that were checked."""

    def __init__(
        self, source: GltfSource, nodes: NodeTree, light_count: int
    ) -> None:
        self.left_out = 0
        self._source = source
        self._accessors = AccessorReader(source)
        self._light_count = light_count
        self._times: dict[int, NDArray[np.float32]] = {}
        self._nodes = nodes
        self._rows = nodes.rows_of_file()
        self._is_instance = nodes.source < 0

    def animation(self, path: str, raw: msgspec.Raw) -> Animation:
        source = self._source
        read = schema.decode_part(raw, _Animation, source.where, path)
        channels: list[AnimationChannel] = []
        places: dict[AnimationTarget, str] = {}
        for number, channel in enumerate(read.channels):
            place = f"{path}.channels[{number}]"
            source.check_index(
                f"{place}.sampler",
                channel.sampler,
                "samplers",
                len(read.samplers),
            )
            targets = self._targets(f"{place}.target", channel.target)
            self.left_out += not targets
            for target, width in targets:
                other = places.setdefault(target, place)
                if other is not place:
                    raise source.error(
                        f"{place}.target", f"is the same as that of {other}"
                    )
                channels.append(
                    self._channel(
                        f"{path}.samplers[{channel.sampler}]",
                        read.samplers[channel.sampler],
                        target,
                        width,
                    )
                )
        if any(each.target.kind == "material" for each in channels):
            from moka.model.animated_materials import with_whole_emission

            channels = with_whole_emission(source, channels)
        return Animation(
            read.name,
            max((float(each.times[-1]) for each in channels), default=0.0),
            tuple(channels),
        )

    def _targets(
        self, path: str, target: _Target
    ) -> list[tuple[AnimationTarget, int]]:
        """What a channel moves, and by how many numbers a keyframe."""
        source = self._source
        if target.path == "pointer":
            from moka.model.animation_pointer import read_pointer, targets_of

            pointer = read_pointer(source, path, target)
            path = f"{path}.extensions.KHR_animation_pointer.pointer"
            targets = targets_of(source, path, pointer, self._light_count)
            return [
                found for each in targets for found in self._checked(path, each)
            ]
        if target.node is None:
            return []
        path = f"{path}.node"
        source.check_index(path, target.node, "nodes", len(self._rows))
        found = AnimationTarget("node", target.node, target.path)
        return self._checked(path, found)

    def _checked(
        self, path: str, target: AnimationTarget
    ) -> list[tuple[AnimationTarget, int]]:
        """A target, nodes by their row from here on, and its width.

        Weights of a mesh with instances are those of each of its instances.
        """
        width = PROPERTIES[target.kind, target.property]
        if target.kind != "node":
            return [(target, width)]
        document = self._source.document
        node = document.nodes[target.index]
        if target.property in _TRANSFORM and node.matrix is not None:
            raise self._source.error(
                path,
                f"nodes[{target.index}] has a matrix, of which no part can "
                "be animated; give it translation, rotation and scale",
            )
        if target.property == "weights":
            count = 0
            if node.mesh is not None and node.mesh < len(document.meshes):
                count = document.meshes[node.mesh].target_count
            if (target.element or 0) >= count:
                raise self._source.error(
                    path, f"nodes[{target.index}] has {count} morph targets"
                )
            width = count if target.element is None else 1
        rows = [int(self._rows[target.index])]
        if target.property == "weights" and self._nodes.mesh[rows[0]] < 0:
            instances = (self._nodes.parents == rows[0]) & self._is_instance
            rows = np.flatnonzero(instances).tolist()
        return [(replace(target, index=row), width) for row in rows]

    def _channel(
        self,
        path: str,
        sampler: _Sampler,
        target: AnimationTarget,
        width: int,
    ) -> AnimationChannel:
        interpolation = Interpolation(sampler.interpolation)
        times = self._read_times(f"{path}.input", sampler.input)
        shape: tuple[int, ...] = (len(times), width)
        if interpolation is Interpolation.CUBICSPLINE:
            shape = (len(times), 3, width)
            if len(times) < 2:
                raise self._source.error(
                    f"{path}.input",
                    "has one keyframe, and a CUBICSPLINE needs two",
                )
        if target.property == "visible" and sampler.interpolation != "STEP":
            raise self._source.error(
                f"{path}.interpolation",
                f"is {sampler.interpolation}; true and false need STEP",
            )
        # Weights are scalars, however many belong to a keyframe.
        components = 1 if target.property == "weights" else width
        values = self._read_values(
            f"{path}.output",
            sampler.output,
            target,
            components,
            math.prod(shape) // components,
        )
        return AnimationChannel(
            target, interpolation, times, values.reshape(shape)
        )

    def _read_times(self, path: str, index: int) -> NDArray[np.float32]:
        """The times of an accessor, checked once for all that share it."""
        times = self._times.get(index)
        if times is not None:
            return times
        source = self._source
        times = self._accessors.floats(index)
        accessor = source.document.accessors[index]
        if accessor.type != "SCALAR" or accessor.component_type != _FLOAT:
            raise source.error(
                path, f"accessors[{index}] must hold times as scalar floats"
            )
        if not (np.isfinite(times).all() and times[0] >= 0):
            raise source.error(
                path, f"accessors[{index}] must hold finite times from 0 s on"
            )
        late = np.flatnonzero(np.diff(times) <= 0)
        if len(late):
            before, after = times[late[0] : late[0] + 2].tolist()
            raise source.error(
                path,
                f"the times of accessors[{index}] must increase; "
                f"{after:g} s follows {before:g} s at keyframe {late[0] + 1}",
            )
        self._times[index] = times
        return times

    def _read_values(
        self,
        path: str,
        index: int,
        target: AnimationTarget,
        components: int,
        count: int,
    ) -> NDArray[np.float32]:
        source = self._source
        accessors = source.document.accessors
        source.check_index(path, index, "accessors", len(accessors))
        accessor = accessors[index]
        wanted = _TYPES[components]
        if accessor.type != wanted:
            raise source.error(
                path,
                f"accessors[{index}] is {accessor.type}, and "
                f"{target.property} needs {wanted}",
            )
        is_float = accessor.component_type == _FLOAT
        if target.kind == "node" and target.property != "visible":
            packs = target.property in ("rotation", "weights")
            if not is_float and not (packs and accessor.normalized):
                or_packed = " or normalised integers" if packs else ""
                raise source.error(
                    path,
                    f"accessors[{index}] must be floats{or_packed} for "
                    f"{target.property}",
                )
        if accessor.count != count:
            raise source.error(
                path,
                f"accessors[{index}] has {accessor.count} elements, and the "
                f"keyframes need {count}",
            )
        values = self._accessors.floats(index)
        if not np.isfinite(values).all():
            raise source.error(
                path, f"accessors[{index}] has values that are not finite"
            )
        return values


def _rest_pose(
    source: GltfSource, tree: NodeTree, animations: list[Animation]
) -> RestPose | None:
    rows = {
        channel.target.index
        for animation in animations
        for channel in animation.channels
        if channel.target.kind == "node"
        and channel.target.property in _TRANSFORM
    }
    if not rows:
        return None
    moved = np.array(sorted(rows), np.int32)
    nodes = [source.document.nodes[i] for i in tree.source[moved].tolist()]
    return RestPose(
        moved,
        np.array([node.translation for node in nodes]),
        np.array([node.rotation for node in nodes]),
        np.array([node.scale for node in nodes]),
    )
