"""Print a script that completes commands, options and files in a shell."""

import argparse
from collections.abc import Mapping
from pathlib import Path

from moka.core.errors import OptionError

__all__ = ["add_arguments", "execute"]

SHELLS = ("bash", "zsh", "fish")

# What stands for a file in the help of an argument that is not a Path.
_FILES = ("MODEL", "PATH|NAME")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka completion``."""
    parser.add_argument(
        "shell",
        choices=SHELLS,
        help="where the script goes, bash: ~/.local/share/bash-completion/"
        "completions/moka; zsh: _moka in a folder of $fpath; fish: "
        "~/.config/fish/completions/moka.fish",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print the script, made from the parsers of all commands."""
    try:
        import shtab
    except ImportError as error:
        raise OptionError(
            "completion needs the package shtab: "
            "pip install 'moka-pbr[completion]'"
        ) from error
    from moka.cli.main import full_parser

    parser = full_parser()
    _mark(parser, shtab.FILE, _values())
    print(shtab.complete(parser, shell=arguments.shell))
    return 0


def _values() -> dict[str, tuple[str, ...]]:
    """The names that an option takes which its parser does not know."""
    from moka.renderer import quality, settings

    return {
        "brdf": settings.BRDFS,
        "diffuse": settings.DIFFUSE_MODELS,
        "ibl": settings.IBL_MODES,
        "irradiance": settings.IRRADIANCE,
        "mip_filter": settings.MIP_FILTERS,
        "quality": tuple(quality.QUALITIES),
        "reflections": settings.REFLECTIONS,
        "shading": settings.SHADINGS,
        "tone_map": settings.TONE_MAPS,
    }


def _mark(
    parser: argparse.ArgumentParser,
    file: object,
    values: Mapping[str, tuple[str, ...]],
) -> None:
    """Say of all arguments which are files, and which names they take."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                _mark(command, file, values)
            continue
        if action.type is Path or action.metavar in _FILES:
            action.complete = file  # type: ignore[attr-defined]
        if action.choices is None and action.nargs != 0:
            action.choices = values.get(action.dest)
