"""A run of commands that stay together, and commands that stand alone."""

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from moka.commands.commands import (
    BindFramebuffer,
    Clear,
    Command,
    FillBuffer,
    FillTexture,
    GenerateMipmaps,
    Readback,
    ReadPixels,
    ResolveFramebuffer,
    SetScissor,
    SetViewport,
    Timestamp,
    Timestamps,
)
from moka.commands.descriptors import RasterState
from moka.commands.draws import DRAW, Instances, identity_instance
from moka.commands.handles import Handle, ResourceKind
from moka.commands.recording import DrawSpan
from moka.commands.sort_key import SortKey
from moka.core.errors import CommandError

if TYPE_CHECKING:
    from moka.commands.command_list import CommandList

__all__ = ["CommandBuffer", "SingleCommands"]


class CommandBuffer:
    """Commands that stay together, in the order they are recorded."""

    def __init__(self, owner: "CommandList") -> None:
        self._owner = owner
        self._entries: list[Command | DrawSpan] = []

    def bind_framebuffer(self, framebuffer: Handle | None) -> None:
        """Draw into ``framebuffer`` from here on; None is the window."""
        self._use(framebuffer)
        self._entries.append(BindFramebuffer(framebuffer))

    def clear(
        self,
        colour: tuple[float, float, float, float] | None = None,
        depth: float | None = None,
    ) -> None:
        """Clear to a linear RGBA colour, to a depth, or both."""
        self._entries.append(Clear(colour, depth))

    def viewport(self, x: int, y: int, width: int, height: int) -> None:
        """Map clip space to this rectangle, from the lower left."""
        self._entries.append(SetViewport((x, y, width, height)))

    def scissor(
        self, rectangle: tuple[int, int, int, int] | None = None
    ) -> None:
        """Draw and clear only inside ``rectangle``; None is everywhere."""
        self._entries.append(SetScissor(rectangle))

    def fill_buffer(
        self, buffer: Handle, data: bytes | NDArray[Any], offset: int = 0
    ) -> None:
        """Write ``data``, copied now, into ``buffer`` at byte ``offset``."""
        self._use(buffer, ResourceKind.BUFFER)
        content = data.tobytes() if isinstance(data, np.ndarray) else data
        self._entries.append(FillBuffer(buffer, bytes(content), offset))

    def fill_texture(
        self, texture: Handle, texels: NDArray[Any], first: int = 0
    ) -> None:
        """Write ``texels`` (N, channels), copied now, from ``first`` on.

        Into a texture of the kind BUFFER, in its own format.
        """
        self._use(texture, ResourceKind.TEXTURE)
        self._entries.append(FillTexture(texture, texels.tobytes(), first))

    def generate_mipmaps(self, texture: Handle) -> None:
        """Make the lower mip levels of ``texture`` from level 0."""
        self._use(texture, ResourceKind.TEXTURE)
        self._entries.append(GenerateMipmaps(texture))

    def resolve(self, source: Handle, target: Handle) -> None:
        """Average the samples of framebuffer ``source`` into ``target``."""
        self._use(source, ResourceKind.FRAMEBUFFER)
        self._use(target, ResourceKind.FRAMEBUFFER)
        self._entries.append(ResolveFramebuffer(source, target))

    def read_pixels(
        self,
        framebuffer: Handle | None,
        rectangle: tuple[int, int, int, int],
        *,
        attachment: int = 0,
        channels: int = 4,
        dtype: str = "f4",
    ) -> Readback:
        """Read a colour attachment; see :class:`ReadPixels`."""
        self._use(framebuffer)
        readback = Readback()
        self._entries.append(
            ReadPixels(
                framebuffer, rectangle, readback, attachment, channels, dtype
            )
        )
        return readback

    def timestamp(self, label: str, into: Timestamps) -> None:
        """Have the GPU's clock read here; see :class:`Timestamp`."""
        self._entries.append(Timestamp(label, into))

    def draw(
        self,
        program: Handle,
        mesh: Handle,
        bind_group: Handle,
        state: RasterState | None = None,
        instances: Instances | None = None,
    ) -> None:
        """Draw one mesh, once per row of ``instances`` (default: once)."""
        owner = self._owner
        if instances is None:
            instances = identity_instance()
        row = np.zeros(1, DRAW)
        row["program"] = self._use(program, ResourceKind.PROGRAM)
        row["mesh"] = self._use(mesh, ResourceKind.MESH)
        row["bind_group"] = self._use(bind_group, ResourceKind.BIND_GROUP)
        row["state"] = owner.state_index(state or RasterState())
        row["instance_count"] = len(instances)
        piece = row.copy(), instances
        row["first_instance"] = owner._add_instances(instances)
        self._entries.append(owner._add_draws(row, piece))

    def _use(
        self, handle: Handle | None, kind: ResourceKind | None = None
    ) -> int:
        if handle is None:
            return 0
        if kind is not None and handle.kind is not kind:
            raise CommandError(
                f"{handle}: expected a {kind.name.lower()} handle"
            )
        self._owner._handles.add(handle)
        return handle.index


