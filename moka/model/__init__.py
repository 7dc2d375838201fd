"""glTF models: reading, writing, describing and making them.

Names are imported when they are first used (PEP 562), because a program
that only makes a sphere needs no JSON reader.
"""

from importlib import import_module

TYPE_CHECKING = False

if TYPE_CHECKING:
    from moka.model.accessors import AccessorReader as AccessorReader
    from moka.model.assemble import model_of as model_of
    from moka.model.cameras import CameraDescription as CameraDescription
    from moka.model.cameras import Orthographic as Orthographic
    from moka.model.cameras import Perspective as Perspective
    from moka.model.demo import demo_model as demo_model
    from moka.model.extensions import (
        SUPPORTED_EXTENSIONS as SUPPORTED_EXTENSIONS,
    )
    from moka.model.geometry import cube as cube
    from moka.model.geometry import quad as quad
    from moka.model.geometry import sphere as sphere
    from moka.model.inspect import describe as describe
    from moka.model.inspect import format_description as format_description
    from moka.model.lights import LightKind as LightKind
    from moka.model.lights import PunctualLight as PunctualLight
    from moka.model.load import load_model as load_model
    from moka.model.mesh import Mesh as Mesh
    from moka.model.mesh import Primitive as Primitive
    from moka.model.model import Model as Model
    from moka.model.nodes import NodeTree as NodeTree
    from moka.model.save import save_model as save_model
    from moka.model.tangents import with_tangents as with_tangents
    from moka.model.triangles import triangle_corners as triangle_corners
    from moka.model.triangles import with_flat_normals as with_flat_normals

__all__ = [
    "SUPPORTED_EXTENSIONS",
    "AccessorReader",
    "CameraDescription",
    "LightKind",
    "Mesh",
    "Model",
    "NodeTree",
    "Orthographic",
    "Perspective",
    "Primitive",
    "PunctualLight",
    "cube",
    "demo_model",
    "describe",
    "format_description",
    "load_model",
    "model_of",
    "quad",
    "save_model",
    "sphere",
    "triangle_corners",
    "with_flat_normals",
    "with_tangents",
]

_HOMES = {
    "SUPPORTED_EXTENSIONS": "extensions",
    "AccessorReader": "accessors",
    "CameraDescription": "cameras",
    "LightKind": "lights",
    "Mesh": "mesh",
    "Model": "model",
    "NodeTree": "nodes",
    "Orthographic": "cameras",
    "Perspective": "cameras",
    "Primitive": "mesh",
    "PunctualLight": "lights",
    "cube": "geometry",
    "demo_model": "demo",
    "describe": "inspect",
    "format_description": "inspect",
    "load_model": "load",
    "model_of": "assemble",
    "quad": "geometry",
    "save_model": "save",
    "sphere": "geometry",
    "triangle_corners": "triangles",
    "with_flat_normals": "triangles",
    "with_tangents": "tangents",
}


if not TYPE_CHECKING:  # or a checker would accept any name at all

    def __getattr__(name: str) -> object:
        home = _HOMES.get(name)
        if home is None:
            raise AttributeError(f"module {__name__!r} has no {name!r}")
        value = getattr(import_module(f"{__name__}.{home}"), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
