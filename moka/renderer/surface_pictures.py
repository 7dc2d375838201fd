"""Pictures of what surfaces are: their values, and views of one of these."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from moka.commands.command_list import CommandList
from moka.commands.handles import Handle
from moka.commands.sort_key import SortKey
from moka.graphics.device import GraphicsDevice
from moka.renderer.frame_block import frame_values
from moka.renderer.frame_order import PASS_DEBUG, PASS_VALUES
from moka.renderer.frame_scene import FrameScene
from moka.renderer.shared_pools import SharedPools
from moka.renderer.surface_values import (
    SurfaceValues,
    ValueTargets,
    groups_of,
)

if TYPE_CHECKING:
    from moka.renderer.debug_view import DebugPass

__all__ = ["SurfacePictures"]


class SurfacePictures:
    """Records them for one renderer, with ``pools`` that it shares.

    ``frame`` is the uniform buffer of the block ``Frame``.
    """

    def __init__(
        self, device: GraphicsDevice, frame: Handle, pools: SharedPools
    ) -> None:
        self._device = device
        self._frame = frame
        self._pools = pools
        self._values = SurfaceValues(
            device,
            frame,
            pools.programs,
            pools.geometry,
            pools.materials.textures,
        )
        self._debug: DebugPass | None = None

    def forget(self) -> None:
        """Prepare anew what is drawn next; programs may be others."""
        self._values.forget()

    def draw_values(
        self,
        seen: FrameScene,
        names: Iterable[str],
        size: tuple[int, int],
        commands: CommandList,
    ) -> ValueTargets:
        """See :meth:`moka.Renderer.draw_values`."""
        commands.fill_buffer(
            self._frame,
            frame_values(seen.scene, seen.view, size),
            key=SortKey(PASS_VALUES),
        )
        return self._values.draw(
            seen, groups_of(names), size, commands, PASS_VALUES
        )

    def draw_view(
        self,
        seen: FrameScene,
        name: str,
        size: tuple[int, int],
        commands: CommandList,
        target: Handle | None,
    ) -> None:
        """See :meth:`moka.Renderer.draw_debug_view`.

        ``target`` is the framebuffer that shows it, None the window's.
        """
        from moka.renderer.debug_view import DEBUG_VIEWS, DebugPass

        view = DEBUG_VIEWS[name]
        values = self.draw_values(seen, (view.value,), size, commands)
        if self._debug is None:
            self._debug = DebugPass(self._device, self._pools.passes)
        bounds = seen.scene.bounds()
        distance = 1.0
        if bounds is not None:
            away = seen.view.position - np.mean(bounds, axis=0)
            distance = float(np.linalg.norm(away)) or 1.0
        self._debug.draw(
            view,
            values,
            distance,
            commands,
            SortKey(PASS_DEBUG),
            target,
            size,
        )
