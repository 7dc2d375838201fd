"""glTF files with animations, put together channel by channel."""

import copy
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tests.model.files import TRIANGLE, TRIANGLE_BINARY, glb

_CODES = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125}
_CODES["f4"] = 5126
_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


class AnimatedFile:
    """A document of nodes that show one triangle, and animations of them.

    ``document`` may be changed at will before :meth:`glb`.
    """

    def __init__(self, nodes: int = 1, **changes: Any) -> None:
        self.document: dict[str, Any] = copy.deepcopy(TRIANGLE)
        self.document["nodes"] = [
            {"mesh": 0, "name": f"node {index}"} for index in range(nodes)
        ]
        self.document["scenes"] = [{"nodes": list(range(nodes))}]
        self.document.update(copy.deepcopy(changes))
        self._binary = bytearray(TRIANGLE_BINARY)

    def accessor(
        self,
        array: ArrayLike,
        *,
        normalized: bool = False,
        scalars: bool = False,
    ) -> int:
        """An accessor of rows (N, C) or of numbers; floats are float32."""
        values: NDArray[Any] = np.asarray(array)
        if values.dtype.kind == "f" or values.dtype == np.int64:
            values = values.astype("<f4")
        width = 1 if scalars or values.ndim == 1 else values.shape[-1]
        self._binary += bytes(-len(self._binary) % 4)
        self.document["bufferViews"].append(
            {
                "buffer": 0,
                "byteOffset": len(self._binary),
                "byteLength": values.nbytes,
            }
        )
        self._binary += values.tobytes()
        self.document["accessors"].append(
            {
                "bufferView": len(self.document["bufferViews"]) - 1,
                "componentType": _CODES[values.dtype.str[1:]],
                "count": values.size // width,
                "type": _TYPES[width],
                "normalized": normalized,
            }
        )
        return len(self.document["accessors"]) - 1

    def animation(self, name: str) -> dict[str, Any]:
        """The animation of that name, made when it is first asked for."""
        animations = self.document.setdefault("animations", [])
        for animation in animations:
            if animation["name"] == name:
                return animation
        animations.append({"name": name, "channels": [], "samplers": []})
        return animations[-1]

    def channel(
        self,
        target: tuple[int, str] | str,
        times: ArrayLike | int,
        values: ArrayLike | int,
        interpolation: str = "LINEAR",
        *,
        animation: str = "move",
    ) -> None:
        """Move (node, path), or what a JSON pointer names.

        Times and values may be the index of an accessor that is there.
        """
        made = self.animation(animation)
        if isinstance(target, str):
            self.document["extensionsUsed"] = ["KHR_animation_pointer"]
            to: dict[str, Any] = {
                "path": "pointer",
                "extensions": {"KHR_animation_pointer": {"pointer": target}},
            }
            scalars = "weights" in target
        else:
            to = {"node": target[0], "path": target[1]}
            scalars = target[1] == "weights"
        if not isinstance(times, int):
            times = self.accessor(times)
        if not isinstance(values, int):
            values = self.accessor(values, scalars=scalars)
        made["samplers"].append(
            {"input": times, "output": values, "interpolation": interpolation}
        )
        made["channels"].append(
            {"sampler": len(made["samplers"]) - 1, "target": to}
        )

    def morph_targets(self, count: int) -> None:
        """Give the triangle that many morph targets."""
        (primitive,) = self.document["meshes"][0]["primitives"]
        primitive["targets"] = [{"POSITION": 0} for _ in range(count)]

    def glb(self) -> bytes:
        """The file."""
        self.document["buffers"] = [{"byteLength": len(self._binary)}]
        return glb(self.document, bytes(self._binary))
