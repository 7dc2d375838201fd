"""What is behind the models: the environment, nothing, or one colour."""

import math
from typing import Any, Literal

from moka.core.colour import parse_hex_colour
from moka.core.errors import OptionError

__all__ = ["Background", "parse_background"]

#: ``environment``, ``transparent`` or a linear Rec.709 colour.
Background = Literal["environment", "transparent"] | tuple[float, float, float]


def parse_background(value: Any) -> Background:
    """A background from ``environment``, ``transparent`` or a colour.

    A colour is ``#rrggbb``, encoded as sRGB, or three linear Rec.709 values
    of at least 0. Raises OptionError for anything else.
    """
    if isinstance(value, str):
        if value == "environment":
            return "environment"
        if value == "transparent":
            return "transparent"
        if value.startswith("#"):
            return parse_hex_colour(value)
    else:
        try:
            red, green, blue = (float(number) for number in value)
        except (TypeError, ValueError):
            pass
        else:
            if min(red, green, blue) >= 0 and math.isfinite(red + green + blue):
                return red, green, blue
    raise OptionError(
        f"background: {value!r} is neither environment, transparent, "
        "#rrggbb nor three linear values"
    )
