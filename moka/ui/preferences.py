"""What the viewer remembers from one time to the next, in a JSON file."""

import contextlib
import os
import sys
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from moka.core.atomic_file import atomic_file
from moka.core.log import get_logger

__all__ = [
    "MOST_RECENT",
    "Preferences",
    "load_preferences",
    "preferences_file",
    "save_preferences",
    "with_recent",
]

_LOGGER = get_logger(__name__)

#: How many files a list of recent ones holds.
MOST_RECENT = 10


class Preferences(Struct, frozen=True, kw_only=True):
    """The state of the window and the choices of the picture.

    ``open_panels`` are the titles of the panels that are open, None before
    anybody has opened or closed one. What is chosen on the command line
    comes before what is remembered.
    """

    size: tuple[int, int] = (1280, 720)
    shows_panels: bool = True
    open_panels: tuple[str, ...] | None = None
    environment: str = "studio"
    recent_environments: tuple[str, ...] = ()
    recent_models: tuple[str, ...] = ()
    environment_intensity: float = 1.0
    background_blur: float = 0.0
    exposure: float = 0.0
    tone_map: str = "neutral"
    gamma: float | None = None
    auto_rotates: bool = False


def preferences_file() -> Path:
    """Where they are kept.

    ``viewer.json`` in the folder that the environment variable
    MOKA_CONFIG_DIR names, else in ``moka`` where the system keeps settings:
    XDG_CONFIG_HOME or ~/.config, ~/Library/Application Support on macOS,
    APPDATA on Windows.
    """
    chosen = os.environ.get("MOKA_CONFIG_DIR")
    if chosen:
        return Path(chosen, "viewer.json")
    # By the standard a relative path is to be ignored.
    base = os.environ.get("XDG_CONFIG_HOME", "")
    if not os.path.isabs(base):
        home = os.path.expanduser("~")
        if sys.platform == "win32":
            base = os.environ.get("APPDATA") or home
        elif sys.platform == "darwin":
            base = os.path.join(home, "Library", "Application Support")
        else:
            base = os.path.join(home, ".config")
    return Path(base, "moka", "viewer.json")


def load_preferences(path: Path | None = None) -> Preferences:
    """What is remembered; the defaults where the file cannot be used."""
    path = preferences_file() if path is None else path
    try:
        found = msgspec.json.decode(path.read_bytes(), type=Preferences)
    except OSError:
        return Preferences()
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        _LOGGER.info("%s: is ignored: %s", path, error)
        return Preferences()
    return found if _is_usable(found) else Preferences()


def save_preferences(
    preferences: Preferences, path: Path | None = None
) -> None:
    """Write them, whole or not at all; who forbids it is not bothered."""
    path = preferences_file() if path is None else path
    text = msgspec.json.format(msgspec.json.encode(preferences))
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_file(path) as file:
            file.write_bytes(text + b"\n")


def with_recent(known: tuple[str, ...], path: Any) -> tuple[str, ...]:
    """``known`` with a file in front, absolute and once, not too many."""
    name = str(Path(path).absolute())
    return (name, *(each for each in known if each != name))[:MOST_RECENT]


def _is_usable(found: Preferences) -> bool:
    """Whether the picture can be made with what somebody may have typed."""
    from moka.core.errors import OptionError
    from moka.renderer.settings import RenderSettings

    try:
        RenderSettings(
            exposure=found.exposure,
            tone_map=found.tone_map,
            gamma=found.gamma,
        )
    except OptionError as error:
        _LOGGER.info("preferences: are ignored: %s", error)
        return False
    return (
        all(64 <= side <= 16384 for side in found.size)
        and 0.0 <= found.environment_intensity <= 1e30
        and 0.0 <= found.background_blur <= 1.0
    )
