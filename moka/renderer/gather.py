"""Visible draws as rows with keys, and their instances: arrays only."""

import numpy as np
from numpy.typing import NDArray

from moka.commands.draws import DRAW, INSTANCE, Draws, Instances
from moka.commands.sort_key import (
    MATERIAL_BITS,
    MESH_BITS,
    PROGRAM_BITS,
    pack_blended_keys,
    pack_opaque_keys,
)
from moka.renderer.prepared_scene import PreparedScene
from moka.renderer.view import View
from moka.scene.culling import view_depths
from moka.scene.drawables import Drawables
from moka.scene.transforms import TransformTree

__all__ = ["gather_draws"]


def gather_draws(
    drawables: Drawables,
    transforms: TransformTree,
    prepared: PreparedScene,
    visible: NDArray[np.intp],
    view: View,
    states: NDArray[np.uint32],
    pass_: int,
) -> tuple[Draws, Instances]:
    """Rows of DRAW and INSTANCE for the draws ``visible`` (V,).

    ``states`` maps the prepared scene's state numbers to the command
    list's, ``pass_`` is the frame's pass that they belong to.
    """
    rows = prepared.rows[drawables.primitive[visible]]
    draws = np.empty(len(visible), DRAW)
    draws["program"] = rows["program"]
    draws["bind_group"] = rows["bind_group"]
    draws["mesh"] = rows["mesh"]
    draws["state"] = states[rows["state"] + drawables.mirrored[visible]]
    draws["first_instance"] = np.arange(len(visible))
    draws["instance_count"] = 1
    depth = view_depths(view.matrix, drawables.world_bounds[visible])
    draws["key"] = _keys(rows, depth, pass_)

    world = transforms.world[drawables.row[visible], :3]
    # In double precision, before anything is rounded.
    world[:, :, 3] -= view.position
    instances = np.zeros(len(visible), INSTANCE)
    instances["transform"] = world
    instances["material"] = rows["material"]
    instances["object"] = visible
    return draws, instances


def _keys(
    rows: NDArray[np.void], depth: NDArray[np.float64], pass_: int
) -> NDArray[np.uint64]:
    # Slots of handles can exceed a field, whose bits only group draws.
    program = rows["program"] & np.uint32((1 << PROGRAM_BITS) - 1)
    material = rows["bind_group"] & np.uint32((1 << MATERIAL_BITS) - 1)
    keys = pack_opaque_keys(
        pass_=pass_,
        layer=rows["layer"],
        program=program,
        material=material,
        mesh=rows["mesh"] & np.uint32((1 << MESH_BITS) - 1),
        depth=depth,
    )
    blended = rows["blended"]
    if blended.any():
        keys[blended] = pack_blended_keys(
            pass_=pass_,
            layer=rows["layer"][blended],
            program=program[blended],
            material=material[blended],
            depth=depth[blended],
        )
    return keys
