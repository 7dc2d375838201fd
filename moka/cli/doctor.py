"""Say which OpenGL contexts work here and what is missing."""

import argparse
import platform
import re
from collections.abc import Iterator
from importlib import metadata
from typing import Any

from moka.core.errors import ContextError
from moka.version import __version__

__all__ = ["add_arguments", "execute", "format_report", "report", "run"]

_NO_CONTEXT = 2

# What moka uses beyond OpenGL 3.3: the extension, the version of OpenGL that
# includes it, and what it is for.
_EXTENSIONS = (
    ("GL_ARB_clip_control", 450, "reversed depth for distant scenes"),
    ("GL_ARB_multi_draw_indirect", 430, "many meshes in one call"),
    ("GL_ARB_texture_filter_anisotropic", 460, "sharper slanted textures"),
    ("GL_KHR_debug", 430, "messages of the driver with --debug"),
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka doctor``."""
    parser.add_argument(
        "--json", action="store_true", help="print JSON instead of text"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print the report; 0 if any context works and 2 otherwise."""
    return run(as_json=arguments.json)


def run(*, as_json: bool = False) -> int:
    """Print the report as text or JSON and return the exit code."""
    found = report()
    if as_json:
        import json

        print(json.dumps(found, indent=2))
    else:
        print(format_report(found))
    return 0 if found["chosen"] is not None else _NO_CONTEXT


def report() -> dict[str, Any]:
    """Try every backend on this thread and say what was found.

    ``contexts`` has one entry for each, in the order of the backend
    ``auto``; ``chosen`` is the label of the first that works, or None.
    """
    contexts = _contexts()
    working = (each["label"] for each in contexts if each["works"])
    return {
        "moka": __version__,
        "python": platform.python_version(),
        "platform": platform.platform(),
        "packages": _packages(""),
        "window_packages": _packages("window"),
        "devices": _devices(),
        "contexts": contexts,
        "chosen": next(working, None),
    }


def _contexts() -> list[dict[str, Any]]:
    from moka.backend.contexts import candidates

    found: list[dict[str, Any]] = []
    for candidate in candidates():
        entry: dict[str, Any] = {
            "backend": candidate.backend,
            "label": candidate.label,
        }
        try:
            with candidate.open() as context:
                description = context.describe()
                version = context.gl.version_code
                names = context.gl.extensions
        except ContextError as error:
            entry |= {"works": False}
            entry |= {"cause": str(error), "hint": candidate.hint}
        else:
            entry |= {"works": True, **description}
            entry["label"] = description["context"]
            entry["extensions"] = len(names)
            entry["uses"] = {
                name: version >= since or name in names
                for name, since, _ in _EXTENSIONS
            }
        found.append(entry)
    return found


def _devices() -> list[str]:
    """The EGL devices by number, none where EGL cannot list them."""
    from moka.backend.contexts import egl

    try:
        return [device.name for device in egl.list_devices()]
    except ContextError:
        return []


def _packages(extra: str) -> dict[str, str | None]:
    """Versions of what moka requires, None for what is not installed."""
    versions: dict[str, str | None] = {}
    for name in _requirements(extra):
        try:
            versions[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            versions[name] = None
    return versions


def _requirements(extra: str) -> Iterator[str]:
    """Names of the packages of an extra, or of moka itself for ``""``."""
    try:
        lines = metadata.requires("moka-pbr") or []
    except metadata.PackageNotFoundError:
        return  # run from a checkout that is not installed
    for line in lines:
        name = re.match(r"[\w.-]+", line)
        of = re.search(r"extra == ['\"](\w+)", line)
        if name is not None and (of.group(1) if of else "") == extra:
            yield name.group()


def format_report(found: dict[str, Any]) -> str:
    """The report for a person, without a newline at the end."""
    lines = [
        f"moka {found['moka']}, Python {found['python']}, {found['platform']}",
        *_package_lines("packages", found["packages"], "moka-pbr"),
        *_package_lines(
            "for a window", found["window_packages"], "moka-pbr[window]"
        ),
        "EGL devices: " + (", ".join(found["devices"]) or "none"),
        "contexts, in the order in which moka tries them:",
    ]
    for each in found["contexts"]:
        if each["works"]:
            lines.append(f"  {each['label']}: works, {each['version']}")
        else:
            lines.append(f"  {each['label']}: {each['cause']} ({each['hint']})")
    if found["chosen"] is None:
        return "\n".join([*lines, "moka cannot render here"])
    lines.append(f"moka renders with {found['chosen']}:")
    first = next(each for each in found["contexts"] if each["works"])
    lines += [
        f"  {name}: {first[name]}" for name in ("vendor", "renderer", "version")
    ]
    lines.append(f"  GLSL: {first['glsl']}")
    lines.append(f"  extensions: {first['extensions']}, moka can use")
    lines += [
        f"    {'yes' if first['uses'][name] else 'no ':3}  {name}: {purpose}"
        for name, _, purpose in _EXTENSIONS
    ]
    return "\n".join(lines)


def _package_lines(
    title: str, versions: dict[str, str | None], install: str
) -> Iterator[str]:
    present = [f"{name} {each}" for name, each in versions.items() if each]
    missing = [name for name, each in versions.items() if not each]
    if present:
        yield f"{title}: " + ", ".join(present)
    if missing:
        yield (
            f"{title}, missing: {', '.join(missing)} (pip install '{install}')"
        )
