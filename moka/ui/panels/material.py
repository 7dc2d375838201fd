"""Widgets for the numbers of a material."""

from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import Struct

from moka.material.material import AlphaMode, Material
from moka.material.numbers import NUMBERS, can_change
from moka.ui.widgets import hint

if TYPE_CHECKING:
    from moka.scene.scene import Scene

__all__ = ["changes_of_material", "material_numbers"]

# On a logarithmic scale; a person may type more.
_MOST_EMISSION = 100.0
_MOST_IOR = 3.0

_REASONS = {
    "metallic_factor": (
        "The model was loaded as a pure metal, and its shader knows nothing "
        "else. With a metallicFactor below 1 in the file this is free."
    ),
    "emissive_factor": (
        "The model was loaded dark, and its shader has no emission. With an "
        "emissiveFactor in the file this is free."
    ),
}


class _Slider(Struct, frozen=True):
    """How one number of a material is shown."""

    label: str
    field: str
    most: float
    least: float = 0.0
    text: str = "%.3f"


_LIT = (
    _Slider("roughness", "roughness_factor", 1.0),
    _Slider("metalness", "metallic_factor", 1.0),
)
_NORMAL = _Slider("normal scale", "normal_scale", 4.0)
_OCCLUSION = _Slider("occlusion", "occlusion_strength", 1.0)
_CUTOFF = _Slider("alpha cutoff", "alpha_cutoff", 1.0)
# Of KHR_materials_ior and KHR_materials_specular.
_DIELECTRIC = (
    _Slider("refractive index", "ior", _MOST_IOR, 1.0),
    _Slider("specular", "specular_factor", 1.0),
)


def material_numbers(material: Material) -> tuple[str, ...]:
    """The fields of a material that change its picture, in their order.

    Of those that it would need an extension or a texture for, none.
    """
    return (
        "base_colour_factor",
        *(slider.field for slider in _sliders(material)),
        *(("specular_colour_factor",) if _has_specular(material) else ()),
        *(() if material.unlit else ("emissive_factor",)),
    )


def _sliders(material: Material) -> tuple[_Slider, ...]:
    is_masked = material.alpha_mode is AlphaMode.MASK
    cutoff = (_CUTOFF,) if is_masked else ()
    if material.unlit:
        return cutoff
    return (
        *_LIT,
        *((_NORMAL,) if material.normal_texture is not None else ()),
        *((_OCCLUSION,) if material.occlusion_texture is not None else ()),
        *cutoff,
        *(_DIELECTRIC if _has_specular(material) else ()),
    )


def _has_specular(material: Material) -> bool:
    """Whether its shader reads what the two extensions say."""
    return not material.unlit and can_change(material, "ior")


def changes_of_material(
    imgui: Any, scene: "Scene", material: Material
) -> dict[str, Any]:
    """Draw the widgets of ``material``, and say what a person changes.

    ``material`` is as it was loaded; what is shown is what it is now. What
    its shader cannot draw is shown and cannot be changed; the pointer over
    it is told why.
    """
    now = scene.material_now(material)
    changes = _base_colour(imgui, now)
    for slider in _sliders(material):
        value = getattr(now, slider.field)
        is_free = can_change(material, slider.field)
        imgui.begin_disabled(not is_free)
        changed, wanted = imgui.slider_float(
            slider.label, value, slider.least, slider.most, slider.text
        )
        imgui.end_disabled()
        _explain(imgui, slider.field, is_free=is_free)
        if changed:
            changes[slider.field] = _within(slider.field, wanted)
    if _has_specular(material):
        changed, colour = _colour(
            imgui, "specular colour", now.specular_colour_factor
        )
        if changed:
            changes["specular_colour_factor"] = colour
    if not material.unlit:
        is_free = can_change(material, "emissive_factor")
        imgui.begin_disabled(not is_free)
        changes |= _emission(imgui, now)
        imgui.end_disabled()
        _explain(imgui, "emissive_factor", is_free=is_free)
    if now is not material and imgui.button("as loaded"):
        changes = {
            field: getattr(material, field)
            for field in material_numbers(material)
        }
    return changes


def _base_colour(imgui: Any, now: Material) -> dict[str, Any]:
    """Linear, as it is in the file; with alpha where that is seen."""
    factor = list(now.base_colour_factor)
    flags = imgui.ColorEditFlags_.float
    if now.alpha_mode is AlphaMode.OPAQUE:
        changed, colour = imgui.color_edit3("base colour", factor[:3], flags)
        colour = [*colour[:3], factor[3]]
    else:
        flags |= imgui.ColorEditFlags_.alpha_preview_half
        changed, colour = imgui.color_edit4("base colour", factor, flags)
    if not changed:
        return {}
    return {"base_colour_factor": _within("base_colour_factor", colour)}


def _emission(imgui: Any, now: Material) -> dict[str, Any]:
    """Its colour, and how often that (KHR_materials_emissive_strength)."""
    strength = max(now.emissive_factor)
    colour = [each / (strength or 1.0) for each in now.emissive_factor]
    recoloured, wanted = imgui.color_edit3(
        "emission", colour, imgui.ColorEditFlags_.float
    )
    scaled, wanted_strength = imgui.slider_float(
        "strength",
        strength,
        0.0,
        _MOST_EMISSION,
        "%.3f",
        imgui.SliderFlags_.logarithmic,
    )
    if not (recoloured or scaled):
        return {}
    if scaled and strength == 0.0:
        wanted = (1.0, 1.0, 1.0)  # Of black there is no more.
    emission = [(wanted_strength or 1e-3) * each for each in wanted]
    return {"emissive_factor": _within("emissive_factor", emission)}


def _colour(
    imgui: Any, label: str, value: tuple[float, ...]
) -> tuple[bool, Any]:
    changed, colour = imgui.color_edit3(
        label,
        list(value),
        imgui.ColorEditFlags_.float | imgui.ColorEditFlags_.hdr,
    )
    return changed, tuple(max(each, 0.0) for each in colour)


def _within(field: str, value: Any) -> Any:
    """What a person typed, where it means something."""
    _, least, most = NUMBERS[field]
    clipped = np.clip(value, least, most).tolist()
    return tuple(clipped) if isinstance(clipped, list) else clipped


def _explain(imgui: Any, field: str, *, is_free: bool) -> None:
    if not is_free:
        hint(imgui, _REASONS.get(field, "The shader has no use for it."))
