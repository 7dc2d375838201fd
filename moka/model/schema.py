"""The JSON of glTF 2.0 as typed structures, as far as moka reads it.

The JSON is decoded straight into these types, so that a wrong type, a
negative count or a missing field is found before anything is computed from
it, and the message names the JSON path. Objects of ``extensions`` stay plain
dictionaries; :func:`read_extension` types the ones that moka supports.

Source: glTF 2.0 specification, section 5 (properties reference).
"""

from functools import cache
from typing import Annotated, Any, Literal, TypeVar

import msgspec
from msgspec import Meta

from moka.core.errors import ModelError

__all__ = [
    "Accessor",
    "Asset",
    "Buffer",
    "BufferView",
    "Camera",
    "Document",
    "Image",
    "Index",
    "Material",
    "Mesh",
    "NormalTextureInfo",
    "OcclusionTextureInfo",
    "Orthographic",
    "PbrMetallicRoughness",
    "Perspective",
    "Primitive",
    "Sampler",
    "Scene",
    "Size",
    "Skin",
    "Sparse",
    "SparseIndices",
    "SparseValues",
    "Texture",
    "TextureInfo",
    "decode_document",
    "decode_part",
    "read_extension",
]

Index = Annotated[int, Meta(ge=0, le=2**31 - 1)]
# Sizes stay below 2^53, beyond which JSON numbers are not exact everywhere.
Size = Annotated[int, Meta(ge=0, le=2**53)]
Extensions = dict[str, Any]
Vector2 = tuple[float, float]
Vector3 = tuple[float, float, float]
Vector4 = tuple[float, float, float, float]
Matrix4 = Annotated[list[float], Meta(min_length=16, max_length=16)]
IndexType = Literal[5121, 5123, 5125]
ComponentType = Literal[5120, 5121, 5122, 5123, 5125, 5126]
AccessorType = Literal["SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"]
# Of ``extras`` that are not there; what they hold is decoded when asked for.
NOTHING = msgspec.Raw(b"null")
WrapMode = Literal[10497, 33071, 33648]


class Property(msgspec.Struct, rename="camel", gc=False, kw_only=True):
    """What every object of glTF may carry."""

    extensions: Extensions | None = None


class Asset(Property):
    version: str
    min_version: str | None = None


class Buffer(Property):
    byte_length: Size
    uri: str | None = None


class BufferView(Property):
    buffer: Index
    byte_length: Size
    byte_offset: Size = 0
    byte_stride: Size | None = None


class SparseIndices(Property):
    buffer_view: Index
    component_type: IndexType
    byte_offset: Size = 0


class SparseValues(Property):
    buffer_view: Index
    byte_offset: Size = 0


class Sparse(Property):
    count: Size
    indices: SparseIndices
    values: SparseValues


class Accessor(Property):
    component_type: ComponentType
    count: Size
    type: AccessorType
    buffer_view: Index | None = None
    byte_offset: Size = 0
    normalized: bool = False
    sparse: Sparse | None = None


class Primitive(Property):
    attributes: dict[str, Index]
    indices: Index | None = None
    material: Index | None = None
    mode: Literal[0, 1, 2, 3, 4, 5, 6] = 4
    targets: list[dict[str, Index]] = []


class Mesh(Property):
    primitives: list[Primitive]
    weights: list[float] = []
    name: str = ""

    @property
    def target_count(self) -> int:
        """Morph targets of the first primitive: all must have as many."""
        return len(self.primitives[0].targets) if self.primitives else 0


class Node(Property):
    children: list[Index] = []
    mesh: Index | None = None
    skin: Index | None = None
    camera: Index | None = None
    matrix: Matrix4 | None = None
    translation: Vector3 = (0.0, 0.0, 0.0)
    rotation: Vector4 = (0.0, 0.0, 0.0, 1.0)
    scale: Vector3 = (1.0, 1.0, 1.0)
    weights: list[float] = []
    name: str = ""
    extras: msgspec.Raw = NOTHING


class Skin(Property):
    joints: Annotated[list[Index], Meta(min_length=1)]
    inverse_bind_matrices: Index | None = None
    name: str = ""


class Scene(Property):
    nodes: list[Index] = []
    name: str = ""


class Perspective(Property):
    yfov: float
    znear: float
    aspect_ratio: float | None = None
    zfar: float | None = None


class Orthographic(Property):
    xmag: float
    ymag: float
    zfar: float
    znear: float


class Camera(Property):
    type: Literal["perspective", "orthographic"]
    perspective: Perspective | None = None
    orthographic: Orthographic | None = None
    name: str = ""


class Image(Property):
    uri: str | None = None
    buffer_view: Index | None = None


