"""The GL state that draws depend on, set only where it differs.

Every packet says all that it needs; this cache is what makes that cheap. It
counts what it changed and what it could skip.
"""

from moka.backend import gl_constants as c
from moka.backend.gl_functions import Functions
from moka.backend.protocol import FrameCounters
from moka.commands.descriptors import (
    BlendState,
    CompareFunction,
    CullMode,
    RasterState,
)

__all__ = ["StateCache"]

_UNKNOWN = object()


class StateCache:
    """Mirrors GL state; :meth:`forget` whatever was changed behind it."""

    def __init__(self, gl: Functions) -> None:
        self._gl = gl
        self._values: dict[object, object] = {}
        self._raster: RasterState | None = None
        self.counters = FrameCounters()

    def forget(self, *keys: object) -> None:
        """No longer trust these values; without keys, none at all."""
        if keys:
            for key in keys:
                self._values.pop(key, None)
        else:
            self._values.clear()
            self._raster = None

    def program(self, name: int) -> None:
        """glUseProgram."""
        if self._differs("program", name):
            self._gl.UseProgram(name)

    def vertex_array(self, name: int) -> None:
        """glBindVertexArray."""
        if self._differs("vertex_array", name):
            self._gl.BindVertexArray(name)

    def texture(
        self,
        unit: int,
        target: int,
        name: int,
        sampler: int,
        levels: tuple[int, int],
    ) -> None:
        """Bind a texture and its sampler to a unit; first and last level."""
        if self._differs(("texture", unit, target), name):
            self._gl.ActiveTexture(c.TEXTURE0 + unit)
            self._gl.BindTexture(target, name)
        if levels != (0, 0) and self._differs(("levels", name), levels):
            self._gl.ActiveTexture(c.TEXTURE0 + unit)
            self._gl.TexParameteri(target, c.TEXTURE_BASE_LEVEL, levels[0])
            self._gl.TexParameteri(target, c.TEXTURE_MAX_LEVEL, levels[1])
        if self._differs(("sampler", unit), sampler):
            self._gl.BindSampler(unit, sampler)

    def uniform_block(
        self, binding: int, name: int, offset: int, size: int
    ) -> None:
        """glBindBufferRange of a uniform buffer."""
        if self._differs(("uniform", binding), (name, offset, size)):
            self._gl.BindBufferRange(
                c.UNIFORM_BUFFER, binding, name, offset, size
            )

    def framebuffer(self, name: int) -> None:
        """Bind the framebuffer that draws go to."""
        if self._differs("framebuffer", name):
            self._gl.BindFramebuffer(c.DRAW_FRAMEBUFFER, name)

    def viewport(self, rectangle: tuple[int, int, int, int]) -> None:
        """glViewport."""
        if self._differs("viewport", rectangle):
            self._gl.Viewport(*rectangle)

    def scissor(self, rectangle: tuple[int, int, int, int] | None) -> None:
        """Clip to a rectangle, or not."""
        self._enable(c.SCISSOR_TEST, rectangle is not None)
        if rectangle is not None and self._differs("scissor", rectangle):
            self._gl.Scissor(*rectangle)

    def write_masks(self, *, colour: bool, depth: bool) -> None:
        """What draws and clears may write."""
        self._raster = None
        if self._differs("colour_mask", colour):
            self._gl.ColorMask(*[colour] * 4)
        if self._differs("depth_mask", depth):
            self._gl.DepthMask(depth)

    def raster(self, state: RasterState) -> None:
        """Everything that a RasterState describes."""
        if state == self._raster:
            self.counters.state_changes_skipped += 1
            return
        self._cull(state)
        self._depth(state)
        self._blend(state.blend)
        self.write_masks(colour=state.colour_write, depth=state.depth_write)
        self._enable(c.SAMPLE_ALPHA_TO_COVERAGE, state.alpha_to_coverage)
        if self._differs("wireframe", state.wireframe):
            self._gl.PolygonMode(
                c.FRONT_AND_BACK, c.LINE if state.wireframe else c.FILL
            )
        self._raster = state

    def _cull(self, state: RasterState) -> None:
        culls = state.cull is not CullMode.NONE
        self._enable(c.CULL_FACE, culls)
        if culls and self._differs("cull", state.cull):
            self._gl.CullFace(c.CULL[state.cull])
        if self._differs("front", state.front_clockwise):
            self._gl.FrontFace(c.CW if state.front_clockwise else c.CCW)

    def _depth(self, state: RasterState) -> None:
        # GL writes no depth while the test is off.
        tests = state.depth_test is not None or state.depth_write
        self._enable(c.DEPTH_TEST, tests)
        function = c.COMPARE[state.depth_test or CompareFunction.ALWAYS]
        if tests and self._differs("depth_function", function):
            self._gl.DepthFunc(function)

    def _blend(self, blend: BlendState | None) -> None:
        self._enable(c.BLEND, blend is not None)
        if blend is not None and self._differs("blend", blend):
            self._gl.BlendEquation(c.FUNC_ADD)
            self._gl.BlendFuncSeparate(*c.BLEND_FACTORS[blend])

    def _enable(self, capability: int, enabled: bool) -> None:
        if self._differs(("enable", capability), enabled):
            (self._gl.Enable if enabled else self._gl.Disable)(capability)

    def _differs(self, key: object, value: object) -> bool:
        if self._values.get(key, _UNKNOWN) == value:
            self.counters.state_changes_skipped += 1
            return False
        self._values[key] = value
        self.counters.state_changes += 1
        return True
