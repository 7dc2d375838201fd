"""The properties of every object of glTF 2.0, as a table.

Source: glTF 2.0 specification, section 5 (properties reference).
"""

from typing import Any

from msgspec import Struct

__all__ = ["OBJECTS", "Rule"]


class Rule(Struct, frozen=True):
    """What a property must be.

    ``kind`` is a type of JSON, ``index`` or ``list``; the elements of a list
    are described by ``of``, those of an object by its name in OBJECTS.
    ``to`` is the array of the document that an index points into, ``lengths``
    how long a list may be, ``above`` a limit that the value must exceed.
    """

    kind: str
    required: bool = False
    of: "Rule | None" = None
    name: str = ""
    to: str = ""
    least: float | None = None
    greatest: float | None = None
    above: float | None = None
    choices: tuple[Any, ...] = ()
    lengths: tuple[int, ...] = ()
    multiple: int = 0
    unique: bool = False
    pattern: str = ""


def _number(**limits: Any) -> Rule:
    return Rule("number", **limits)


def _integer(**limits: Any) -> Rule:
    return Rule("integer", **limits)


def _index(to: str, **more: Any) -> Rule:
    return Rule("index", to=to, **more)


def _object(name: str = "", **more: Any) -> Rule:
    return Rule("object", name=name, **more)


def _list(of: Rule, **more: Any) -> Rule:
    return Rule("list", of=of, **more)


def _vector(count: int, **limits: Any) -> Rule:
    return _list(_number(**limits), lengths=(count,))


def _indices(to: str, **more: Any) -> Rule:
    return _list(_index(to), unique=True, **more)


_STRING, _BOOLEAN = Rule("string"), Rule("boolean")
_SIZE = _integer(least=0)
_UNIT = _number(least=0, greatest=1)
_COUNT = _integer(required=True, least=1)
_NAMED = {"name": _STRING}
_TEXTURE = {"index": _index("textures", required=True), "texCoord": _SIZE}
_WRAP = Rule("integer", choices=(33071, 33648, 10497))
_COMPONENT = (5120, 5121, 5122, 5123, 5125, 5126)
_NAMES = _list(_STRING, unique=True)
_ARRAYS = {
    "accessors": "accessor",
    "animations": "animation",
    "buffers": "buffer",
    "bufferViews": "bufferView",
    "cameras": "camera",
    "images": "image",
    "materials": "material",
    "meshes": "mesh",
    "nodes": "node",
    "samplers": "sampler",
    "scenes": "scene",
    "skins": "skin",
    "textures": "texture",
}

