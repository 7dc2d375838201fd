"""A scene: models, lights and an environment, each in its place.

Handles for users (:class:`SceneModel`, :class:`Light`, :class:`Transform`)
stand for rows of arrays, and the renderer reads the arrays. After
:meth:`Scene.update` these agree with the handles; a version number tells for
each kind of change whether there was one.
"""

from typing import TYPE_CHECKING, Any
from weakref import WeakValueDictionary

import numpy as np
from msgspec.structs import replace
from numpy.typing import ArrayLike, NDArray

from moka.core.errors import OptionError
from moka.core.maths import Array
from moka.lighting.environment import BRIGHTEST
from moka.material.material import Material
from moka.model.lights import PunctualLight
from moka.model.model import Model
from moka.scene.background import Background, parse_background
from moka.scene.camera import Camera
from moka.scene.culling import boxes_below, boxes_in_frustum
from moka.scene.drawables import Drawables, ModelLayout
from moka.scene.lights import Light, pack_lights
from moka.scene.scene_model import SceneModel
from moka.scene.transform import Transform
from moka.scene.transforms import TransformTree

if TYPE_CHECKING:
    from moka.scene.animation_player import AnimationPlayer
    from moka.scene.live_materials import LiveMaterials

__all__ = ["Scene"]


class Scene:
    """What there is to render.

    ``environment`` is an :class:`moka.Environment` or None for darkness,
    turned by ``environment_rotation`` radians about +Y (counter-clockwise
    seen from above).

    For the renderer, as of the last :meth:`update`: ``transforms`` with its
    own ``version``, ``drawables`` which are new when ``structure_version``
    is, and ``shown`` (D,), which draws belong to visible models, new when
    ``visibility_version`` is; ``live_materials`` is None where none moves.
    """

    def __init__(self) -> None:
        self.environment: Any = None
        self.environment_rotation = 0.0
        self._environment_intensity = 1.0
        self._background_blur = 0.0
        self.transforms = TransformTree(fixed=True)
        self.drawables = Drawables()
        self.shown: NDArray[np.bool_] = np.zeros(0, np.bool_)
        self.structure_version = 0
        self.visibility_version = 0
        self._background: Background = "environment"
        self._models: dict[SceneModel, None] = {}  # A set that keeps order.
        self._model_rows: set[int] = set()  # Transforms that move models.
        self._lights: list[Light] = []
        self.live_materials: LiveMaterials | None = None
        self._players: dict[SceneModel, AnimationPlayer] = {}
        # Layouts live as long as a copy of their model, whose id is the key.
        self._layouts: WeakValueDictionary[
            tuple[int, int, int | None], ModelLayout
        ] = WeakValueDictionary()
        self._built = (0, 0)
        self._hidden_version = 0

    @property
    def background(self) -> Background:
        """What is behind the models.

        ``environment``, ``transparent`` or a linear Rec.709 colour; takes
        also ``#rrggbb``. Raises OptionError for anything else.
        """
        return self._background

    @background.setter
    def background(self, value: Any) -> None:
        self._background = parse_background(value)

    @property
    def environment_intensity(self) -> float:
        """What the environment's radiance is multiplied by.

        Raises OptionError for what is not between 0 and 1e30.
        """
        return self._environment_intensity

    @environment_intensity.setter
    def environment_intensity(self, value: float) -> None:
        if not 0.0 <= value <= BRIGHTEST:
            raise OptionError(
                f"scene: an environment_intensity of {value} is not between "
                f"0 and {BRIGHTEST:g}"
            )
        self._environment_intensity = value

    @property
    def background_blur(self) -> float:
        """How blurred the environment is behind the models, 0 to 1.

        As a surface of that roughness reflects it; light stays as it is.
        Raises OptionError for what is not between 0 and 1.
        """
        return self._background_blur

    @background_blur.setter
    def background_blur(self, value: float) -> None:
        if not 0.0 <= value <= 1.0:
            raise OptionError(
                f"scene: a background_blur of {value} is not between 0 and 1"
            )
        self._background_blur = value

    @property
    def models(self) -> list[SceneModel]:
        """The models in the order in which they were added."""
        return list(self._models)

    @property
    def cameras(self) -> list[Camera]:
        """The cameras of all models."""
        return [camera for model in self.models for camera in model.cameras]

    @property
    def lights(self) -> list[Light]:
        """The lights of all models, then those that were added."""
        of_models = [light for model in self.models for light in model.lights]
        return of_models + self._lights

    def add(
        self,
        model: Model,
        transform: Transform | ArrayLike | None = None,
        *,
        scene: int | str | None = None,
        variant: int | str | None = None,
    ) -> SceneModel:
        """Put a model into the scene; the same one as often as needed.

        ``transform`` becomes that of the whole model: a Transform, which
        joins this scene, or an affine (4, 4) matrix. ``scene`` is which
        scene of the file, by name or index, by default the one that the file
        names; ``variant`` which of its variants of materials, by default
        none. Arrays of the model are read now; later changes to it go
        unseen.

        Raises OptionError for a transform that belongs to another scene or
        already moves a model, ModelError for a scene or a variant that is
        not there.
        """
        layout = self.layout_of(
            model, model.scene_index(scene), model.variant_index(variant)
        )
        place = self._joined(transform)
        if place.row in self._model_rows:
            raise OptionError(
                "scene: the transform already belongs to a model; give this "
                "one its own and make that the parent"
            )
        added = SceneModel(self, layout, place)
        if added.own_materials:
            self._live()
        self._models[added] = None
        self._model_rows.update(added.rows.tolist(), [place.row])
        self.structure_version += 1
        return added

    def edit_material(self, material: Material, **factors: Any) -> None:
        """Draw what has ``material`` with other numbers from now on.

        ``material`` is that of a primitive of this scene, as it was
        loaded, ``factors`` are fields of :class:`moka.Material` that are
        numbers; those that are not given stay as they are now. Nothing is
        compiled or uploaded but one row.

        Raises OptionError for what is no number of a material, and for
        numbers that another program would have to draw: emission of a
        material that has none, or the metalness of a pure metal.
        """
        from moka.material.numbers import check_numbers

        check_numbers(material, factors)
        live = self._live()
        live.set(material, replace(live.now(material), **factors))

    def material_now(self, material: Material) -> Material:
        """``material`` with the numbers that it is drawn with."""
        live = self.live_materials
        return material if live is None else live.now(material)

    def _live(self) -> "LiveMaterials":
        if self.live_materials is None:
            from moka.scene.live_materials import LiveMaterials

            self.live_materials = LiveMaterials()
        return self.live_materials

    def layout_of(
        self, model: Model, scene: int, variant: int | None
    ) -> ModelLayout:
        """The layout that all copies of a model share, made if need be."""
        key = (id(model), scene, variant)
        layout = self._layouts.get(key)
        if layout is None:
            layout = self._layouts[key] = ModelLayout(model, scene, variant)
        return layout

    def add_light(
        self,
        description: PunctualLight,
        transform: Transform | ArrayLike | None = None,
    ) -> Light:
        """Put a light into the scene, which shines along -Z.

        Raises OptionError for a transform that belongs to another scene.
        """
        light = Light(description, self._joined(transform))
        self._lights.append(light)
        return light

    def remove(self, item: SceneModel | Light) -> None:
        """Take a model, or a light that was added to the scene, out of it.

        Its transforms cannot be used any more, unless other things use them;
        lights at those of a model go with it. Raises OptionError if the item
        is not here.
        """
        if isinstance(item, SceneModel) and item in self._models:
            del self._models[item]
            player = self._players.pop(item, None)
            if player is not None:
                player.close()
            if self.live_materials is not None:
                self.live_materials.forget(item.own_materials.values())
            self.structure_version += 1
            rows = np.append(item.rows, item.transform.row)
            self._model_rows.difference_update(rows.tolist())
            self._lights = [
                light
                for light in self._lights
                if light.transform.row not in rows
            ]
        elif isinstance(item, Light) and item in self._lights:
            self._lights.remove(item)
            row = item.transform.row
            shared = any(light.transform.row == row for light in self._lights)
            rows = np.array([row], np.intp)
            if shared or row in self._model_rows:
                return
        else:
            raise OptionError(f"scene: {item!r} was not added to this scene")
        self.transforms.remove(rows)

    def player_of(self, model: SceneModel) -> "AnimationPlayer":
        """A player for a model's animations, for which time passes here.

        For :attr:`SceneModel.animations` alone. Raises OptionError if the
        model was removed.
        """
        from moka.scene.animation_player import AnimationPlayer

        if model not in self._models:
            raise OptionError(f"scene: {model!r} is not in this scene any more")
        self._players[model] = AnimationPlayer(model, model.layout.clips)
        return self._players[model]

    @property
    def is_animating(self) -> bool:
        """Whether an animation plays, so that time changes the picture."""
        return any(player.is_playing for player in self._players.values())

    def animate(self, delta: float) -> None:
        """Let ``delta`` seconds pass for all animations that play.

        What these move is then where they have it, and may still be changed.
        The loop of :func:`moka.run` calls this
        before each ``update``.
        """
        for player in self._players.values():
            player.advance(delta)
        self._apply_poses()

    def update(self) -> None:
        """Bring all arrays up to date; costs nothing if nothing changed."""
        self._apply_poses()
        self.transforms.update()
        models = self._models
        if self._built[0] != self.structure_version:
            self.drawables = Drawables(
                [model.layout for model in models],
                [model.rows for model in models],
                [model.morph_weights for model in models],
            )
        self.drawables.refresh(self.transforms)
        if self._hidden_version != self.transforms.hidden_version:
            self._hidden_version = self.transforms.hidden_version
            self.visibility_version += 1
        now = self.structure_version, self.visibility_version
        if self._built != now:
            visible = np.array([model.visible for model in models], np.bool_)
            hidden = self.transforms.hidden()
            self.shown = visible[self.drawables.owner]
            self.shown &= ~hidden[self.drawables.row]
            self._built = now

    def visible(
        self, camera: Camera, aspect: float, smallest: float = 0.0
    ) -> NDArray[np.bool_]:
        """Which draws (D,) a camera may see in a picture of ``aspect``.

        Without those that look smaller than ``smallest``, a part of the
        picture's height; points, which have a size of their own, never do.
        As of the last :meth:`update`.
        """
        planes = camera.frustum_planes(aspect)
        drawables = self.drawables
        visible = self.shown & boxes_in_frustum(planes, drawables.boxes)
        if smallest > 0.0:
            below = boxes_below(
                smallest,
                camera.view_matrix,
                camera.projection_matrix(aspect, reversed_z=True),
                drawables.boxes,
            )
            visible &= ~below | drawables.points
        if drawables.levels is not None:
            visible &= drawables.levels.shown(
                drawables.world_bounds, camera, aspect
            )
        return visible

    def narrow(self, camera: Camera, aspect: float) -> None:
        """Forget all draws that ``camera`` does not see, for one picture.

        Nothing is decoded or uploaded for them then. They are back when a
        model comes, goes or changes its variant.
        """
        self.update()
        visible = self.visible(camera, aspect)
        self.drawables = self.drawables.only(visible)
        self.shown = self.shown[visible]
        self.structure_version += 1
        self._built = self.structure_version, self.visibility_version

    @property
    def pose_version(self) -> int:
        """Counts the updates that changed a skin or a morph target."""
        poses = self.drawables.poses
        return 0 if poses is None else poses.version

    def bounds(self) -> Array | None:
        """The world box (2, 3) of the visible models; None without any."""
        self.update()
        return self.drawables.bounds(self.shown)

    def light_rows(self, origin: ArrayLike = (0, 0, 0)) -> NDArray[np.void]:
        """Rows of :data:`moka.scene.lights.LIGHT` of all that shine.

        Positions are relative to ``origin`` (3,). As of the last
        :meth:`update`.
        """
        shining = [
            light
            for model in self._models
            if model.visible
            for light in model.lights
            if light.visible
        ]
        shining += [light for light in self._lights if light.visible]
        hidden = self.transforms.hidden()
        shining = [
            light for light in shining if not hidden[light.transform.row]
        ]
        rows = [light.transform.row for light in shining]
        return pack_lights(
            [light.description for light in shining],
            self.transforms.world[rows] if rows else np.empty((0, 4, 4)),
            origin,
        )

    def _apply_poses(self) -> None:
        if self._players:
            from moka.scene.animation_player import apply_poses

            apply_poses(self._players.values())

    def _joined(self, transform: Transform | ArrayLike | None) -> Transform:
        """A transform of this scene for one that is given."""
        if not isinstance(transform, Transform):
            row = self.transforms.add(transform)
            return Transform.of_row(self.transforms, row)
        if transform.tree is not self.transforms:
            self.transforms.absorb(transform.tree)
        return transform
