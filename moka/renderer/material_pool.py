"""The materials that are described, and the images that decode for them."""

from collections.abc import Callable, Sequence

from moka.core.statistics import Statistics
from moka.graphics.device import GraphicsDevice
from moka.model.mesh import Primitive
from moka.renderer.sampled_levels import StillPicture
from moka.renderer.scene_materials import SceneMaterials
from moka.renderer.texture_settings import TextureSettings
from moka.renderer.textures import TexturePool
from moka.scene.camera import Camera
from moka.scene.scene import Scene

__all__ = ["MaterialPool"]


class MaterialPool:
    """The textures of one device, and the materials of the last scene.

    A :class:`moka.Renderer` makes one for itself, or is given one that has
    begun already.
    """

    def __init__(self, device: GraphicsDevice, statistics: Statistics) -> None:
        self.textures = TexturePool(device, statistics)
        self._statistics = statistics
        self._still: StillPicture | None = None
        self._materials: SceneMaterials | None = None
        self.key: object = None

    def close(self) -> None:
        """Stop the decoding threads; resources go with the device."""
        self.textures.close()

    def begin(
        self,
        scene: Scene,
        still: Camera | None,
        size: tuple[int, int],
        settings: TextureSettings,
    ) -> None:
        """Start to decode what ``scene`` samples, without waiting for it.

        Of a scene that is up to date. With ``still``, a camera, only what a
        picture through it shows: images of what it does not see stay
        unopened, and textures lose the levels that are too fine for it.
        :meth:`describe` makes up for it if asked for another.
        """
        self._still = StillPicture(scene, still, size) if still else None
        self._describe(scene, settings)

    def begin_primitives(
        self, primitives: Sequence[Primitive], settings: TextureSettings
    ) -> SceneMaterials:
        """Start to decode all that ``primitives`` sample, on any thread.

        A scene that has them then is drawn without waiting for it, once
        :meth:`finish` has.
        """
        return SceneMaterials(primitives, self.textures, None, settings)

    def finish(
        self, materials: SceneMaterials, told: Callable[[int, int], None]
    ) -> None:
        """Wait until all that ``materials`` sample is decoded.

        ``told`` gets how many textures are done, and of how many; what it
        raises ends the waiting. Raises ImageFileError for an image that
        cannot be had.
        """
        requests = {
            request: None
            for bound in materials.requests
            for request in bound.values()
        }
        for done, request in enumerate(requests):
            told(done, len(requests))
            self.textures.handle(request)

    def describe(
        self,
        scene: Scene,
        camera: Camera,
        size: tuple[int, int],
        settings: TextureSettings,
    ) -> SceneMaterials:
        """The materials of ``scene``, as of its last update.

        All of them, unless this is the picture that was begun. They are new
        ones when ``key`` is.
        """
        if self._still is not None and not self._still.shows(
            scene, camera, size
        ):
            self._still = None
        return self._describe(scene, settings)

    def _describe(
        self, scene: Scene, settings: TextureSettings
    ) -> SceneMaterials:
        key = (id(scene), scene.structure_version, self._still, settings)
        if self._materials is None or self.key != key:
            self._statistics.count("textures_loaded", 0)
            self._statistics.count("textures_reduced", 0)
            self._materials = SceneMaterials(
                scene.drawables.primitives,
                self.textures,
                self._still,
                settings,
            )
            self.key = key
            images = {
                id(texture.image)
                for model in scene.models
                for material in model.model.materials
                for texture in material.textures
            }
            self._statistics.set_count(
                "textures_skipped", len(images - self._materials.sampled)
            )
        return self._materials
