"""Say what a glTF file holds and what of it moka does not draw."""

import argparse

__all__ = ["add_arguments", "execute"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka info``."""
    parser.add_argument("model", metavar="MODEL", help=".gltf or .glb file")
    parser.add_argument(
        "--json", action="store_true", help="print JSON instead of text"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print the description; raises ModelError for a broken file."""
    from moka.model import load_model
    from moka.model.inspect import describe, format_description

    description = describe(load_model(arguments.model))
    if arguments.json:
        import json

        print(json.dumps(description, indent=2))
    else:
        print(format_description(description))
    return 0
