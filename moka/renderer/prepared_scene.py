"""Everything about a scene that stays the same from frame to frame.

Made when models come or go or when the lighting changes the shaders; then a
frame is array operations over the rows that are made here.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.commands.command_buffer import CommandBuffer
from moka.commands.descriptors import (
    BindGroupDescriptor,
    BlendState,
    CompareFunction,
    CullMode,
    RasterState,
    TextureBinding,
    UniformBinding,
)
from moka.commands.handles import Handle
from moka.core.errors import DeviceError
from moka.graphics.device import GraphicsDevice
from moka.graphics.program_cache import ProgramCache
from moka.lighting.brdf_table import TABLE_SAMPLER
from moka.lighting.environment_maps import (
    CUBE_SAMPLER,
    MAP_SAMPLER,
    EnvironmentMaps,
)
from moka.material.description import (
    Feature,
    MaterialDescription,
)
from moka.material.material import Texture
from moka.model.mesh import Primitive
from moka.renderer.frame_order import LAYER_BLENDED, LAYER_MASK, LAYER_OPAQUE
from moka.renderer.geometry import GeometryPool, JoinedMeshes
from moka.renderer.material_table import MaterialTable
from moka.renderer.permutation import (
    LightingDescription,
    Permutation,
    visibility_program,
)
from moka.renderer.scene_materials import SceneMaterials
from moka.renderer.texture_request import TextureRequest
from moka.renderer.textures import TexturePool

if TYPE_CHECKING:
    from moka.renderer.visible_geometry import VisibleGeometry
    from moka.scene.live_materials import LiveMaterials

__all__ = [
    "PreparedScene",
    "SharedBindings",
    "VisibleSurface",
]

# One row per primitive: what its draws bind, whatever their transforms.
_ROW = np.dtype(
    [
        ("program", np.uint32),
        ("bind_group", np.uint32),
        ("mesh", np.uint32),
        ("state", np.uint32),
        ("material", np.uint32),
        ("layer", np.uint8),
        ("blended", np.bool_),
    ]
)


class SharedBindings(Struct, frozen=True):
    """What every surface's bind group holds besides its own."""

    frame: Handle
    lights: Handle | None
    maps: EnvironmentMaps
    table: Handle | None
    # Of meshes with skins or morph targets.
    poses: tuple[TextureBinding, ...] = ()


class VisibleSurface(Struct, frozen=True, eq=False):
    """What shades the pixels that a visibility buffer has of a scene.

    ``places`` (P, 2) are, of each primitive, what is added to its indices and
    where they begin; ``triangle_bits`` count the triangles of the largest.
    """

    program: Handle
    bindings: BindGroupDescriptor
    places: NDArray[np.uint32]
    triangle_bits: int


