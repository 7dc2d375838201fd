"""The numbers of a material, which change without another program."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from msgspec.structs import replace

from moka.core.errors import OptionError
from moka.material.description import describe_material
from moka.material.material import Material

__all__ = ["NUMBERS", "check_numbers"]

#: Fields of :class:`moka.Material` that are in its row on the GPU, and the
#: least and the greatest value of each of their numbers (glTF 2.0, 5.19, and
#: its extensions).
NUMBERS = {
    "base_colour_factor": (4, 0.0, 1.0),
    "metallic_factor": (1, 0.0, 1.0),
    "roughness_factor": (1, 0.0, 1.0),
    "emissive_factor": (3, 0.0, np.inf),
    "normal_scale": (1, -np.inf, np.inf),
    "occlusion_strength": (1, 0.0, 1.0),
    "alpha_cutoff": (1, 0.0, np.inf),
    "ior": (1, 1.0, np.inf),
    "specular_factor": (1, 0.0, 1.0),
    "specular_colour_factor": (3, 0.0, np.inf),
}

# All that a description may ask for.
_ATTRIBUTES = (
    *("NORMAL", "TANGENT", "COLOR_0"),
    *("TEXCOORD_0", "TEXCOORD_1"),
)


def check_numbers(material: Material, numbers: Mapping[str, Any]) -> None:
    """Raise OptionError unless ``numbers`` can replace those of ``material``.

    They are fields of NUMBERS with as many values, finite and within the
    limits, and leave the material's description as it is.
    """
    for name, value in numbers.items():
        if name not in NUMBERS:
            raise OptionError(
                f"material: {name!r} is no number of it; choose from "
                f"{', '.join(NUMBERS)}"
            )
        count, least, most = NUMBERS[name]
        values = np.atleast_1d(np.asarray(value, np.float64))
        if (
            values.shape != (count,)
            or not np.isfinite(values).all()
            or not ((values >= least) & (values <= most)).all()
        ):
            raise OptionError(
                f"material: {name} takes {count} from {least:g} to {most:g}, "
                f"not {value!r}"
            )
    changed = replace(material, **numbers)
    if describe_material(material, _ATTRIBUTES) != describe_material(
        changed, _ATTRIBUTES
    ):
        raise OptionError(
            f"material: {', '.join(numbers)} of {material.name!r} would need "
            "another program; load the model with it"
        )