class SingleCommands(ABC):
    """Every command of a :class:`CommandBuffer` as a buffer of its own.

    What a list has besides: shorthands for the one command that a caller
    wants at a place of the frame.
    """

    @abstractmethod
    def command_buffer(self, key: SortKey | int | None = None) -> CommandBuffer:
        """A buffer whose commands run together at ``key``'s place."""

    def bind_framebuffer(
        self, framebuffer: Handle | None, *, key: SortKey | int | None = None
    ) -> None:
        """:meth:`CommandBuffer.bind_framebuffer` in a buffer of its own."""
        self.command_buffer(key).bind_framebuffer(framebuffer)

    def clear(
        self,
        colour: tuple[float, float, float, float] | None = None,
        depth: float | None = None,
        *,
        key: SortKey | int | None = None,
    ) -> None:
        """:meth:`CommandBuffer.clear` in a buffer of its own."""
        self.command_buffer(key).clear(colour, depth)

    def viewport(
        self,
        x: int,
        y: int,
        width: int,
        height: int,
        *,
        key: SortKey | int | None = None,
    ) -> None:
        """:meth:`CommandBuffer.viewport` in a buffer of its own."""
        self.command_buffer(key).viewport(x, y, width, height)

    def scissor(
        self,
        rectangle: tuple[int, int, int, int] | None = None,
        *,
        key: SortKey | int | None = None,
    ) -> None:
        """:meth:`CommandBuffer.scissor` in a buffer of its own."""
        self.command_buffer(key).scissor(rectangle)

    def fill_buffer(
        self,
        buffer: Handle,
        data: bytes | NDArray[Any],
        offset: int = 0,
        *,
        key: SortKey | int | None = None,
    ) -> None:
        """:meth:`CommandBuffer.fill_buffer` in a buffer of its own."""
        self.command_buffer(key).fill_buffer(buffer, data, offset)

    def fill_texture(
        self,
        texture: Handle,
        texels: NDArray[Any],
        first: int = 0,
        *,
        key: SortKey | int | None = None,
    ) -> None:
        """:meth:`CommandBuffer.fill_texture` in a buffer of its own."""
        self.command_buffer(key).fill_texture(texture, texels, first)

    def generate_mipmaps(
        self, texture: Handle, *, key: SortKey | int | None = None
    ) -> None:
        """:meth:`CommandBuffer.generate_mipmaps` in its own buffer."""
        self.command_buffer(key).generate_mipmaps(texture)

    def resolve(
        self,
        source: Handle,
        target: Handle,
        *,
        key: SortKey | int | None = None,
    ) -> None:
        """:meth:`CommandBuffer.resolve` in a buffer of its own."""
        self.command_buffer(key).resolve(source, target)

    def read_pixels(
        self,
        framebuffer: Handle | None,
        rectangle: tuple[int, int, int, int],
        *,
        attachment: int = 0,
        channels: int = 4,
        dtype: str = "f4",
        key: SortKey | int | None = None,
    ) -> Readback:
        """:meth:`CommandBuffer.read_pixels` in a buffer of its own."""
        return self.command_buffer(key).read_pixels(
            framebuffer,
            rectangle,
            attachment=attachment,
            channels=channels,
            dtype=dtype,
        )

    def timestamp(
        self,
        label: str,
        into: Timestamps,
        *,
        key: SortKey | int | None = None,
    ) -> None:
        """:meth:`CommandBuffer.timestamp` in a buffer of its own."""
        self.command_buffer(key).timestamp(label, into)

    def draw(
        self,
        program: Handle,
        mesh: Handle,
        bind_group: Handle,
        state: RasterState | None = None,
        instances: Instances | None = None,
        *,
        key: SortKey | int | None = None,
    ) -> None:
        """:meth:`CommandBuffer.draw` in a buffer of its own."""
        self.command_buffer(key).draw(
            program, mesh, bind_group, state, instances
        )