class PreparedScene:
    """Rows of what each primitive binds; owns bind groups and pages.

    The rows of primitives that the materials leave out stay empty. Where the
    lighting asks for a visibility buffer, rows only note what is seen, and
    ``visible_surface`` shades it; all materials are of one permutation then.
    """

    def __init__(
        self,
        device: GraphicsDevice,
        primitives: Sequence[Primitive],
        materials: SceneMaterials,
        lighting: LightingDescription,
        shared: SharedBindings,
        programs: ProgramCache,
        geometry: GeometryPool,
        textures: TexturePool,
    ) -> None:
        self._device = device
        permutations = [
            Permutation(description, lighting)
            for description in materials.descriptions
        ]
        # Programs first: they compile while images decode, beside those that
        # integrate the light.
        surfaces = [
            programs.get(permutation, permutation.program)
            for permutation in permutations
        ]
        drawn = surfaces
        if lighting.visibility:
            seen = programs.get(visibility_program, visibility_program)
            drawn = [seen] * len(surfaces)
        shared.maps.fill()
        wanted = [
            (primitives[position], description.attributes)
            for position, description in zip(
                materials.drawn, materials.descriptions, strict=True
            )
        ]
        meshes = geometry.meshes(wanted)
        self._table = MaterialTable(
            device,
            [
                (material, permutation.row_parts)
                for material, permutation in zip(
                    materials.materials, permutations, strict=True
                )
            ],
        )
        self._groups: dict[BindGroupDescriptor, Handle] = {}
        self.states: list[RasterState] = []
        visible: list[BindGroupDescriptor] = []
        self.rows = np.zeros(len(primitives), _ROW)
        is_reversed = device.info.clip_control
        for index, permutation in enumerate(permutations):
            material = materials.materials[index]
            place = self._table.place(material, permutation.row_parts)
            bindings = self._bindings(
                permutation,
                materials.requests[index],
                materials.textures[index],
                place.page,
                shared,
                textures,
            )
            if lighting.visibility:
                visible.append(bindings)
                bindings = BindGroupDescriptor(
                    uniforms=(UniformBinding("Frame", shared.frame),)
                )
            group = self._group(bindings)
            description = permutation.material
            self.rows[materials.drawn[index]] = (
                drawn[index].index,
                group.index,
                meshes[index].index,
                self._state(description, is_reversed=is_reversed),
                place.row,
                _layer(description),
                description.is_blended,
            )
        self.visible_surface: VisibleSurface | None = None
        self._visible_geometry: VisibleGeometry | None = None
        if visible:
            self._see(
                visible, surfaces[0], materials.drawn, geometry.joined(wanted)
            )
        self.handles = frozenset(
            (*surfaces, *drawn, *meshes, *self._groups.values())
        )
        self.program_count = len(set(surfaces))
        self.permutation_count = len(set(permutations))
        self.is_lit = materials.has_lit
        self._live_version = 0

    def update_materials(
        self, live: "LiveMaterials", commands: CommandBuffer
    ) -> None:
        """Write the materials that animations changed since the last call."""
        if live.version == self._live_version:
            return
        changes = live.changed_since(self._live_version)
        self._live_version = live.version
        for page, rows, offset in self._table.update(changes):
            commands.fill_buffer(page, rows, offset)

    def destroy(self) -> None:
        """Destroy what it owns; meshes and textures belong to pools."""
        self._device.destroy(*self._groups.values())
        self._groups.clear()
        self._table.destroy()
        if self._visible_geometry is not None:
            self._visible_geometry.destroy()

    def _see(
        self,
        bindings: Sequence[BindGroupDescriptor],
        program: Handle,
        drawn: Sequence[int],
        meshes: JoinedMeshes,
    ) -> None:
        """Have what shades a visibility buffer."""
        from moka.renderer.visible_geometry import VisibleGeometry

        if any(each != bindings[0] for each in bindings):
            raise DeviceError(
                "visibility buffer: surfaces bind different things"
            )
        geometry = VisibleGeometry(self._device, meshes)
        self._visible_geometry = geometry
        places = np.zeros((len(self.rows), 2), np.uint32)
        places[list(drawn), 0] = geometry.base_vertex
        places[list(drawn), 1] = geometry.first
        self.visible_surface = VisibleSurface(
            program,
            BindGroupDescriptor(
                (*bindings[0].textures, *geometry.bindings),
                bindings[0].uniforms,
            ),
            places,
            geometry.triangle_bits,
        )

    def _bindings(
        self,
        permutation: Permutation,
        requests: dict[str, TextureRequest],
        sampled: dict[str, Texture],
        page: Handle,
        shared: SharedBindings,
        textures: TexturePool,
    ) -> BindGroupDescriptor:
        bound = [
            TextureBinding(
                f"{slot}_texture",
                textures.handle(request),
                sampled[slot].sampler,
            )
            for slot, request in requests.items()
        ]
        uniforms = [
            UniformBinding("Frame", shared.frame),
            UniformBinding("Materials", page),
        ]
        if Feature.UNLIT not in permutation.material.features:
            maps = shared.maps
            sampled_map = maps.map if maps.importance is not None else None
            bound += [
                TextureBinding(name, handle, sampler)
                for name, handle, sampler in (
                    ("specular_cube", shared.maps.specular, CUBE_SAMPLER),
                    ("irradiance_cube", shared.maps.irradiance, CUBE_SAMPLER),
                    ("radiance_cube", shared.maps.radiance, CUBE_SAMPLER),
                    ("importance_table", shared.maps.importance, MAP_SAMPLER),
                    ("environment_map", sampled_map, MAP_SAMPLER),
                    ("brdf_table", shared.table, TABLE_SAMPLER),
                )
                if handle is not None
            ]
            if shared.lights is not None:
                uniforms.append(UniformBinding("Lights", shared.lights))
        if permutation.material.deforms:
            bound += shared.poses
        return BindGroupDescriptor(tuple(bound), tuple(uniforms))

    def _group(self, descriptor: BindGroupDescriptor) -> Handle:
        if descriptor not in self._groups:
            group = self._device.create_bind_group(descriptor)
            self._groups[descriptor] = group
        return self._groups[descriptor]

    def _state(
        self, description: MaterialDescription, *, is_reversed: bool
    ) -> int:
        """The number of a state; the next one is its mirrored twin."""
        # A line has no back, and its quads face the camera.
        is_line = Feature.LINES in description.features
        double_sided = is_line or Feature.DOUBLE_SIDED in description.features
        blended = description.is_blended
        cull = CullMode.NONE if double_sided else CullMode.BACK
        nearer = (
            CompareFunction.GREATER_EQUAL
            if is_reversed
            else CompareFunction.LESS_EQUAL
        )
        blend = BlendState.PREMULTIPLIED if blended else None
        pair = [
            RasterState(
                cull, clockwise, nearer, depth_write=not blended, blend=blend
            )
            for clockwise in (False, not is_line)
        ]
        for number in range(0, len(self.states), 2):
            if self.states[number : number + 2] == pair:
                return number
        self.states += pair
        return len(self.states) - 2


def _layer(description: MaterialDescription) -> int:
    if description.is_blended:
        return LAYER_BLENDED
    if Feature.ALPHA_MASK in description.features:
        return LAYER_MASK
    return LAYER_OPAQUE
