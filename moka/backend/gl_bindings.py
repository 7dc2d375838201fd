"""What a bind group binds for a program: textures and uniform blocks.

A program names them; bind groups answer by name. Each pair is matched once,
when it first meets.
"""

from collections.abc import Callable
from typing import Any

from msgspec import Struct

from moka.backend.gl_programs import GlProgram
from moka.backend.gl_textures import GlTexture, SamplerCache
from moka.commands.descriptors import BindGroupDescriptor
from moka.commands.handles import Handle
from moka.core.errors import DeviceError

__all__ = ["Bindings", "match_bindings"]


class Bindings(Struct, frozen=True):
    """What one bind group binds for one program.

    Arguments of :meth:`StateCache.texture` and ``uniform_block``.
    """

    textures: tuple[tuple[int, int, int, int, tuple[int, int]], ...]
    blocks: tuple[tuple[int, int, int, int], ...]


def match_bindings(
    program: GlProgram,
    group: BindGroupDescriptor,
    textures: Callable[[Handle], GlTexture],
    buffers: Callable[[Handle], Any],
    samplers: SamplerCache,
) -> Bindings:
    """Resolve ``group`` for ``program``; extra entries are left out.

    Raises DeviceError if the program reads something that the group lacks
    or a block is larger than its buffer range.
    """
    bound_textures = []
    by_name = {binding.name: binding for binding in group.textures}
    for name, unit in program.samplers.items():
        if name not in by_name:
            raise DeviceError(
                f"program {program.label}: reads texture {name!r}, which its "
                "bind group does not hold"
            )
        wanted = by_name[name]
        texture = textures(wanted.texture)
        last = texture.descriptor.level_count - 1
        levels = (0, last) if wanted.level is None else (wanted.level,) * 2
        sampler = samplers.name(wanted.sampler, levels[0] < levels[1])
        bound_textures.append(
            (unit, texture.target, texture.name, sampler, levels)
        )
    bound_blocks = []
    uniforms = {binding.name: binding for binding in group.uniforms}
    for name, (point, size) in program.blocks.items():
        if name not in uniforms:
            raise DeviceError(
                f"program {program.label}: reads block {name!r}, which its "
                "bind group does not hold"
            )
        binding = uniforms[name]
        buffer = buffers(binding.buffer)
        available = binding.size or buffer.size - binding.offset
        if available < size:
            raise DeviceError(
                f"program {program.label}: block {name!r} has {size} bytes, "
                f"its bind group gives {available}"
            )
        bound_blocks.append((point, buffer.glo, binding.offset, available))
    return Bindings(tuple(bound_textures), tuple(bound_blocks))
