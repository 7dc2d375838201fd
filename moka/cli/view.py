"""Open a model in a window, to turn it around and to look into it."""

import argparse

from moka.cli.picture_options import add_picture_arguments, picture_request

__all__ = ["add_arguments", "execute"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka view``."""
    add_picture_arguments(parser)
    add = parser.add_argument
    add(
        "--fullscreen",
        action="store_true",
        help="fill the screen; F11 changes it",
    )
    add(
        "--no-cache",
        action="store_true",
        help="neither read nor write the disk cache of preintegrated "
        "lighting, see moka cache",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Show the viewer until it is closed."""
    request = picture_request(arguments)

    from moka.app.run import run
    from moka.ui.viewer import Viewer

    run(
        Viewer(request),
        size=request.size,
        title="moka",
        settings=request.settings,
        fullscreen=arguments.fullscreen,
        debug=arguments.debug,
        cache=not arguments.no_cache,
    )
    return 0
