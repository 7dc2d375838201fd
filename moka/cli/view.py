"""Open a model in a window, to turn it around and to look into it."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from moka.cli.picture_options import add_picture_arguments, picture_request

if TYPE_CHECKING:
    from moka.ui.preferences import Preferences

__all__ = ["add_arguments", "execute"]

# What is as it was the last time where no option says otherwise.
_REMEMBERED = (
    "size",
    "environment",
    "environment_intensity",
    "background_blur",
    "exposure",
    "tone_map",
    "gamma",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka view``."""
    add_picture_arguments(parser)
    parser.set_defaults(**dict.fromkeys(_REMEMBERED))
    add = parser.add_argument
    add(
        "--fullscreen",
        action="store_true",
        help="fill the screen; F11 changes it",
    )
    add(
        "--no-preferences",
        action="store_true",
        help="neither use nor keep what was chosen in the window the last time",
    )
    add(
        "--no-cache",
        action="store_true",
        help="neither read nor write the disk cache of preintegrated "
        "lighting, see moka cache",
    )


def remember(arguments: argparse.Namespace, preferences: "Preferences") -> None:
    """Put what is remembered where no option was given."""
    from moka.lighting.environment import BUILT_IN

    for name in _REMEMBERED:
        if getattr(arguments, name) is None:
            setattr(arguments, name, getattr(preferences, name))
    environment = arguments.environment
    if (
        environment == preferences.environment
        and environment not in BUILT_IN
        and not Path(environment).is_file()
    ):
        # A file that is gone is no reason not to start.
        arguments.environment = BUILT_IN[0]


def execute(arguments: argparse.Namespace) -> int:
    """Show the viewer until it is closed."""
    from moka.ui.preferences import Preferences, load_preferences

    is_remembered = not arguments.no_preferences
    preferences = load_preferences() if is_remembered else Preferences()
    remember(arguments, preferences)
    request = picture_request(arguments)

    from moka.app.run import run
    from moka.ui.viewer import Viewer

    run(
        Viewer(request, preferences if is_remembered else None),
        size=request.size,
        title="moka",
        settings=request.settings,
        fullscreen=arguments.fullscreen,
        debug=arguments.debug,
        cache=not arguments.no_cache,
    )
    return 0
