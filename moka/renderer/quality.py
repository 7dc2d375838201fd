"""Named points of the chart of error against time: ``--quality``.

``moka bench accuracy`` draws the chart; docs/accuracy.md tells where these
points stand on it.
"""

from types import MappingProxyType
from typing import Any

from moka.core.errors import OptionError
from moka.renderer.settings import RenderSettings

__all__ = ["QUALITIES", "settings_of_quality"]

#: The lighting of each, as settings of RenderSettings; ``balanced`` has its
#: defaults.
QUALITIES: MappingProxyType[str, dict[str, Any]] = MappingProxyType(
    {
        "fast": {"reflections": "half", "irradiance": "sh"},
        "balanced": {},
        "best": {"ibl": "filtered", "ibl_samples": 32},
    }
)


def settings_of_quality(
    quality: str | None = None, **options: Any
) -> RenderSettings:
    """The settings of a named quality, of which ``options`` change some.

    ``options`` are those of :class:`RenderSettings`; None stands for an
    option that was not given. ``quality`` is a name of :data:`QUALITIES`,
    by default ``balanced``. Raises OptionError for an unknown quality and
    for what RenderSettings does not take.
    """
    name = "balanced" if quality is None else quality
    if name not in QUALITIES:
        raise OptionError(
            f"quality: {name!r} is unknown; choose from {', '.join(QUALITIES)}"
        )
    given = {
        option: value for option, value in options.items() if value is not None
    }
    return RenderSettings(**{**QUALITIES[name], **given})
