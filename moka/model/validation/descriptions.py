"""The asset, extensions, cameras, lights and materials."""

from typing import Any

from moka.model.extensions import SUPPORTED_EXTENSIONS
from moka.model.validation.context import CheckedFile
from moka.model.validation.issues import Place, Severity

__all__ = [
    "check_asset",
    "check_cameras",
    "check_extensions",
    "check_lights",
    "check_materials",
]

_LIGHTS = "KHR_lights_punctual"


def check_asset(file: CheckedFile) -> bool:
    """Check the version; whether the rest can be judged by glTF 2's rules."""
    asset = file.document.get("asset")
    asset = asset if isinstance(asset, dict) else {}
    version = _version(asset.get("version"))
    least = _version(asset.get("minVersion"))
    if version is None:
        return True
    if version[0] != 2:
        file.add(
            "UNKNOWN_ASSET_MAJOR_VERSION",
            ("asset", "version"),
            f"is {asset['version']}; these are the rules of 2.0",
        )
        return False
    if version[1] > 0:
        file.add(
            "UNKNOWN_ASSET_MINOR_VERSION",
            ("asset", "version"),
            f"is {asset['version']}; these are the rules of 2.0",
        )
    if least is not None and least > version:
        file.add(
            "ASSET_MIN_VERSION_GREATER_THAN_VERSION",
            ("asset", "minVersion"),
            f"is {asset['minVersion']}, above {asset['version']}",
        )
    return True


def check_extensions(file: CheckedFile) -> None:
    """Extensions are declared where they are used, and known if required."""
    document = file.document
    used, required = (
        value if isinstance(value, list) else []
        for value in (
            document.get("extensionsUsed"),
            document.get("extensionsRequired"),
        )
    )
    if required and "extensionsUsed" not in document:
        file.add(
            "UNSATISFIED_DEPENDENCY",
            ("extensionsRequired",),
            "needs extensionsUsed beside it",
        )
    for number, name in enumerate(required):
        if name not in used:
            file.add(
                "UNUSED_EXTENSION_REQUIRED",
                ("extensionsRequired", number),
                f"{name} is not in extensionsUsed",
            )
    for number, name in enumerate(used):
        if name not in SUPPORTED_EXTENSIONS:
            is_required = name in required
            file.report.add(
                "UNSUPPORTED_EXTENSION",
                ("extensionsUsed", number),
                f"moka does not draw {name}"
                + (", which the file requires" if is_required else ""),
                Severity.ERROR if is_required else None,
            )
    for place, name in _extensions(document, ()):
        if name not in used:
            file.add(
                "UNDECLARED_EXTENSION",
                place,
                f"{name} is not in extensionsUsed",
            )


def _extensions(value: Any, place: Place) -> list[tuple[Place, str]]:
    """Every extension object below ``value``, without recursion."""
    found: list[tuple[Place, str]] = []
    waiting: list[tuple[Any, Place]] = [(value, place)]
    while waiting:
        value, place = waiting.pop()
        if isinstance(value, list):
            # Numbers and indices hold no objects.
            if value and isinstance(value[0], dict | list):
                waiting += [(e, (*place, i)) for i, e in enumerate(value)]
        elif isinstance(value, dict):
            for key, each in value.items():
                if key == "extensions" and isinstance(each, dict):
                    found += [((*place, key, name), name) for name in each]
                if key != "extras" and isinstance(each, dict | list):
                    waiting.append((each, (*place, key)))
    return found


def check_cameras(file: CheckedFile) -> None:
    """Near before far, and a field of view."""
    for number, camera in file.all("cameras"):
        place: Place = ("cameras", number)
        kind = camera.get("type")
        if kind in ("perspective", "orthographic") and kind not in camera:
            file.add(
                "UNDEFINED_PROPERTY", place, f"needs the property {kind!r}"
            )
        for name in ("perspective", "orthographic"):
            lens = camera.get(name)
            if not isinstance(lens, dict):
                continue
            where = (*place, name)
            near, far = _number(lens, "znear"), _number(lens, "zfar")
            if near is not None and far is not None and far <= near:
                file.add(
                    "CAMERA_ZFAR_LEQUAL_ZNEAR",
                    where,
                    f"zfar {far} must exceed znear {near}",
                )
            yfov = _number(lens, "yfov")
            if yfov is not None and yfov >= 3.141592653589793:
                file.add(
                    "CAMERA_YFOV_GEQUAL_PI", where, f"yfov is {yfov} radians"
                )
            for size in ("xmag", "ymag"):
                if _number(lens, size) == 0:
                    file.add(
                        "CAMERA_XMAG_YMAG_ZERO",
                        (*where, size),
                        "must not be zero",
                    )


def check_lights(file: CheckedFile) -> None:
    """Lights exist where nodes place them, and spots have a cone."""
    lights = file.extension(file.document, _LIGHTS).get("lights")
    lights = lights if isinstance(lights, list) else []
    for number, light in enumerate(lights):
        place: Place = ("extensions", _LIGHTS, "lights", number)
        if not isinstance(light, dict):
            continue
        if "type" not in light:
            file.add("UNDEFINED_PROPERTY", place, "needs the property 'type'")
        spot = light.get("spot")
        if isinstance(spot, dict):
            inner = _number(spot, "innerConeAngle") or 0.0
            outer = _number(spot, "outerConeAngle")
            outer = 0.7853981633974483 if outer is None else outer
            if outer <= inner:
                file.add(
                    "KHR_LIGHTS_PUNCTUAL_LIGHT_SPOT_ANGLES",
                    (*place, "spot", "outerConeAngle"),
                    f"{outer} does not exceed innerConeAngle {inner}",
                )
    for number, node in file.all("nodes"):
        light = file.extension(node, _LIGHTS).get("light")
        if isinstance(light, int) and not 0 <= light < len(lights):
            file.add(
                "UNRESOLVED_REFERENCE",
                ("nodes", number, "extensions", _LIGHTS, "light"),
                f"there is no lights[{light}], the file has {len(lights)}",
            )


def check_materials(file: CheckedFile) -> None:
    """A cutoff belongs to a mask."""
    for number, material in file.all("materials"):
        masked = material.get("alphaMode", "OPAQUE") == "MASK"
        if "alphaCutoff" in material and not masked:
            file.add(
                "MATERIAL_ALPHA_CUTOFF_INVALID_MODE",
                ("materials", number, "alphaCutoff"),
                "has a meaning only for alphaMode MASK",
            )


def _version(value: Any) -> tuple[int, int] | None:
    if not isinstance(value, str):
        return None
    major, dot, minor = value.partition(".")
    if not (dot and major.isdecimal() and minor.isdecimal()):
        return None
    return int(major), int(minor)


def _number(owner: dict[str, Any], name: str) -> float | None:
    value = owner.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return value
