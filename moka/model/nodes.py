"""The node hierarchy as arrays, without recursion.

Walks up the tree are done for all nodes at once by pointer jumping: each
round joins every node's path with that of the node at its end, so that a
tree of depth d takes log2(d) rounds of whole-array operations, whatever its
shape (Hillis and Steele 1986, "Data Parallel Algorithms").
"""

from collections.abc import Iterable, Sequence
from itertools import chain
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct, field
from numpy.typing import NDArray

from moka.core.maths import Array, compose
from moka.model.lights import read_node_lights
from moka.model.schema import Node, read_extension
from moka.model.source import GltfSource

if TYPE_CHECKING:
    from moka.model.lods import NodeLevels

__all__ = ["NodeTree", "ancestors", "read_nodes"]

Indices = NDArray[np.int32]

INSTANCING, LEVELS = "EXT_mesh_gpu_instancing", "MSFT_lod"
_VISIBILITY = "KHR_node_visibility"


class _Visibility(Struct):
    visible: bool = True


# Beyond this a matrix does not survive the way to the GPU.
_LARGEST = float(np.finfo(np.float32).max)


class NodeTree(Struct, eq=False):
    """N nodes, ordered so that parents come before their children.

    ``parents`` is the row of the parent, -1 for roots; ``local`` float64
    (N, 4, 4) matrices from a node's space to its parent's, indexed [row,
    column]; ``mesh``, ``camera`` and ``light`` what a node places, -1 for
    nothing; ``source`` the node's index in the file, -1 for the instances of
    a node's mesh, which are rows without a name after all others. All but
    ``names`` and ``local`` are int32 (N,). ``hidden`` (H,) are rows that the
    file hides with all below them; ``levels`` which are levels of detail.
    For the rows that have them: ``weights`` of the morph targets of their
    mesh, ``skins`` that their mesh follows.
    """

    names: list[str]
    parents: Indices
    local: Array
    mesh: Indices
    camera: Indices
    light: Indices
    source: Indices
    weights: dict[int, list[float]] = {}
    skins: dict[int, int] = {}
    hidden: Indices = field(default_factory=lambda: np.empty(0, np.int32))
    levels: "NodeLevels | None" = None

    def __len__(self) -> int:
        return len(self.names)

    def world_matrices(self) -> Array:
        """Matrices (N, 4, 4) from each node's space to the model's."""
        world, jump = self.local.copy(), self.parents.copy()
        # What overflows here is infinite, and so never inside a frustum.
        with np.errstate(over="ignore", invalid="ignore"):
            while len(rows := np.flatnonzero(jump >= 0)):
                # The right side is gathered before anything is assigned, so
                # that each round sees the paths of the round before.
                world[rows] = world[jump[rows]] @ world[rows]
                jump[rows] = jump[jump[rows]]
        return world

    @property
    def numbers(self) -> Indices:
        """(N,) the index in the file, then those of further instances.

        An instance has none there; its row, which comes after all nodes of
        the file, is its number.
        """
        rows = np.arange(len(self), dtype=np.int32)
        return np.where(self.source >= 0, self.source, rows)

    def row_of_number(self, number: int) -> int:
        """The row of which :attr:`numbers` says ``number``."""
        return int(np.flatnonzero(self.numbers == number)[0])

    def rows_of_file(self) -> Indices:
        """The row of each node of the file, by its index there."""
        count = int(np.count_nonzero(self.source >= 0))
        rows = np.empty(count, np.int32)
        rows[self.source[:count]] = np.arange(count, dtype=np.int32)
        return rows

    def with_levels(self, roots: Indices) -> Indices:
        """``roots`` and the coarser levels of detail that they have."""
        if self.levels is None:
            return roots
        finest = self.levels.node[self.levels.level == 0][self.levels.group]
        coarser = self.levels.node[np.isin(finest, roots)]
        return np.union1d(roots, coarser[self.parents[coarser] < 0])

    def roots(self) -> Indices:
        """The root (N,) above each node, a root being its own."""
        return ancestors(self.parents)[0]


