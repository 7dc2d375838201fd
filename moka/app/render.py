"""One picture, from a file to pixels: the work behind ``moka render``.

Reading the environment and decoding images run in worker threads while the
render thread makes the context and compiles; they meet at the first frame.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from moka.core.aov import parse_aovs
from moka.core.errors import OptionError
from moka.core.image import Image
from moka.core.option_text import LARGEST_SIDE
from moka.core.statistics import Statistics
from moka.renderer.quality import settings_of_quality
from moka.renderer.settings import RenderSettings

if TYPE_CHECKING:
    from moka.commands.commands import Readback
    from moka.graphics.device import GraphicsDevice
    from moka.lighting.environment import Environment
    from moka.model.model import Model
    from moka.scene.camera import Camera
    from moka.scene.scene import Scene
    from moka.scene.scene_model import SceneModel

__all__ = ["RenderRequest", "render", "render_request"]


@dataclass(frozen=True, slots=True)
class RenderRequest:
    """All that decides a picture; the options of ``moka render``.

    ``source`` is a path, the bytes of a file, a pygltflib document, a
    :class:`moka.Model`, or None for the built-in scene. ``environment`` is a
    path, a built-in name or a :class:`moka.Environment`.
    ``environment_rotation`` is in radians about +Y. ``camera`` is what the
    command line's ``--camera`` takes, or a :class:`moka.Camera`. ``aovs``
    are names of :data:`moka.core.aov.AOVS`. ``full_textures`` keeps the
    levels of textures that are too fine for the picture. ``animation`` is a
    name or a position, None for the first one if there is any, ``time`` in
    seconds.
    are names of :data:`moka.core.aov.AOVS`. ``scene`` and ``variant`` are a
    name or an index in the file.
    """

    source: Any = None
    environment: Any = "studio"
    environment_rotation: float = 0.0
    environment_intensity: float = 1.0
    background: Any = "environment"
    camera: Any = None
    size: tuple[int, int] = (1280, 720)
    settings: RenderSettings = field(default_factory=RenderSettings)
    backend: str = "auto"
    aovs: tuple[str, ...] = ()
    full_textures: bool = False
    time: float = 0.0
    animation: str | int | None = None
    scene: str | int | None = None
    variant: str | int | None = None


def render(
    source: Any = None,
    *,
    environment: Any = "studio",
    size: tuple[int, int] = (1280, 720),
    camera: Any = None,
    time: float = 0.0,
    animation: str | int | None = None,
    scene: str | int | None = None,
    variant: str | int | None = None,
    background: Any = "environment",
    environment_rotation: float = 0.0,
    environment_intensity: float = 1.0,
    exposure: float = 0.0,
    tone_map: str = "neutral",
    samples: int = 4,
    brdf: str = "gltf",
    diffuse: str = "lambert",
    multiscatter: bool = True,
    quality: str = "balanced",
    suns: str | int | None = None,
    irradiance: str | None = None,
    ibl: str | None = None,
    ibl_samples: int | None = None,
    reference_samples: int | None = None,
    max_error: float | None = None,
    aov: str | Sequence[str] = (),
    full_textures: bool = False,
    backend: str = "auto",
    cache: bool = True,
) -> Image:
    """Render one picture headless.

    ``source`` is a .gltf or .glb path, the bytes of one, a pygltflib
    document, a :class:`moka.Model`, or None for the built-in demo scene.
    ``environment`` is an equirectangular .hdr or .exr path, ``studio``,
    ``sky``, ``furnace``, ``none`` or a :class:`moka.Environment`, turned by
    ``environment_rotation`` radians counter-clockwise about +Y and its
    radiance multiplied by ``environment_intensity``. ``camera`` is a name or
    index of a camera in the file, ``orbit:YAW,PITCH[,DISTANCE]`` in degrees
    or a :class:`moka.Camera`; by default the file's first camera, else an
    orbit that frames the model. An animated model has the pose of
    ``animation``, a name or a position in ``Model.animations`` (by default
    the first), at ``time`` seconds; an orbit frames it at 0 seconds.
    ``scene`` and ``variant`` choose a scene and a variant of materials of
    the file by name or index, by default the scene that the file names and
    no variant. ``background`` is ``environment``,
    ``transparent`` or ``#rrggbb``. ``exposure`` (EV) and ``tone_map`` are
    how the image shows itself; its pixels are neither exposed nor tone
    mapped. ``brdf`` is ``gltf`` (glTF 2.0 appendix B), ``karis`` or
    ``blinn-phong``, ``diffuse`` ``lambert``, ``oren-nayar`` or ``burley``;
    ``multiscatter`` compensates the energy that single scattering loses
    (Turquin 2019). ``quality`` is ``fast``, ``balanced`` or ``best``: how the
    environment lights, of which the next four change what is not None.
    ``suns`` is how many bright, compact parts of the
    environment are lit as lights with the exact BRDF: ``auto``, ``off`` or
    a number at most. ``irradiance`` is ``sh`` (nine spherical harmonics,
    Ramamoorthi and Hanrahan 2001), ``cube``, or ``auto``, which decides by
    the error of the former. ``ibl`` is how the environment lights:
    ``split-sum``; ``filtered``, with ``ibl_samples`` view-dependent samples
    a pixel; ``reference``, which integrates it until ``reference_samples``
    or an estimated relative standard error of ``max_error``. ``aov`` names
    what else is wanted of the nearest surface of each pixel, any of
    ``depth``, ``normal``, ``albedo``, ``roughness``, ``metallic``,
    ``emission``, ``occlusion``, ``uv`` and ``object-id``: arrays of
    :attr:`moka.Image.layers`, which an .exr file takes along. Without
    ``full_textures`` mip levels that are too fine for the picture are left
    out. With ``cache`` lighting that was preintegrated before is read from
    disk, and new one is written there; the picture is the same.

    Returns an :class:`moka.Image` of linear Rec.709 radiance, float32
    (height, width, 4), top row first.

    Raises ModelError, EnvironmentMapError, ImageFileError, OptionError or
    ContextError, each with one line that names the file and the fault.
    """
    settings = settings_of_quality(
        quality,
        exposure=exposure,
        tone_map=tone_map,
        samples=samples,
        brdf=brdf,
        diffuse=diffuse,
        multiscatter=multiscatter,
        suns=suns,
        irradiance=irradiance,
        ibl=ibl,
        ibl_samples=ibl_samples,
        reference_samples=reference_samples,
        max_error=max_error,
        float_output=True,
    )
    return render_request(
        RenderRequest(
            source,
            environment,
            environment_rotation,
            environment_intensity,
            background,
            camera,
            size,
            settings,
            backend,
            parse_aovs(aov),
            full_textures,
            time,
            animation,
            scene,
            variant,
        ),
        Statistics(),
        want_pixels=True,
        want_display=True,
        cache=cache,
    )


def render_request(
    request: RenderRequest,
    statistics: Statistics,
    *,
    want_pixels: bool,
    want_display: bool,
    debug: bool = False,
    cache: bool = False,
    deliver: Callable[[Image], None] | None = None,
) -> Image:
    """Make the picture of ``request``; see :func:`render` for its errors.

    Only what is wanted is read back: linear ``pixels``, the tone mapped
    ``display`` bytes, or both. ``deliver`` gets the picture as soon as it is
    there; what else is to be done, such as to fill the ``cache``, is done
    afterwards.
    """
    _check_size(request.size)
    # In this order: the context is made and the map is read by other
    # threads while this one reads the model.
    from moka.graphics.device import GraphicsDevice

    with (
        GraphicsDevice.open(request.backend, debug=debug) as device,
        ThreadPoolExecutor(1, thread_name_prefix="moka-read") as reader,
    ):
        return _render_with(
            device,
            request,
            reader.submit(_load_environment, request, statistics, cache=cache),
            statistics,
            want_pixels=want_pixels,
            want_display=want_display,
            cache=cache,
            deliver=deliver,
        )


def _render_with(
    device: "GraphicsDevice",
    request: RenderRequest,
    environment: "Future[Environment | None]",
    statistics: Statistics,
    *,
    want_pixels: bool,
    want_display: bool,
    cache: bool,
    deliver: Callable[[Image], None] | None,
) -> Image:
    from moka.renderer.material_pool import MaterialPool
    from moka.scene.scene import Scene

    with statistics.stage("parse"):
        scene = Scene()
        scene.background = request.background
        scene.environment_rotation = request.environment_rotation
        scene.environment_intensity = request.environment_intensity
        model = scene.add(
            _load_model(request.source),
            scene=request.scene,
            variant=request.variant,
        )
        # An orbit frames the start, and so is the same at every time.
        _pose(model, request, 0.0)
        camera = _choose_camera(request, scene)
        _pose(model, request, request.time)
        if request.full_textures:
            scene.update()
        else:
            width, height = request.size
            scene.narrow(camera, width / height)
    with closing(MaterialPool(device, statistics)) as materials:
        still = None if request.full_textures else camera
        materials.begin(scene, still, request.size)
        # The images decode while this thread imports the rest.
        from moka.commands.command_list import CommandList
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
        scene.environment = environment.result()
        commands = CommandList()
        renderer.draw(scene, camera, commands)
        work = []
        while not renderer.is_complete:
            # What the GPU tells of the error comes with the frame.
            work.append(device.submit(commands).wait())
            commands = CommandList()
            renderer.draw(scene, camera, commands)
        display = renderer.read_display(commands) if want_display else None
        radiance = renderer.read_radiance(commands) if want_pixels else None
        values = None
        if request.aovs:
            values = renderer.read_values(scene, camera, request.aovs, commands)
        work.append(device.submit(commands).wait())
        info = device.info
        for stage, seconds in device.stage_seconds().items():
            statistics.add_time(stage, seconds)
        statistics.lighting.update(renderer.lighting_statistics)
        statistics.gl.update(
            backend=info.kind,
            vendor=info.vendor,
            renderer=info.renderer,
            version=info.version,
        )
        for counters in work:
            for name in counters.__struct_fields__:
                statistics.count(name, getattr(counters, name))
        image = _image(request, radiance, display, values)
        if deliver is not None:
            deliver(image)
        if renderer.has_lighting_to_keep:
            with statistics.stage("store"):
                renderer.keep_lighting()
        return image


def _image(
    request: RenderRequest,
    radiance: "Readback | None",
    display: "Readback | None",
    values: "Mapping[str, Readback] | None",
) -> Image:
    """What was read back, top row first."""
    pixels = None
    if radiance is not None:
        assert radiance.data is not None
        pixels = _over_background(radiance.data[::-1], request.background)
    shown = None
    if display is not None:
        assert display.data is not None
        shown = np.ascontiguousarray(display.data[::-1])
    layers = None
    if values is not None:
        from moka.renderer.surface_values import unpack_values

        layers = unpack_values(request.aovs, values)
    return Image(
        pixels,
        tone_map=request.settings.tone_map,
        exposure=request.settings.exposure,
        display=shown,
        layers=layers,
    )


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
) -> "Environment | None":
    from moka.lighting.environment import Environment, load_environment

    source = request.environment
    if source is None or isinstance(source, Environment):
        return source
    with statistics.stage("decode"):
        environment = load_environment(source)
        if cache and environment is not None:
            # By which the cache finds it; here nobody waits for it.
            _ = environment.digest
        return environment


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
    pixels: NDArray[np.float32], background: Any
) -> NDArray[np.float32]:
    """Radiance over a background colour, as the display pass has it."""
    if isinstance(background, str):
        return np.ascontiguousarray(pixels)
    under = np.append(np.asarray(background, np.float32), np.float32(1))
    return pixels + under * (1 - pixels[:, :, 3:])


def _check_size(size: tuple[int, int]) -> None:
    if (
        not all(
            isinstance(side, int | np.integer) and 1 <= side <= LARGEST_SIDE
            for side in size
        )
        or len(size) != 2
    ):
        raise OptionError(
            f"size: {size!r} is not (width, height) from 1 to {LARGEST_SIDE}"
        )
