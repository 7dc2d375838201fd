"""All that decides a picture, as one value."""

from collections.abc import Iterable
from typing import Any

from msgspec import Struct

from moka.core.aov import parse_aovs
from moka.renderer.quality import settings_of_quality
from moka.renderer.settings import RenderSettings

__all__ = ["RenderRequest", "request_of"]


class RenderRequest(Struct, frozen=True):
    """All that decides a picture; the options of ``moka render``.

    ``source`` is a path, the bytes of a file, a pygltflib document, a
    :class:`moka.Model`, or None for the built-in scene. ``environment`` is a
    path, a built-in name or a :class:`moka.Environment`.
    ``environment_rotation`` is in radians about +Y, ``background_blur`` 0 to
    1. ``camera`` is what the
    command line's ``--camera`` takes, or a :class:`moka.Camera`. ``aovs``
    are names of :data:`moka.core.aov.AOVS`. ``full_textures`` keeps the
    levels of textures that are too fine for the picture. ``animation`` is a
    name or a position, None for the first one if there is any, ``time`` in
    seconds. ``scene`` and ``variant`` are a name or an index in the file.
    """

    source: Any = None
    environment: Any = "studio"
    environment_rotation: float = 0.0
    environment_intensity: float = 1.0
    background_blur: float = 0.0
    background: Any = "environment"
    camera: Any = None
    size: tuple[int, int] = (1280, 720)
    settings: RenderSettings = RenderSettings()
    backend: str = "auto"
    aovs: tuple[str, ...] = ()
    full_textures: bool = False
    time: float = 0.0
    animation: str | int | None = None
    scene: str | int | None = None
    variant: str | int | None = None


def request_of(
    source: Any,
    *,
    quality: str = "balanced",
    aov: str | Iterable[str] = (),
    **options: Any,
) -> RenderRequest:
    """The request that the options of :func:`moka.render` make.

    Raises OptionError for values that mean nothing, TypeError for options
    that there are not.
    """
    names = set(RenderRequest.__struct_fields__)
    of_request = {name: options.pop(name) for name in names & options.keys()}
    settings = settings_of_quality(quality, float_output=True, **options)
    return RenderRequest(
        source, settings=settings, aovs=parse_aovs(aov), **of_request
    )