def ancestors(parents: Indices) -> tuple[Indices, Indices]:
    """The root above each node and its depth, for ``parents`` (-1 = none).

    Nodes on or below a cycle have no root: -1.
    """
    count = len(parents)
    depth = (parents >= 0).astype(np.int32)
    end = np.where(parents >= 0, parents, np.arange(count, dtype=np.int32))
    for _ in range(count.bit_length()):
        if (parents[end] < 0).all():
            return end, depth
        depth += depth[end]
        end = end[end]
    return np.where(parents[end] < 0, end, np.int32(-1)), depth


def read_nodes(source: GltfSource, light_count: int) -> NodeTree:
    """The nodes of a document, all scenes together.

    A level of detail without a parent of its own stands below that of the
    finest one. Raises ModelError for references to nothing, a node with two
    parents, a cycle, or matrices that float32 cannot hold.
    """
    document = source.document
    nodes = document.nodes
    extended = [
        (index, node)
        for index, node in enumerate(nodes)
        if node.extensions is not None
    ]
    used = {name for _, node in extended for name in node.extensions or ()}
    levels = None
    if LEVELS in used:
        # Few files have them: readers are imported for those.
        from moka.model.lods import read_node_levels

        levels = read_node_levels(source, extended)
    parents = _parents(source)
    if levels is not None:
        _adopt_levels(parents, levels)
    roots, depth = ancestors(parents)
    if (roots < 0).any():
        first = int(np.flatnonzero(roots < 0)[0])
        raise source.error(f"nodes[{first}]", "is on or below a cycle of nodes")
    order = np.argsort(depth, kind="stable").astype(np.int32)
    rows = np.empty(len(nodes) + 1, np.int32)
    rows[order] = np.arange(len(nodes), dtype=np.int32)
    rows[-1] = -1  # where a parent of -1 points
    tree = NodeTree(
        names=[nodes[index].name for index in order.tolist()],
        parents=rows[parents][order],
        local=_local_matrices(source)[order],
        mesh=_references(source, "mesh", "meshes", len(document.meshes))[order],
        camera=_references(source, "camera", "cameras", len(document.cameras))[
            order
        ],
        light=read_node_lights(source, extended, light_count)[order],
        source=order,
        weights=_weights(source, rows),
        skins=_skins(source, rows),
        hidden=rows[_hidden(source, extended)],
        levels=None if levels is None else levels.at(rows),
    )
    if INSTANCING in used:
        from moka.model.instances import read_instances

        instances = read_instances(source, extended)
        _append_instances(tree, rows[instances.node], instances.local)
    return tree


def _append_instances(tree: NodeTree, owners: Indices, local: Array) -> None:
    """Let new rows below ``owners`` (I,) show the meshes in their place.

    Skins do not move instances, which the extension leaves open.
    """
    nothing = np.full(len(owners), -1, np.int32)
    first = len(tree)
    tree.names += [""] * len(owners)
    tree.parents = np.concatenate([tree.parents, owners])
    tree.local = np.concatenate([tree.local, local])
    tree.mesh = np.concatenate([tree.mesh, tree.mesh[owners]])
    tree.mesh[owners] = -1
    tree.camera = np.concatenate([tree.camera, nothing])
    tree.light = np.concatenate([tree.light, nothing])
    tree.source = np.concatenate([tree.source, nothing])
    for owner in set(owners.tolist()):
        tree.skins.pop(owner, None)
    if tree.weights:
        tree.weights |= {
            row: tree.weights[owner]
            for row, owner in enumerate(owners.tolist(), first)
            if owner in tree.weights
        }


def _adopt_levels(parents: Indices, levels: "NodeLevels") -> None:
    """Put coarser levels that have no parent where the finest one is."""
    finest = levels.node[levels.level == 0][levels.group]
    above = parents[levels.node]
    parents[levels.node] = np.where(above < 0, parents[finest], above)


def _hidden(source: GltfSource, nodes: Sequence[tuple[int, Node]]) -> list[int]:
    """Which of these nodes are hidden; source: KHR_node_visibility."""
    return [
        index
        for index, node in nodes
        if (
            own := read_extension(
                node, _VISIBILITY, _Visibility, source.where, f"nodes[{index}]"
            )
        )
        is not None
        and not own.visible
    ]


