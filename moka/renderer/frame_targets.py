"""What the frames of one renderer are drawn into, as long as it serves."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

from moka.core.errors import DeviceError
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.renderer.settings import RenderSettings
from moka.renderer.targets import Targets

if TYPE_CHECKING:
    from moka.renderer.visibility_buffer import VisibilityBuffer

__all__ = ["FrameTargets"]


class _Reader(Protocol):
    def forget(self) -> None:
        """Destroy what refers to targets that are about to go."""


class FrameTargets:
    """The targets of the last frame, and its visibility buffer if it has one.

    ``readers`` hold what refers to them, and forget it before they go.
    """

    def __init__(
        self,
        device: GraphicsDevice,
        passes: FullscreenPasses,
        readers: Sequence[_Reader],
    ) -> None:
        self._device = device
        self._passes = passes
        self._readers = readers
        self._targets: Targets | None = None
        self._are_reused = False
        self.visibility: VisibilityBuffer | None = None

    @property
    def exist(self) -> bool:
        """Whether anything has been drawn into them."""
        return self._targets is not None

    @property
    def current(self) -> Targets:
        """Those of the last frame. Raises DeviceError before the first."""
        if self._targets is None:
            raise DeviceError("renderer: nothing has been drawn to read")
        return self._targets

    @property
    def marked_samples(self) -> int:
        """How many samples of a pixel the depth of the targets speaks of.

        It is there where any of them has something. 0 where it says nothing
        of the kind, and for the first frame: programs that make use of it
        cost more to compile than one picture gains.
        """
        if self.visibility is None or not self._are_reused:
            return 0
        return self.visibility.samples

    def update(
        self,
        size: tuple[int, int],
        settings: RenderSettings,
        visible_samples: int = 0,
        *,
        has_edges: bool = True,
    ) -> Targets:
        """Have those for pictures of ``size``, made if others are there.

        With ``visible_samples`` a visibility buffer has so many of a pixel.
        A sky alone has no edges that more than one would smooth.
        """
        samples = min(settings.samples, self._device.info.max_samples)
        if settings.accumulates:
            samples = 1  # Edges are smooth by another point in every frame.
        if visible_samples:
            samples = 1  # The visibility buffer has them.
        if not has_edges:
            samples = 1
        wanted = (size, samples, settings.has_float_target)
        self._are_reused = self._targets is not None
        if self._targets is None or self._targets.made_for != wanted:
            self.release()
            self._are_reused = False
            self._targets = Targets(
                self._device,
                size,
                samples,
                float_output=settings.has_float_target,
            )
        self._update_visibility(self._targets, visible_samples)
        return self._targets

    def release(self) -> None:
        """Destroy them, until the next :meth:`update`."""
        self._release_visibility()
        if self._targets is not None:
            for reader in self._readers:
                reader.forget()
            self._targets.destroy()
            self._targets = None

    def _update_visibility(self, targets: Targets, samples: int) -> None:
        if self.visibility is not None and self.visibility.made_for == (
            targets,
            samples,
        ):
            return
        self._release_visibility()
        if samples:
            from moka.renderer.visibility_buffer import VisibilityBuffer

            self.visibility = VisibilityBuffer(
                self._device, self._passes, targets, samples
            )

    def _release_visibility(self) -> None:
        if self.visibility is not None:
            self.visibility.destroy()
            self.visibility = None
