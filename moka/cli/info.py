"""Say what a glTF file holds, and what of it a picture needs."""

import argparse

from moka.core.option_text import name_or_index, size

__all__ = ["add_arguments", "execute"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``moka info``."""
    add = parser.add_argument
    add("model", metavar="MODEL", help=".gltf or .glb file")
    add("--json", action="store_true", help="print JSON instead of text")
    add(
        "--scene",
        metavar="SCENE",
        type=name_or_index,
        help="of the picture, as for moka render",
    )
    add(
        "--variant",
        metavar="VARIANT",
        type=name_or_index,
        help="of the picture, as for moka render",
    )
    add(
        "--camera",
        metavar="CAMERA",
        help="of the picture, as for moka render",
    )
    add(
        "--size",
        metavar="WxH",
        type=size,
        default=(1280, 720),
        help="of the picture in pixels (default: 1280x720)",
    )


def execute(arguments: argparse.Namespace) -> int:
    """Print the description; raises ModelError for a broken file."""
    from moka.model import load_model
    from moka.model.inspect import describe, format_description
    from moka.scene.picture_needs import format_needs, picture_needs

    model = load_model(arguments.model, scene=arguments.scene)
    description = describe(model)
    needs = picture_needs(
        model,
        variant=arguments.variant,
        camera=arguments.camera,
        size=arguments.size,
    )
    if arguments.json:
        import json

        print(json.dumps({**description, "picture": needs}, indent=2))
    else:
        print(format_description(description))
        print(format_needs(needs))
    return 0