def _parents(source: GltfSource) -> Indices:
    """The parent of each node of the file, -1 for roots."""
    nodes = source.document.nodes
    counts = np.array([len(node.children) for node in nodes], np.int64)
    children = np.array(
        list(chain.from_iterable(node.children for node in nodes)), np.int64
    )
    owners = np.repeat(np.arange(len(nodes), dtype=np.int32), counts)
    wrong = np.flatnonzero(children >= len(nodes))
    if len(wrong):
        owner = owners[wrong[0]]
        source.check_index(
            f"nodes[{owner}].children",
            int(children[wrong[0]]),
            "nodes",
            len(nodes),
        )
    twice = np.flatnonzero(np.bincount(children, minlength=1) > 1)
    if len(twice):
        first, second = owners[np.flatnonzero(children == twice[0])[:2]]
        raise source.error(
            f"nodes[{twice[0]}]",
            f"has two parents, nodes[{first}] and nodes[{second}]",
        )
    parents = np.full(len(nodes), -1, np.int32)
    parents[children] = owners
    return parents


def _references(
    source: GltfSource, name: str, kind: str, count: int
) -> Indices:
    """What each node of the file places, -1 for nothing."""
    values = map(attrgetter(name), source.document.nodes)
    indices = np.fromiter(
        (-1 if value is None else value for value in values), np.int32
    )
    wrong = np.flatnonzero(indices >= count)
    if len(wrong):
        source.check_index(
            f"nodes[{wrong[0]}].{name}", int(indices[wrong[0]]), kind, count
        )
    return indices


def _weights(source: GltfSource, rows: Indices) -> dict[int, list[float]]:
    """Weights of morph targets by row, as many as the node's mesh has."""
    document = source.document
    given = [row for row, node in enumerate(document.nodes) if node.weights]
    if not given:
        return {}
    from moka.model.morphs import check_weights

    weights = {}
    for index in given:
        node = document.nodes[index]
        path = f"nodes[{index}].weights"
        if node.mesh is None:
            raise source.error(path, "belong to a mesh, and the node has none")
        check_weights(
            source, path, node.weights, document.meshes[node.mesh].target_count
        )
        weights[int(rows[index])] = node.weights
    return weights


def _skins(source: GltfSource, rows: Indices) -> dict[int, int]:
    """Skins by row, for nodes that have a mesh to be moved by it."""
    document = source.document
    skins = {}
    for index, node in enumerate(document.nodes):
        if node.skin is None:
            continue
        path = f"nodes[{index}].skin"
        source.check_index(path, node.skin, "skins", len(document.skins))
        if node.mesh is None:
            raise source.error(path, "moves a mesh, and the node has none")
        skins[int(rows[index])] = node.skin
    return skins


def _local_matrices(source: GltfSource) -> Array:
    """Matrices (N, 4, 4); one that is given takes the place of a TRS."""
    nodes = source.document.nodes
    if not nodes:
        return np.empty((0, 4, 4))
    matrices = compose(
        _columns((node.translation for node in nodes), len(nodes), 3),
        _columns((node.rotation for node in nodes), len(nodes), 4),
        _columns((node.scale for node in nodes), len(nodes), 3),
    )
    given = [row for row, node in enumerate(nodes) if node.matrix is not None]
    if given:
        columns = np.array([nodes[row].matrix for row in given])
        matrices[given] = columns.reshape(-1, 4, 4).transpose(0, 2, 1)
    too_large = np.abs(matrices).max(axis=(1, 2)) > _LARGEST
    if too_large.any():
        first = np.flatnonzero(too_large)[0]
        raise source.error(
            f"nodes[{first}]", "its matrix is beyond the range of float32"
        )
    return matrices


def _columns(
    rows: Iterable[tuple[float, ...]], count: int, width: int
) -> Array:
    """(count, width) of tuples, without a list of them."""
    numbers = np.fromiter(chain.from_iterable(rows), np.float64, count * width)
    return numbers.reshape(count, width)
