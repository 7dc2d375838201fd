"""What pictures of one request are made with, while they are made.

Reading the environment and decoding images run in worker threads while the
render thread makes the context and compiles; they meet at the first frame.
Imports are in the order of this work. The interpreter's lock is held by them
for a third of a picture's time, so that what can do without it, which is the
decoding of images, begins before all that can wait is imported.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager
from typing import TYPE_CHECKING, Any

from moka.app.render_request import RenderRequest
from moka.core.errors import OptionError
from moka.core.option_text import LARGEST_SIDE
from moka.core.statistics import Statistics

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from moka.commands.commands import Readback
    from moka.core.image import Image
    from moka.graphics.device import Frame, GraphicsDevice
    from moka.lighting.environment import Environment
    from moka.model.model import Model
    from moka.renderer.renderer import Renderer
    from moka.scene.camera import Camera
    from moka.scene.scene import Scene
    from moka.scene.scene_model import SceneModel

__all__ = ["PendingImage", "RenderSession"]


class PendingImage:
    """A picture that is being made; :meth:`wait` for it."""

    def __init__(
        self,
        session: "RenderSession",
        frame: "Frame",
        radiance: "Readback | None",
        display: "Readback | None",
        values: "Mapping[str, Readback] | None",
    ) -> None:
        self._session = session
        self._frame = frame
        self._radiance = radiance
        self._display = display
        self._values = values
        # As it is drawn: a text may name a colour.
        self._background = session.scene.background

    def wait(self) -> "Image":
        """The picture, when the GPU has made it; raises what it raised."""
        # Imported while the GPU draws.
        import numpy as np

        from moka.core.image import Image

        self._session.count(self._frame)
        request = self._session.request
        pixels = shown = None
        if self._radiance is not None:
            assert self._radiance.data is not None
            # What was read back has its bottom row first.
            pixels = _over_background(
                self._radiance.data[::-1], self._background
            )
        if self._display is not None:
            assert self._display.data is not None
            shown = np.ascontiguousarray(self._display.data[::-1])
        return Image(
            pixels,
            tone_map=request.settings.tone_map,
            exposure=request.settings.exposure,
            gamma=request.settings.gamma,
            display=shown,
            layers=_layers(request, self._values),
        )


class RenderSession:
    """A scene with the model of a request, its camera, and what draws them.

    ``request`` may not change. Made by :meth:`open`; then :meth:`pose`,
    move the ``camera``, and :meth:`submit`, as often as needed.
    """

    def __init__(
        self,
        request: RenderRequest,
        statistics: Statistics,
        device: "GraphicsDevice",
        renderer: "Renderer",
        scene: "Scene",
        model: "SceneModel",
        camera: "Camera",
        keep_map: Callable[[], None] | None = None,
    ) -> None:
        self.request = request
        self.scene = scene
        self.model = model
        self.camera = camera
        self._statistics = statistics
        self.device = device
        self.renderer = renderer
        self._keep_map = keep_map

    @classmethod
    @contextmanager
    def open(
        cls,
        request: RenderRequest,
        statistics: Statistics,
        *,
        debug: bool = False,
        cache: bool = False,
        moves: bool = False,
    ) -> "Iterator[RenderSession]":
        """Open a device and load what ``request`` names.

        ``cache`` is whether preintegrated lighting comes from disk, ``moves``
        whether there will be pictures from other places than the camera's.
        Raises what :func:`moka.render` does.
        """
        _check_size(request.size)
        with ThreadPoolExecutor(1, thread_name_prefix="moka-read") as reader:
            environment = reader.submit(
                _load_environment, request, statistics, cache=cache
            )
            with statistics.stage("parse"):
                scene, model, camera = _load_scene(request)
                still = None if moves or request.full_textures else camera
                if still is None:
                    scene.update()
                else:
                    width, height = request.size
                    scene.narrow(camera, width / height)
            # Its thread imports much; it is started when images can decode.
            from moka.graphics.device import GraphicsDevice
            from moka.renderer.material_pool import MaterialPool

            with (
                GraphicsDevice.open(request.backend, debug=debug) as device,
                closing(MaterialPool(device, statistics)) as materials,
            ):
                materials.begin(
                    scene, still, request.size, request.settings.textures
                )
                # The images decode while this thread imports the rest.
                from moka.lighting.disk_cache import DiskCache
                from moka.renderer.renderer import Renderer

                renderer = Renderer(
                    device,
                    request.size,
                    request.settings,
                    statistics=statistics,
                    cache=DiskCache() if cache else None,
                    materials=materials,
                )
                scene.environment, keep_map = environment.result()
                yield cls(
                    request,
                    statistics,
                    device,
                    renderer,
                    scene,
                    model,
                    camera,
                    keep_map,
                )

    def pose(self, time: float) -> None:
        """Move the model to its pose at ``time`` seconds."""
        _pose(self.model, self.request, time)

    @property
    def animation_duration(self) -> float:
        """Seconds that the animation takes; 0 where nothing is animated."""
        if not self.model.model.animations:
            return 0.0
        current = self.model.animations.current
        return current.duration if current else 0.0

    def submit(self, *, want_pixels: bool, want_display: bool) -> PendingImage:
        """Begin a picture of the scene as it is now.

        Only what is wanted is read back: linear ``pixels``, the tone mapped
        ``display`` bytes, or both.
        """
        from moka.commands.command_list import CommandList

        renderer, request = self.renderer, self.request
        commands = CommandList()
        renderer.draw(self.scene, self.camera, commands)
        while not renderer.is_complete:
            # What the GPU tells of the error comes with the frame.
            self.count(self.device.submit(commands))
            commands = CommandList()
            renderer.draw(self.scene, self.camera, commands)
        display = renderer.read_display(commands) if want_display else None
        radiance = renderer.read_radiance(commands) if want_pixels else None
        values = None
        if request.aovs:
            values = renderer.read_values(
                self.scene, self.camera, request.aovs, commands
            )
        frame = self.device.submit(commands)
        return PendingImage(self, frame, radiance, display, values)

    def count(self, frame: "Frame") -> None:
        """Wait for a frame and count its work in the statistics."""
        counters = frame.wait()
        for name in counters.__struct_fields__:
            self._statistics.count(name, getattr(counters, name))

    def report(self) -> None:
        """Write into the statistics what is known when all is drawn."""
        info, statistics = self.device.info, self._statistics
        for stage, seconds in self.device.stage_seconds().items():
            statistics.add_time(stage, seconds)
        statistics.lighting.update(self.renderer.lighting_statistics)
        statistics.gl.update(
            backend=info.kind,
            vendor=info.vendor,
            renderer=info.renderer,
            version=info.version,
        )

    def keep_lighting(self) -> None:
        """Write preintegrated lighting that is new to the disk cache."""
        if self.renderer.has_lighting_to_keep:
            with self._statistics.stage("store"):
                self.renderer.keep_lighting()
        if self._keep_map is not None:
            with self._statistics.stage("store"):
                self._keep_map()
            self._keep_map = None


def _layers(
    request: RenderRequest, values: "Mapping[str, Readback] | None"
) -> "dict[str, NDArray[Any]] | None":
    if values is None:
        return None
    from moka.renderer.surface_values import unpack_values

    return unpack_values(request.aovs, values)


def _load_scene(
    request: RenderRequest,
) -> "tuple[Scene, SceneModel, Camera]":
    """The scene of a request, without its environment."""
    from moka.scene.scene import Scene

    scene = Scene()
    scene.background = request.background
    scene.environment_rotation = request.environment_rotation
    scene.environment_intensity = request.environment_intensity
    scene.background_blur = request.background_blur
    model = scene.add(
        _load_model(request.source),
        scene=request.scene,
        variant=request.variant,
    )
    # An orbit frames the start, and so is the same at every time.
    _pose(model, request, 0.0)
    camera = _choose_camera(request, scene)
    _pose(model, request, request.time)
    return scene, model, camera


def _load_model(source: Any) -> "Model":
    from moka.model.model import Model

    if isinstance(source, Model):
        return source
    from moka.model.load import load_model

    if source is None:
        from moka.core.resources import asset_folder

        source = asset_folder() / "demo.glb"
    return load_model(source)


def _pose(model: "SceneModel", request: RenderRequest, time: float) -> None:
    """Give the model the pose that is asked for; one that moves has one."""
    if not math.isfinite(time):
        raise OptionError("time: must be a finite number of seconds")
    wanted = request.animation
    if model.model.animations or wanted is not None:
        model.animations.pose(0 if wanted is None else wanted, time)


def _load_environment(
    request: RenderRequest, statistics: Statistics, *, cache: bool
) -> "tuple[Environment | None, Callable[[], None] | None]":
    """The environment, and what keeps it in the cache if it is new."""
    from moka.lighting.environment import (
        Environment,
        is_map_file,
        load_environment,
    )

    source = request.environment
    if source is None or isinstance(source, Environment):
        return source, None
    with statistics.stage("decode"):
        if cache and is_map_file(source):
            from moka.lighting.disk_cache import DiskCache
            from moka.lighting.map_cache import load_map

            return load_map(source, DiskCache())
        environment = load_environment(source)
        if cache and environment is not None:
            # By which the cache finds it; here nobody waits for it.
            _ = environment.digest
        return environment, None


def _choose_camera(request: RenderRequest, scene: "Scene") -> "Camera":
    from moka.scene.camera import Camera
    from moka.scene.camera_choice import choose_camera, parse_camera

    choice = request.camera
    if isinstance(choice, Camera):
        return choice
    if isinstance(choice, str):
        choice = parse_camera(choice)
    width, height = request.size
    return choose_camera(scene, choice, width / height)


def _over_background(
    pixels: "NDArray[np.float32]", background: Any
) -> "NDArray[np.float32]":
    """Radiance over a background colour, as the display pass has it."""
    import numpy as np

    if isinstance(background, str):
        return np.ascontiguousarray(pixels)
    under = np.append(np.asarray(background, np.float32), np.float32(1))
    return pixels + under * (1 - pixels[:, :, 3:])


def _check_size(size: tuple[int, int]) -> None:
    if (
        not all(
            hasattr(side, "__index__") and 1 <= side <= LARGEST_SIDE
            for side in size
        )
        or len(size) != 2
    ):
        raise OptionError(
            f"size: {size!r} is not (width, height) from 1 to {LARGEST_SIDE}"
        )
