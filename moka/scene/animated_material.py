"""A material with some of its numbers replaced, as animations do it."""

from collections.abc import Mapping
from typing import Any

from msgspec.structs import replace

from moka.material.material import Material, TextureTransform

__all__ = ["material_value", "with_values"]

# What the specification keeps between 0 and 1; splines may leave that.
_POSITIVE = frozenset(("ior", "specular_colour_factor"))
_FRACTIONS = frozenset(
    (
        "base_colour_factor",
        "metallic_factor",
        "roughness_factor",
        "occlusion_strength",
        "specular_factor",
    )
)


def material_value(material: Material, name: str) -> Any:
    """A material's number or numbers of a name that animations move."""
    if name == "emissive_strength":
        return 1.0  # The factor holds it already.
    owner, _, part = name.partition(".")
    value = getattr(material, owner)
    if not part:
        return value
    transform = value.transform if value is not None else None
    return getattr(transform or TextureTransform(), part)


def with_values(material: Material, values: Mapping[str, Any]) -> Material:
    """``material`` with ``values`` by names that animations move.

    Numbers or tuples of them; those that must be fractions become some, and
    no light is negative.
    """
    changes: dict[str, Any] = {}
    for name, value in values.items():
        owner, _, part = name.partition(".")
        if part:
            texture = changes.get(owner, getattr(material, owner))
            if texture is not None:
                transform = texture.transform or TextureTransform()
                changes[owner] = replace(
                    texture, transform=replace(transform, **{part: value})
                )
        elif name in _FRACTIONS:
            changes[name] = _clamped(value, 1.0)
        elif name in _POSITIVE:
            changes[name] = _clamped(value, float("inf"))
        elif name == "emissive_factor":
            strength = values.get("emissive_strength", 1.0)
            changes[name] = _clamped(
                tuple(each * strength for each in value), float("inf")
            )
        elif name != "emissive_strength":
            changes[name] = value
    return replace(material, **changes)


def _clamped(value: Any, largest: float) -> Any:
    """A number, or each of a tuple, from 0 to ``largest``."""
    if isinstance(value, tuple):
        return tuple(_clamped(each, largest) for each in value)
    return min(max(value, 0.0), largest)
