"""Writing animations: what :mod:`moka.model.read_animations` reads."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from moka.model.animation import (
    Animation,
    AnimationChannel,
    rest_transforms,
)
from moka.model.animation_pointer import EXTENSION, pointer_to
from moka.model.binary import BinaryWriter
from moka.model.model import Model

if TYPE_CHECKING:
    import pygltflib

__all__ = ["split_animated_nodes", "write_animations"]

_PATHS = ("translation", "rotation", "scale", "weights")


def split_animated_nodes(gltf: "pygltflib.GLTF2", model: Model) -> None:
    """Give nodes whose parts move these parts in place of a matrix."""
    rows = sorted(
        {
            channel.target.index
            for animation in model.animations
            for channel in animation.channels
            if channel.target.kind == "node"
            and channel.target.property in _PATHS[:3]
        }
    )
    parts = rest_transforms(
        model.nodes, model.rest_pose, np.array(rows, np.intp)
    )
    for row, *values in zip(
        rows, *(part.tolist() for part in parts), strict=True
    ):
        node = gltf.nodes[row]
        node.matrix = None
        node.translation, node.rotation, node.scale = values


def write_animations(
    gltf: "pygltflib.GLTF2", model: Model, binary: BinaryWriter
) -> set[str]:
    """Write all animations; the names of the extensions that they need."""
    writer = _AnimationWriter(model, binary)
    gltf.animations = [writer.animation(each) for each in model.animations]
    return {EXTENSION} if writer.has_pointers else set()


class _AnimationWriter:
    def __init__(self, model: Model, binary: BinaryWriter) -> None:
        self.has_pointers = False
        self._model = model
        self._binary = binary

    def animation(self, animation: Animation) -> "pygltflib.Animation":
        import pygltflib

        strengthened = {
            channel.target.index
            for channel in animation.channels
            if channel.target.property == "emissive_strength"
        }
        return pygltflib.Animation(
            name=animation.name,
            samplers=[
                pygltflib.AnimationSampler(
                    input=self._binary.times(channel.times),
                    output=self._binary.values(
                        self._values(channel, strengthened)
                    ),
                    interpolation=channel.interpolation.value,
                )
                for channel in animation.channels
            ],
            channels=[
                pygltflib.AnimationChannel(
                    sampler=index, target=self._target(channel)
                )
                for index, channel in enumerate(animation.channels)
            ],
        )

    def _values(
        self, channel: AnimationChannel, strengthened: set[int]
    ) -> NDArray[Any]:
        """The keyframes as the file has them: one element in each row."""
        target, values = channel.target, channel.values
        if target.property == "visible":
            return values.reshape(-1).astype(np.uint8)
        if (
            target.property == "emissive_factor"
            and target.index not in strengthened
        ):
            # Without the strength that is written with the material.
            material = self._model.materials[target.index]
            values = values / np.float32(max(1.0, *material.emissive_factor))
        width = 1 if target.property == "weights" else values.shape[-1]
        rows = values.reshape(-1, width)
        return rows[:, 0] if width == 1 else rows

    def _target(self, channel: AnimationChannel) -> Any:
        import pygltflib

        target = channel.target
        is_plain = target.kind == "node" and target.element is None
        if is_plain and target.property in _PATHS:
            return pygltflib.AnimationChannelTarget(
                node=target.index, path=target.property
            )
        self.has_pointers = True
        return pygltflib.AnimationChannelTarget(
            path="pointer",
            extensions={
                EXTENSION: {"pointer": pointer_to(target, self._model)}
            },
        )
