"""What animations change about materials, as moka's materials have it."""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace

from moka.material.material import Material
from moka.model.animation import Animation, AnimationChannel
from moka.model.read_materials import emission_of
from moka.model.source import GltfSource

__all__ = ["marked_materials", "with_whole_emission"]

_FACTOR, _STRENGTH = "emissive_factor", "emissive_strength"


def marked_materials(
    materials: Sequence[Material], animations: Sequence[Animation]
) -> list[Material]:
    """The materials, those that animations change marked with what changes.

    Their programs are then made for all values, not only for those of now.
    """
    moving: dict[int, set[str]] = defaultdict(set)
    for animation in animations:
        for channel in animation.channels:
            if channel.target.kind == "material":
                moving[channel.target.index].add(channel.target.property)
    marked = {
        material: replace(material, animated=frozenset(moving[index]))
        if index in moving
        else material
        for index, material in enumerate(materials)
    }
    # Levels of detail are the marked ones too.
    return [
        replace(
            material,
            coarser=tuple(marked.get(each, each) for each in material.coarser),
        )
        if material.coarser
        else material
        for material in marked.values()
    ]


def with_whole_emission(
    source: GltfSource, channels: Sequence[AnimationChannel]
) -> list[AnimationChannel]:
    """Channels of the emissive factor that hold the emissive strength too.

    As :class:`moka.Material` has it. Where only one of the two moves, its
    keyframes are multiplied by the other; where both do, the strength stays
    a channel of its own.
    """
    moving: dict[int, set[str]] = defaultdict(set)
    for channel in channels:
        if channel.target.kind == "material":
            moving[channel.target.index].add(channel.target.property)
    result = []
    for channel in channels:
        target = channel.target
        name = target.property
        partner = _STRENGTH if name == _FACTOR else _FACTOR
        if (
            target.kind == "material"
            and name in (_FACTOR, _STRENGTH)
            and partner not in moving[target.index]
        ):
            factor, strength = emission_of(source, target.index)
            other = (strength,) if name == _FACTOR else factor
            channel = replace(
                channel,
                target=replace(target, property=_FACTOR),
                values=channel.values * np.array(other, np.float32),
            )
        result.append(channel)
    return result
