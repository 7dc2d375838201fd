"""One copy of a model in a scene."""

from typing import TYPE_CHECKING

from msgspec.structs import replace

from moka.core.errors import OptionError
from moka.material.material import Material
from moka.model.model import Model
from moka.scene.camera import Camera
from moka.scene.drawables import ModelLayout
from moka.scene.forest import Rows
from moka.scene.lights import Light
from moka.scene.transform import Transform

if TYPE_CHECKING:
    from moka.scene.animation_player import AnimationPlayer
    from moka.scene.morph_weights import MorphWeights
    from moka.scene.scene import Scene

__all__ = ["SceneModel"]


class SceneModel:
    """A model, its place in the world, and its nodes there.

    ``scene`` is the one that it is in, ``transform`` moves the whole;
    ``rows`` (N,) are the transform rows of the model's nodes; ``cameras``
    and ``lights`` are those that its nodes place; ``morph_weights`` are the
    weights of its morph targets, None without any, ``own_materials`` what it
    has in place of materials of the model that are animated. Made by
    :meth:`moka.Scene.add`.
    """

    def __init__(
        self,
        scene: "Scene",
        layout: ModelLayout,
        transform: Transform,
    ) -> None:
        model = layout.model
        self.model: Model = model
        # What animations change is this copy's alone.
        self.own_materials: dict[Material, Material] = {
            material: replace(material)
            for material in model.materials
            if material.animated
        }
        self.layout = layout.with_materials(self.own_materials)
        self.transform = transform
        self.rows: Rows = transform.tree.add_many(
            model.nodes.local, model.nodes.parents, transform.row
        )
        if len(model.nodes.hidden):
            hidden = self.rows[model.nodes.hidden]
            transform.tree.set_visible(hidden, False)
        self.cameras = [
            self._camera(node, camera) for node, camera in layout.cameras
        ]
        self.lights = [
            Light(model.lights[light], self.node(node))
            for node, light in layout.lights
        ]
        self.morph_weights = _morph_weights(model)
        self.scene = scene
        self._visible = True
        self._player: AnimationPlayer | None = None

    def __repr__(self) -> str:
        return f"<SceneModel {self.model.name!r}: {self.transform!r}>"

    @property
    def visible(self) -> bool:
        """Whether it is drawn and its lights shine."""
        return self._visible

    @visible.setter
    def visible(self, value: bool) -> None:
        if value != self._visible:
            self._visible = value
            self.scene.visibility_version += 1

    @property
    def animations(self) -> "AnimationPlayer":
        """What plays the animations of the model; nothing plays at first.

        Raises OptionError if the model was removed before it is first used.
        """
        if self._player is None:
            self._player = self.scene.player_of(self)
        return self._player

    @property
    def variant(self) -> str | None:
        """The variant of materials that it is drawn in, None for none.

        Takes a name or an index in ``model.variants``; geometry stays on the
        GPU. Raises ModelError, listing the variants, for another.
        """
        number = self.layout.variant
        return None if number is None else self.model.variants[number]

    @variant.setter
    def variant(self, value: str | int | None) -> None:
        number = self.model.variant_index(value)
        if number != self.layout.variant:
            layout = self.scene.layout_of(self.model, self.layout.scene, number)
            self.layout = layout.with_materials(self.own_materials)
            self.scene.structure_version += 1

    def node(self, node: int | str) -> Transform:
        """The transform of a node, by its row in ``model.nodes`` or name.

        Raises OptionError if there is none, or several of that name.
        """
        names = self.model.nodes.names
        if isinstance(node, str):
            found = names.count(node)
            if found != 1:
                raise OptionError(
                    f"scene: {found or 'no'} nodes of the model are named "
                    f"{node!r}"
                )
            node = names.index(node)
        if not 0 <= node < len(names):
            raise OptionError(
                f"scene: there is no node {node}, the model has {len(names)}"
            )
        return Transform.of_row(self.transform.tree, int(self.rows[node]))

    def remove(self) -> None:
        """Take the model out of its scene.

        Its transforms cannot be used any more; what other things were put
        below them stays where it is in the world.
        """
        self.scene.remove(self)

    def _camera(self, node: int, number: int) -> Camera:
        """A camera of the file where a node places it."""
        camera = Camera.from_description(
            self.model.cameras[number], self.node(node)
        )
        camera.name = camera.name or self.model.nodes.names[node]
        return camera


def _morph_weights(model: Model) -> "MorphWeights | None":
    if not any(mesh.target_count for mesh in model.meshes):
        return None
    from moka.scene.morph_weights import MorphWeights

    return MorphWeights(model)
