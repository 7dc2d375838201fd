"""Animations: times, values, and what channels move.

Source: glTF 2.0 specification, section 3.11 (animations).
"""

from typing import Any

import numpy as np

from moka.model.validation.context import CheckedFile
from moka.model.validation.issues import Place

__all__ = ["check_animations"]

_FLOAT = 5126
_INTEGERS = (5120, 5121, 5122, 5123)
_SHARES = {(_FLOAT, False), *((each, True) for each in _INTEGERS)}
_OUTPUTS = {
    "translation": ("VEC3", {(_FLOAT, False)}),
    "rotation": ("VEC4", _SHARES),
    "scale": ("VEC3", {(_FLOAT, False)}),
    "weights": ("SCALAR", _SHARES),
}
_UNIT_ERROR = 0.00769


def check_animations(file: CheckedFile) -> None:
    """Check all animations."""
    for number, animation in file.all("animations"):
        place: Place = ("animations", number)
        samplers = animation.get("samplers")
        samplers = samplers if isinstance(samplers, list) else []
        for index, sampler in enumerate(samplers):
            if isinstance(sampler, dict):
                _check_sampler(file, sampler, (*place, "samplers", index))
        channels = animation.get("channels")
        if not isinstance(channels, list):
            continue
        targets: dict[tuple[Any, Any], int] = {}
        # The earlier of two channels with one target is the one at fault.
        for index in reversed(range(len(channels))):
            channel = channels[index]
            if isinstance(channel, dict):
                where = (*place, "channels", index)
                _check_channel(file, channel, samplers, where, targets, index)


def _check_sampler(
    file: CheckedFile, sampler: dict[str, Any], place: Place
) -> None:
    for name in ("input", "output"):
        if file.has_stride(sampler.get(name)):
            file.add(
                "ANIMATION_SAMPLER_ACCESSOR_WITH_BYTESTRIDE",
                (*place, name),
                "the buffer view of an animation must not have a stride",
            )
        index = sampler.get(name)
        accessor = file.get("accessors", index)
        if accessor is None:
            continue
        file.use(index, f"the {name} of animations", (*place, name))
        view = file.get("bufferViews", accessor.get("bufferView")) or {}
        if "target" in view:
            file.add(
                "BUFFER_VIEW_TARGET_OVERRIDE",
                (*place, name),
                f"the buffer view has the target {view['target']}",
            )
    index = sampler.get("input")
    accessor, layout = file.get("accessors", index), file.format_of(index)
    if accessor is None or layout is None:
        return
    where = (*place, "input")
    if not ("min" in accessor and "max" in accessor):
        file.add(
            "ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS",
            where,
            "the accessor of times needs min and max",
        )
    if layout != ("SCALAR", _FLOAT, False):
        file.add(
            "ANIMATION_SAMPLER_INPUT_ACCESSOR_INVALID_FORMAT",
            where,
            "times are scalar floats",
        )
        return
    array = file.array_of(index)
    if array is None or not np.isfinite(array).all():
        return
    times = array[:, 0]
    if (times < 0).any():
        first = int(np.flatnonzero(times < 0)[0])
        file.add(
            "ACCESSOR_ANIMATION_INPUT_NEGATIVE",
            where,
            f"time {first} is {times[first]:.6g}",
        )
    still = np.flatnonzero(times[1:] <= times[:-1])
    if len(still):
        file.add(
            "ACCESSOR_ANIMATION_INPUT_NON_INCREASING",
            where,
            f"time {still[0] + 1} does not exceed the one before",
        )


def _check_channel(
    file: CheckedFile,
    channel: dict[str, Any],
    samplers: list[Any],
    place: Place,
    targets: dict[tuple[Any, Any], int],
    index: int,
) -> None:
    number, target = channel.get("sampler"), channel.get("target")
    sampler = None
    if isinstance(number, int) and number >= 0:
        if number < len(samplers):
            sampler = samplers[number]
        else:
            file.add(
                "UNRESOLVED_REFERENCE",
                (*place, "sampler"),
                f"there is no samplers[{number}], the animation has "
                f"{len(samplers)}",
            )
    if not isinstance(target, dict):
        return
    path = target.get("path")
    if not isinstance(path, str):
        return
    node = file.get("nodes", target.get("node"))
    mesh = file.get("meshes", node.get("mesh")) if node else None
    where = (*place, "target")
    if node is not None:
        key = target["node"], path
        if key in targets:
            file.add(
                "ANIMATION_DUPLICATE_TARGETS",
                where,
                f"channels[{targets[key]}] has the same target",
            )
        targets[key] = index
        if path in ("translation", "rotation", "scale") and "matrix" in node:
            file.add(
                "ANIMATION_CHANNEL_TARGET_NODE_MATRIX",
                where,
                f"nodes[{target['node']}] has a matrix",
            )
        if path == "weights" and not _morph_count(mesh):
            file.add(
                "ANIMATION_CHANNEL_TARGET_NODE_WEIGHTS_NO_MORPHS",
                where,
                f"the mesh of nodes[{target['node']}] has no morph targets",
            )
    if isinstance(sampler, dict) and path in _OUTPUTS:
        _check_output(file, sampler, path, mesh, (*place, "sampler"))


def _check_output(
    file: CheckedFile,
    sampler: dict[str, Any],
    path: str,
    mesh: dict[str, Any] | None,
    place: Place,
) -> None:
    index = sampler.get("output")
    layout = file.format_of(index)
    if layout is None:
        return
    kind, components = _OUTPUTS[path]
    is_cubic = sampler.get("interpolation") == "CUBICSPLINE"
    fits = layout[0] == kind and layout[1:] in components
    if not fits:
        file.add(
            "ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_FORMAT",
            place,
            f"accessors[{index}] is {layout[0]} of component type "
            f"{layout[1]}, which {path} is not",
        )
    each = (_morph_count(mesh) or 0) if path == "weights" else 1
    times, count = file.count_of(sampler.get("input")), file.count_of(index)
    if times and count and each:
        expected = times * each * (3 if is_cubic else 1)
        if count != expected:
            file.add(
                "ANIMATION_SAMPLER_OUTPUT_ACCESSOR_INVALID_COUNT",
                place,
                f"accessors[{index}] has {count} elements, not {expected}",
            )
    array = file.array_of(index)
    if path != "rotation" or not fits or array is None:
        return
    if layout[1] != _FLOAT or not np.isfinite(array).all():
        return
    turns = array[1::3] if is_cubic else array
    length = np.linalg.norm(turns.astype(np.float64), axis=1)
    wrong = np.flatnonzero(np.abs(length - 1) > _UNIT_ERROR)
    if len(wrong):
        file.add(
            "ACCESSOR_ANIMATION_SAMPLER_OUTPUT_NON_NORMALIZED_QUATERNION",
            place,
            f"rotation {wrong[0]} has the length {length[wrong[0]]:.6g}",
        )


def _morph_count(mesh: dict[str, Any] | None) -> int:
    primitives = mesh.get("primitives") if mesh else None
    if not isinstance(primitives, list) or not primitives:
        return 0
    targets = (
        primitives[0].get("targets")
        if isinstance(primitives[0], dict)
        else None
    )
    return len(targets) if isinstance(targets, list) else 0
