"""The numbers of a material, which change without another program."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from msgspec.structs import replace

from moka.core.errors import OptionError
from moka.material.description import describe_material
from moka.material.material import Material

__all__ = ["NUMBERS", "can_change", "check_numbers"]

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
    limits, and as they are unless the material :func:`can_change` them.
    """
    for name, value in numbers.items():
        if name not in NUMBERS:
            raise OptionError(
                f"material: {name!r} is no number of it; choose from "
                f"{', '.join(NUMBERS)}"
            )
        count, least, most = NUMBERS[name]
        values = np.atleast_1d(np.asarray(value, np.float64))
        if np.array_equal(values, np.atleast_1d(getattr(material, name))):
            continue  # What a file says may be beyond them: an ior of 0.
        if (
            values.shape != (count,)
            or not np.isfinite(values).all()
            or not ((values >= least) & (values <= most)).all()
        ):
            raise OptionError(
                f"material: {name} takes {count} from {least:g} to {most:g}, "
                f"not {value!r}"
            )
        if not can_change(material, name):
            raise OptionError(
                f"material: {name} of {material.name!r} would need another "
                "program; load the model with it"
            )


def can_change(material: Material, name: str) -> bool:
    """Whether a field of NUMBERS may have any value in the same program.

    It then is described as if animations moved it. A pure metal has a
    program without the terms of dielectrics, a dark material none of
    emission, one of default reflectance none of KHR_materials_specular.
    """
    moving = replace(material, animated=material.animated | {name})
    return describe_material(material, _ATTRIBUTES) == describe_material(
        moving, _ATTRIBUTES
    )
