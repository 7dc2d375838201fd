"""Pure data: handles, descriptors, sort keys and the command list; no GL."""

from moka.commands.command_list import CommandBuffer, CommandList
from moka.commands.descriptors import RasterState
from moka.commands.draws import DRAW, INSTANCE
from moka.commands.handles import Handle
from moka.commands.sort_key import (
    SortKey,
    Stage,
    pack_blended_keys,
    pack_opaque_keys,
    unpack_key,
)

__all__ = [
    "DRAW",
    "INSTANCE",
    "CommandBuffer",
    "CommandList",
    "Handle",
    "RasterState",
    "SortKey",
    "Stage",
    "pack_blended_keys",
    "pack_opaque_keys",
    "unpack_key",
]