class Sampler(Property):
    mag_filter: Literal[9728, 9729] | None = None
    min_filter: Literal[9728, 9729, 9984, 9985, 9986, 9987] | None = None
    wrap_s: WrapMode = 10497
    wrap_t: WrapMode = 10497


class Texture(Property):
    source: Index | None = None
    sampler: Index | None = None


class TextureInfo(Property):
    index: Index
    tex_coord: Index = 0


class NormalTextureInfo(TextureInfo):
    scale: float = 1.0


class OcclusionTextureInfo(TextureInfo):
    strength: float = 1.0


class PbrMetallicRoughness(Property):
    base_color_factor: Vector4 = (1.0, 1.0, 1.0, 1.0)
    base_color_texture: TextureInfo | None = None
    metallic_factor: float = 1.0
    roughness_factor: float = 1.0
    metallic_roughness_texture: TextureInfo | None = None


class Material(Property):
    pbr_metallic_roughness: PbrMetallicRoughness | None = None
    normal_texture: NormalTextureInfo | None = None
    occlusion_texture: OcclusionTextureInfo | None = None
    emissive_texture: TextureInfo | None = None
    emissive_factor: Vector3 = (0.0, 0.0, 0.0)
    alpha_mode: Literal["OPAQUE", "MASK", "BLEND"] = "OPAQUE"
    alpha_cutoff: float = 0.5
    double_sided: bool = False
    name: str = ""
    extras: msgspec.Raw = NOTHING


class Document(Property):
    """A whole glTF file; what not every picture needs is decoded later."""

    asset: Asset
    extensions_used: list[str] = []
    extensions_required: list[str] = []
    accessors: list[Accessor] = []
    buffer_views: list[BufferView] = []
    buffers: list[Buffer] = []
    cameras: list[Camera] = []
    images: list[Image] = []
    materials: list[Material] = []
    meshes: list[Mesh] = []
    nodes: list[Node] = []
    samplers: list[Sampler] = []
    scene: Index | None = None
    scenes: list[Scene] = []
    textures: list[Texture] = []
    skins: list[Skin] = []
    animations: list[msgspec.Raw] = []


_Type = TypeVar("_Type")


@cache
def _decoder() -> msgspec.json.Decoder[Document]:
    return msgspec.json.Decoder(Document)


def decode_document(text: bytes | memoryview, where: str) -> Document:
    """Decode the JSON of a glTF file.

    Raises ModelError naming ``where`` and the JSON path, or the line, if the
    text is not JSON, not UTF-8 or not a glTF 2 document.
    """
    try:
        return _decoder().decode(text)
    except msgspec.ValidationError as error:
        raise _located(where, "", error) from error
    except UnicodeDecodeError as error:
        raise ModelError(f"{where}: the JSON is not UTF-8") from error
    except RecursionError as error:
        raise ModelError(f"{where}: the JSON is nested too deeply") from error
    except msgspec.DecodeError as error:
        from moka.model.json_fault import describe_fault

        fault = describe_fault(text, str(error))
        raise ModelError(f"{where}: {fault}") from error


def decode_part(
    raw: msgspec.Raw, type_: type[_Type], where: str, path: str
) -> _Type:
    """A part at JSON ``path`` that the document keeps undecoded.

    Raises ModelError when it does not look like ``type_``.
    """
    try:
        return msgspec.json.decode(raw, type=type_)
    except msgspec.ValidationError as error:
        raise _located(where, path, error) from error


def read_extension(
    owner: Property, name: str, type_: type[_Type], where: str, path: str
) -> _Type | None:
    """Extension ``name`` of ``owner`` as ``type_``, None if it has none.

    ``path`` is the owner's JSON path, for the ModelError that is raised when
    the extension does not look like ``type_``.
    """
    if owner.extensions is None or name not in owner.extensions:
        return None
    try:
        return msgspec.convert(owner.extensions[name], type_)
    except msgspec.ValidationError as error:
        dot = "." if path else ""
        prefix = f"{path}{dot}extensions.{name}"
        raise _located(where, prefix, error) from error


def _located(
    where: str, prefix: str, error: msgspec.ValidationError
) -> ModelError:
    """Turn "what - at `$.path`" into "where: path: what"."""
    what, _, path = str(error).partition(" - at `$")
    path = (prefix + path.rstrip("`")).lstrip(".")
    place = f"{where}: {path}: " if path else f"{where}: "
    return ModelError(place + _lower(what).replace("`", "'"))


def _lower(text: str) -> str:
    """A sentence of msgspec as the middle of one of ours."""
    return text if text.startswith("JSON") else text[:1].lower() + text[1:]
