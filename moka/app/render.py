"""One picture, from a file to pixels: the work behind ``moka render``."""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from moka.app.render_request import RenderRequest, request_of
from moka.app.render_session import RenderSession
from moka.core.statistics import Statistics

if TYPE_CHECKING:
    from moka.core.image import Image

__all__ = ["render", "render_request"]


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
    background_blur: float = 0.0,
    exposure: float = 0.0,
    tone_map: str = "neutral",
    gamma: float | None = None,
    samples: int = 4,
    brdf: str = "gltf",
    diffuse: str = "lambert",
    multiscatter: bool = True,
    quality: str = "balanced",
    suns: str | int | None = None,
    irradiance: str | None = None,
    reflections: str | None = None,
    ibl: str | None = None,
    ibl_samples: int | None = None,
    reference_samples: int | None = None,
    max_error: float | None = None,
    anisotropy: int = 1,
    mip_filter: str | None = None,
    max_texture_size: int | None = None,
    specular_aa: bool = False,
    cull_pixels: float = 0.5,
    shading: str = "auto",
    aov: str | Sequence[str] = (),
    full_textures: bool = False,
    backend: str = "auto",
    cache: bool = True,
) -> "Image":
    """Render one picture headless.

    ``source`` is a .gltf or .glb path, the bytes of one, a pygltflib
    document, a :class:`moka.Model`, or None for the built-in demo scene.
    ``environment`` is an equirectangular .hdr or .exr path, ``studio``,
    ``sky``, ``furnace``, ``none`` or a :class:`moka.Environment`, turned by
    ``environment_rotation`` radians counter-clockwise about +Y and its
    radiance multiplied by ``environment_intensity``. ``camera`` is a name or
    index of a camera in the file, ``orbit:YAW,PITCH[,DISTANCE]`` in degrees,
    ``look:EX,EY,EZ,TX,TY,TZ[,FOV]`` from a point to another one in metres
    (FOV is the vertical angle in degrees, or with an ``m`` the height of a
    parallel projection), or a :class:`moka.Camera`; by default the file's
    first camera, else an orbit that frames the model. An animated model has
    the pose of ``animation``, a name or a position in ``Model.animations``
    (by default the first), at ``time`` seconds; an orbit frames it at 0 s.
    ``scene`` and ``variant`` choose a scene and a variant of materials of
    the file by name or index, by default the scene that the file names and
    no variant. ``background`` is ``environment``,
    ``transparent`` or ``#rrggbb``; ``background_blur``, 0 to 1, blurs the
    environment there as a surface of that roughness would. ``exposure``
    (EV), ``tone_map`` and ``gamma`` (a power in the place of the sRGB curve)
    are how the image shows itself; its pixels are neither exposed nor tone
    mapped. ``brdf`` is ``gltf`` (glTF 2.0 appendix B), ``karis`` or
    ``blinn-phong``, ``diffuse`` ``lambert``, ``oren-nayar`` or ``burley``;
    ``multiscatter`` compensates the energy that single scattering loses
    (Turquin 2019). ``quality`` is ``fast``, ``balanced`` or ``best``: how the
    environment lights, of which the next five change what is not None.
    ``suns`` is how many bright, compact parts of the
    environment are lit as lights with the exact BRDF: ``auto``, ``off`` or
    a number at most. ``irradiance`` is ``sh`` (nine spherical harmonics,
    Ramamoorthi and Hanrahan 2001), ``cube``, or ``auto``, which decides by
    the error of the former. ``reflections`` is ``full``, prefiltered as fine
    as the map, or ``half`` of that. ``ibl`` is how the environment lights:
    ``split-sum``; ``filtered``, with ``ibl_samples`` view-dependent samples
    a pixel; ``reference``, which integrates it until ``reference_samples``
    or an estimated relative standard error of ``max_error``. Anything but
    that leaves out what looks smaller than ``cull_pixels``. ``aov`` names
    what else is wanted of the nearest surface of each pixel, any of
    ``depth``, ``normal``, ``albedo``, ``roughness``, ``metallic``,
    ``emission``, ``occlusion``, ``uv`` and ``object-id``: arrays of
    :attr:`moka.Image.layers`, which an .exr file takes along. ``anisotropy``
    is the most samples of a texture seen at a grazing angle, 1 to 16,
    ``mip_filter`` ``linear`` or ``nearest``, whether two levels of it are
    mixed or one is read, ``max_texture_size`` the most texels along a side
    that it keeps. ``specular_aa`` makes surfaces as rough as the bumps of
    normal maps that a pixel averages (after Toksvig 2005). ``shading`` is
    ``forward``, as surfaces are drawn, ``visibility``, each pixel once when
    it is known what it sees (Burns and Hunt 2013), where the scene allows
    it, or ``auto``, what is faster. Without
    ``full_textures`` mip levels that are too fine for the picture are left
    out. With ``cache`` lighting that was preintegrated before is read from
    disk, and new one is written there; the picture is the same.

    Returns an :class:`moka.Image` of linear Rec.709 radiance, float32
    (height, width, 4), top row first.

    Raises ModelError, EnvironmentMapError, ImageFileError, OptionError or
    ContextError, each with one line that names the file and the fault.
    """
    request = request_of(
        source,
        environment=environment,
        size=size,
        camera=camera,
        time=time,
        animation=animation,
        scene=scene,
        variant=variant,
        background=background,
        environment_rotation=environment_rotation,
        environment_intensity=environment_intensity,
        background_blur=background_blur,
        exposure=exposure,
        tone_map=tone_map,
        gamma=gamma,
        samples=samples,
        brdf=brdf,
        diffuse=diffuse,
        multiscatter=multiscatter,
        quality=quality,
        suns=suns,
        irradiance=irradiance,
        reflections=reflections,
        ibl=ibl,
        ibl_samples=ibl_samples,
        reference_samples=reference_samples,
        max_error=max_error,
        anisotropy=anisotropy,
        mip_filter=mip_filter,
        max_texture_size=max_texture_size,
        specular_aa=specular_aa,
        cull_pixels=cull_pixels,
        shading=shading,
        aov=aov,
        full_textures=full_textures,
        backend=backend,
    )
    return render_request(
        request,
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
    deliver: "Callable[[Image], None] | None" = None,
) -> "Image":
    """Make the picture of ``request``; see :func:`render` for its errors.

    Only what is wanted is read back: linear ``pixels``, the tone mapped
    ``display`` bytes, or both. ``deliver`` gets the picture as soon as it is
    there; what else is to be done, such as to fill the ``cache``, is done
    afterwards.
    """
    with RenderSession.open(
        request, statistics, debug=debug, cache=cache
    ) as session:
        image = session.submit(
            want_pixels=want_pixels, want_display=want_display
        ).wait()
        session.report()
        if deliver is not None:
            deliver(image)
        session.keep_lighting()
        return image