OBJECTS: dict[str, dict[str, Rule]] = {
    "glTF": {
        "asset": _object("asset", required=True),
        "extensionsUsed": _NAMES,
        "extensionsRequired": _NAMES,
        "scene": _index("scenes"),
        **{key: _list(_object(name)) for key, name in _ARRAYS.items()},
    },
    "asset": {
        "version": Rule("string", required=True, pattern=r"[0-9]+\.[0-9]+"),
        "minVersion": Rule("string", pattern=r"[0-9]+\.[0-9]+"),
        "generator": _STRING,
        "copyright": _STRING,
    },
    "accessor": {
        **_NAMED,
        "bufferView": _index("bufferViews"),
        "byteOffset": _SIZE,
        "componentType": _integer(required=True, choices=_COMPONENT),
        "normalized": _BOOLEAN,
        "count": _COUNT,
        "type": Rule(
            "string",
            required=True,
            choices=(
                "SCALAR",
                "VEC2",
                "VEC3",
                "VEC4",
                "MAT2",
                "MAT3",
                "MAT4",
            ),
        ),
        # Of as many numbers as the type has components: see accessors.py.
        "min": _list(_number()),
        "max": _list(_number()),
        "sparse": _object("sparse"),
    },
    "sparse": {
        "count": _COUNT,
        "indices": _object("sparse indices", required=True),
        "values": _object("sparse values", required=True),
    },
    "sparse indices": {
        "bufferView": _index("bufferViews", required=True),
        "byteOffset": _SIZE,
        "componentType": _integer(required=True, choices=(5121, 5123, 5125)),
    },
    "sparse values": {
        "bufferView": _index("bufferViews", required=True),
        "byteOffset": _SIZE,
    },
    "animation": {
        **_NAMED,
        "channels": _list(_object("channel"), required=True),
        "samplers": _list(_object("animation sampler"), required=True),
    },
    "channel": {
        # Points into the samplers of its animation: see animations.py.
        "sampler": _index("", required=True),
        "target": _object("target", required=True),
    },
    "target": {
        "node": _index("nodes"),
        "path": Rule(
            "string",
            required=True,
            choices=("translation", "rotation", "scale", "weights", "pointer"),
        ),
    },
    "animation sampler": {
        "input": _index("accessors", required=True),
        "interpolation": Rule(
            "string", choices=("LINEAR", "STEP", "CUBICSPLINE")
        ),
        "output": _index("accessors", required=True),
    },
    "buffer": {**_NAMED, "uri": _STRING, "byteLength": _COUNT},
    "bufferView": {
        **_NAMED,
        "buffer": _index("buffers", required=True),
        "byteOffset": _SIZE,
        "byteLength": _COUNT,
        "byteStride": _integer(least=4, greatest=252, multiple=4),
        "target": _integer(choices=(34962, 34963)),
    },
    "camera": {
        **_NAMED,
        "type": Rule(
            "string", required=True, choices=("perspective", "orthographic")
        ),
        "perspective": _object("perspective"),
        "orthographic": _object("orthographic"),
    },
    "perspective": {
        "aspectRatio": _number(above=0),
        "yfov": _number(required=True, above=0),
        "zfar": _number(above=0),
        "znear": _number(required=True, above=0),
    },
    "orthographic": {
        "xmag": _number(required=True),
        "ymag": _number(required=True),
        "zfar": _number(required=True, above=0),
        "znear": _number(required=True, least=0),
    },
    "image": {
        **_NAMED,
        "uri": _STRING,
        "mimeType": _STRING,
        "bufferView": _index("bufferViews"),
    },
    "material": {
        **_NAMED,
        "pbrMetallicRoughness": _object("pbrMetallicRoughness"),
        "normalTexture": _object("normalTexture"),
        "occlusionTexture": _object("occlusionTexture"),
        "emissiveTexture": _object("textureInfo"),
        "emissiveFactor": _vector(3, least=0, greatest=1),
        "alphaMode": Rule("string", choices=("OPAQUE", "MASK", "BLEND")),
        "alphaCutoff": _number(least=0),
        "doubleSided": _BOOLEAN,
    },
    "pbrMetallicRoughness": {
        "baseColorFactor": _vector(4, least=0, greatest=1),
        "baseColorTexture": _object("textureInfo"),
        "metallicFactor": _UNIT,
        "roughnessFactor": _UNIT,
        "metallicRoughnessTexture": _object("textureInfo"),
    },
    "textureInfo": _TEXTURE,
    "normalTexture": {**_TEXTURE, "scale": _number()},
    "occlusionTexture": {**_TEXTURE, "strength": _UNIT},
    "mesh": {
        **_NAMED,
        "primitives": _list(_object("primitive"), required=True),
        "weights": _list(_number()),
    },
    "primitive": {
        "attributes": _object("attributes", required=True),
        "indices": _index("accessors"),
        "material": _index("materials"),
        "mode": _integer(least=0, greatest=6),
        "targets": _list(_object("attributes")),
    },
    "node": {
        **_NAMED,
        "camera": _index("cameras"),
        "children": _indices("nodes"),
        "skin": _index("skins"),
        "matrix": _vector(16),
        "mesh": _index("meshes"),
        "rotation": _vector(4, least=-1, greatest=1),
        "scale": _vector(3),
        "translation": _vector(3),
        "weights": _list(_number()),
    },
    "sampler": {
        **_NAMED,
        "magFilter": _integer(choices=(9728, 9729)),
        "minFilter": _integer(choices=(9728, 9729, 9984, 9985, 9986, 9987)),
        "wrapS": _WRAP,
        "wrapT": _WRAP,
    },
    "scene": {**_NAMED, "nodes": _indices("nodes")},
    "skin": {
        **_NAMED,
        "inverseBindMatrices": _index("accessors"),
        "skeleton": _index("nodes"),
        "joints": _indices("nodes", required=True),
    },
    "texture": {
        **_NAMED,
        "sampler": _index("samplers"),
        "source": _index("images"),
    },
}
