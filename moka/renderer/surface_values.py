"""What surfaces are instead of how they look: the values behind AOVs.

Surfaces are drawn once more, without light and without multisampling, into
one target for each four values; what nobody asks for has no target and is
not compiled.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from moka.commands.command_list import CommandList
from moka.commands.commands import Readback
from moka.commands.descriptors import (
    Attachment,
    BlendState,
    FramebufferDescriptor,
    PixelFormat,
    TextureDescriptor,
)
from moka.commands.handles import Handle
from moka.commands.sort_key import SortKey
from moka.core.aov import AOVS
from moka.graphics.device import GraphicsDevice
from moka.graphics.program_cache import ProgramCache
from moka.lighting.environment_maps import EnvironmentMaps
from moka.renderer.frame_scene import FrameScene
from moka.renderer.gather import DrawGatherer
from moka.renderer.geometry import GeometryPool
from moka.renderer.permutation import LightingDescription
from moka.renderer.prepared_scene import PreparedScene, SharedBindings
from moka.renderer.textures import TexturePool

__all__ = [
    "GROUPS",
    "OBJECTS",
    "SurfaceValues",
    "ValueTargets",
    "group_of",
    "groups_of",
    "unpack_values",
]

#: The values of each target and the channels where they lie.
GROUPS: Mapping[str, Mapping[str, slice]] = {
    "normal_depth": {"normal": slice(0, 3), "depth": slice(3, 4)},
    "albedo_roughness": {"albedo": slice(0, 3), "roughness": slice(3, 4)},
    "emission_metalness": {"emission": slice(0, 3), "metallic": slice(3, 4)},
    "uv_occlusion_object": {
        "uv": slice(0, 2),
        "occlusion": slice(2, 3),
        "object-id": slice(3, 4),
    },
    "fresnel": {"fresnel": slice(0, 3)},
    # How many surfaces forward shading shades for a pixel: no value of one of
    # them, and so not to be asked for together with others.
    "overdraw": {"overdraw": slice(0, 1)},
    "tangent_level": {"tangent": slice(0, 3), "mip-level": slice(3, 4)},
}

#: The target whose last value is the object's number, 0 where nothing is.
OBJECTS = "uv_occlusion_object"


def group_of(name: str) -> str:
    """The target that holds a value."""
    return next(group for group, held in GROUPS.items() if name in held)


def groups_of(names: Iterable[str]) -> tuple[str, ...]:
    """The targets that hold ``names``, keys of :data:`moka.core.aov.AOVS`.

    The object's number is always among them: it tells where nothing is.
    """
    wanted = {*names, "object-id"}
    return tuple(
        group for group, values in GROUPS.items() if wanted & values.keys()
    )


class ValueTargets:
    """Framebuffer of the targets ``groups`` for pictures of ``size``."""

    def __init__(
        self,
        device: GraphicsDevice,
        size: tuple[int, int],
        groups: Sequence[str],
    ) -> None:
        self.made_for = size, tuple(groups)
        self._device = device
        self._groups = groups
        # Float32 holds every whole number of an object up to 2^24.
        textures = [
            device.create_texture(
                TextureDescriptor(PixelFormat.RGBA32F, *size, label=group)
            )
            for group in groups
        ]
        depth = device.create_texture(
            TextureDescriptor(PixelFormat.DEPTH32F, *size, label="depth")
        )
        self.framebuffer = device.create_framebuffer(
            FramebufferDescriptor(
                tuple(map(Attachment, textures)), Attachment(depth)
            )
        )
        self.textures = dict(zip(groups, textures, strict=True))
        self._resources: tuple[Handle, ...] = (
            self.framebuffer,
            depth,
            *textures,
        )

    def read(
        self,
        commands: CommandList,
        key: SortKey,
        rectangle: tuple[int, int, int, int] | None = None,
    ) -> dict[str, Readback]:
        """Record a readback for each target, by group.

        ``rectangle`` is x, y, width and height from the lower left corner;
        by default everything is read.
        """
        area = rectangle or (0, 0, *self.made_for[0])
        return {
            group: commands.read_pixels(
                self.framebuffer, area, attachment=number, key=key
            )
            for number, group in enumerate(self._groups)
        }

    def destroy(self) -> None:
        """Destroy the framebuffer and its textures."""
        self._device.destroy(*self._resources)


class SurfaceValues:
    """Draws the values of a scene's surfaces, with a renderer's pools.

    ``frame`` is the uniform buffer of the block ``Frame``, which whoever
    calls :meth:`draw` fills.
    """

    def __init__(
        self,
        device: GraphicsDevice,
        frame: Handle,
        programs: ProgramCache,
        geometry: GeometryPool,
        textures: TexturePool,
    ) -> None:
        self._device = device
        self._frame = frame
        self._pools = programs, geometry, textures
        self._prepared: PreparedScene | None = None
        self._prepared_key: object = None
        self._gatherer: DrawGatherer
        self._targets: ValueTargets | None = None

    def draw(
        self,
        seen: FrameScene,
        groups: tuple[str, ...],
        size: tuple[int, int],
        commands: CommandList,
        pass_: int,
    ) -> ValueTargets:
        """Record the draws of what is ``seen`` as pass ``pass_``.

        Returns the targets, cleared to 0 where nothing is; they are valid
        until the next call.
        """
        scene, visible = seen.scene, seen.visible
        prepared = self._prepare(seen, groups, pass_)
        if seen.poses is not None:
            seen.poses.update(visible, self._pools[1], commands)
        targets = self._update_targets(size, groups)
        is_reversed = self._device.info.clip_control
        buffer = commands.command_buffer(SortKey(pass_))
        if scene.live_materials is not None:
            prepared.update_materials(scene.live_materials, buffer)
        buffer.bind_framebuffer(targets.framebuffer)
        buffer.clear((0, 0, 0, 0), 0.0 if is_reversed else 1.0)
        drawn = prepared.states
        if "overdraw" in groups:
            drawn = [replace(each, blend=BlendState.ADDITIVE) for each in drawn]
        states = [commands.state_index(state) for state in drawn]
        commands.use(prepared.handles)
        commands.draws(
            *self._gatherer.gather(
                scene.transforms,
                visible,
                seen.view,
                np.array(states, np.uint32),
            ),
            in_order=True,
        )
        return targets

    def forget(self) -> None:
        """Prepare anew what is drawn next; programs may be others."""
        self._prepared_key = None

    def _prepare(
        self, seen: FrameScene, groups: tuple[str, ...], pass_: int
    ) -> PreparedScene:
        lighting = LightingDescription(
            environment=False,
            light_capacity=0,
            brdf="",
            diffuse="",
            multiscatter=False,
            float_target=True,
            logarithmic_depth=seen.view.depth_range is not None,
            values=groups,
        )
        poses = seen.poses
        key = (seen.materials, lighting)
        if self._prepared is not None and self._prepared_key == key:
            return self._prepared
        if self._prepared is not None:
            self._prepared.destroy()
        self._prepared = PreparedScene(
            self._device,
            seen.scene.drawables.primitives,
            seen.materials.without_blending(),
            lighting,
            SharedBindings(
                self._frame,
                None,
                EnvironmentMaps(),
                None,
                () if poses is None else poses.bindings,
            ),
            *self._pools,
        )
        self._prepared_key = key
        self._gatherer = DrawGatherer(
            seen.scene.drawables,
            self._prepared,
            pass_,
            None if poses is None else poses.places,
        )
        return self._prepared

    def _update_targets(
        self, size: tuple[int, int], groups: tuple[str, ...]
    ) -> ValueTargets:
        if self._targets is None or self._targets.made_for != (size, groups):
            if self._targets is not None:
                self._targets.destroy()
            self._targets = ValueTargets(self._device, size, groups)
        return self._targets


def unpack_values(
    names: Iterable[str], read: Mapping[str, Readback]
) -> dict[str, NDArray[Any]]:
    """The values ``names`` from what :meth:`ValueTargets.read` has read.

    Arrays (H, W) or (H, W, C) of the types that :data:`moka.core.aov.AOVS`
    states, top row first.
    """
    objects = _channels(read, OBJECTS)[:, :, 3]
    values: dict[str, NDArray[Any]] = {}
    for name in names:
        aov = AOVS[name]
        group = group_of(name)
        value = _channels(read, group)[:, :, GROUPS[group][name]]
        value = np.ascontiguousarray(value.astype(aov.dtype, copy=False))
        if aov.nothing:
            value[objects == 0] = aov.nothing
        values[name] = value if aov.letters else value[:, :, 0]
    return values


def _channels(read: Mapping[str, Readback], group: str) -> NDArray[np.float32]:
    data = read[group].data
    assert data is not None
    return data[::-1]
