"""Frozen descriptions of resources and state: what to make, never how.

Nothing here knows OpenGL; the backend translates. All are values: equal
descriptors mean equal resources, which is what caches rely on.
"""

from enum import Enum

from msgspec import Struct

from moka.commands.handles import Handle

__all__ = [
    "Attachment",
    "BindGroupDescriptor",
    "BlendState",
    "BufferDescriptor",
    "BufferUsage",
    "CompareFunction",
    "CullMode",
    "Filter",
    "FramebufferDescriptor",
    "IndexType",
    "MeshDescriptor",
    "MipmapMode",
    "PixelFormat",
    "ProgramDescriptor",
    "RasterState",
    "SamplerDescriptor",
    "ShaderText",
    "TextureBinding",
    "TextureDescriptor",
    "TextureKind",
    "Topology",
    "UniformBinding",
    "VertexAttribute",
    "VertexLayout",
    "Wrap",
]


class BufferUsage(Enum):
    """What a buffer is bound as."""

    VERTEX = "vertex"
    INDEX = "index"
    UNIFORM = "uniform"


class BufferDescriptor(Struct, frozen=True):
    """A buffer of ``size`` bytes; ``dynamic`` when rewritten every frame."""

    usage: BufferUsage
    size: int
    dynamic: bool = False
    label: str = ""


class PixelFormat(Enum):
    """Texel formats: channels, bits, encoding (F float, UI unsigned).

    BC1 to ASTC are blocks of 4 x 4 texels, which no shader draws into.
    """

    R8 = "r8"
    RG8 = "rg8"
    RGB8 = "rgb8"
    RGBA8 = "rgba8"
    SRGB8 = "srgb8"
    SRGB8_ALPHA8 = "srgb8_alpha8"
    R16 = "r16"
    RG16 = "rg16"
    RGB16 = "rgb16"
    RGBA16 = "rgba16"
    R16F = "r16f"
    RG16F = "rg16f"
    RGB16F = "rgb16f"
    RGBA16F = "rgba16f"
    R32F = "r32f"
    RG32F = "rg32f"
    RGB32F = "rgb32f"
    RGBA32F = "rgba32f"
    R16UI = "r16ui"
    R32UI = "r32ui"
    RGBA32UI = "rgba32ui"
    DEPTH24 = "depth24"
    DEPTH32F = "depth32f"
    BC1 = "bc1"
    BC1_SRGB = "bc1_srgb"
    BC3 = "bc3"
    BC3_SRGB = "bc3_srgb"
    BC7 = "bc7"
    BC7_SRGB = "bc7_srgb"
    ETC2_RGB = "etc2_rgb"
    ETC2_RGB_SRGB = "etc2_rgb_srgb"
    ETC2_RGBA = "etc2_rgba"
    ETC2_RGBA_SRGB = "etc2_rgba_srgb"
    ASTC_4X4 = "astc_4x4"
    ASTC_4X4_SRGB = "astc_4x4_srgb"

    @property
    def is_depth(self) -> bool:
        """Whether texels are depths and not colours."""
        return self in (PixelFormat.DEPTH24, PixelFormat.DEPTH32F)

    @property
    def is_integer(self) -> bool:
        """Whether shaders read whole numbers and not what they stand for."""
        return self.value.endswith("ui")

    @property
    def block_bytes(self) -> int:
        """Bytes of a block of 4 x 4 texels, 0 for formats without."""
        name = self.value
        if name.startswith(("bc1", "etc2_rgb_")) or name == "etc2_rgb":
            return 8
        return 16 if name.startswith(("bc", "etc2", "astc")) else 0

    @property
    def channels(self) -> int:
        """Channels per texel, 1 to 4."""
        if self.is_depth:
            return 1
        if self.block_bytes:
            return 3 if self.block_bytes == 8 else 4
        if self is PixelFormat.SRGB8_ALPHA8:
            return 4
        return len(self.value.removeprefix("s").rstrip("0123456789fui"))

    @property
    def dtype(self) -> str:
        """NumPy type of one channel in host memory."""
        name = self.value
        if name.endswith("16f"):
            return "f2"
        if name.endswith("32f") or self is PixelFormat.DEPTH24:
            return "f4"
        if name.endswith("32ui"):
            return "u4"
        return "u2" if name.endswith(("16", "16ui")) else "u1"


class TextureKind(Enum):
    """Shape of a texture."""

    TEXTURE_2D = "2d"
    CUBE = "cube"
    # One row of texels that is only read by their numbers: samplerBuffer.
    BUFFER = "buffer"


class TextureDescriptor(Struct, frozen=True):
    """A texture of ``levels`` mip levels (0 means the whole chain).

    A buffer texture has one level and one row of ``width`` texels, which are
    those of the buffer ``over`` or else of one of its own. With
    ``samples`` > 1 it has one level and is only written by draws; shaders
    read it as ``sampler2DMS``.
    """

    format: PixelFormat
    width: int
    height: int
    kind: TextureKind = TextureKind.TEXTURE_2D
    levels: int = 1
    samples: int = 1
    label: str = ""
    over: Handle | None = None

    @property
    def level_count(self) -> int:
        """Number of mip levels, at least 1."""
        return self.levels or max(self.width, self.height).bit_length()

    def level_size(self, level: int) -> tuple[int, int]:
        """Width and height of mip level ``level``."""
        return max(1, self.width >> level), max(1, self.height >> level)

    def level_shape(self, level: int) -> tuple[int, int, int]:
        """Shape of a level's data: rows, columns, channels of texels.

        For formats of blocks these are rows and columns of blocks, and the
        bytes of each.
        """
        width, height = self.level_size(level)
        if self.format.block_bytes:
            return -(-height // 4), -(-width // 4), self.format.block_bytes
        return height, width, self.format.channels


class Wrap(Enum):
    """How texture coordinates outside 0..1 are read."""

    REPEAT = "repeat"
    MIRRORED_REPEAT = "mirrored_repeat"
    CLAMP_TO_EDGE = "clamp_to_edge"


class Filter(Enum):
    """How texels of one level are combined."""

    NEAREST = "nearest"
    LINEAR = "linear"


class MipmapMode(Enum):
    """How mip levels are chosen; NONE reads level 0 only."""

    NONE = "none"
    NEAREST = "nearest"
    LINEAR = "linear"


class SamplerDescriptor(Struct, frozen=True):
    """How a texture is sampled. The default is glTF's: repeat, trilinear."""

    wrap_s: Wrap = Wrap.REPEAT
    wrap_t: Wrap = Wrap.REPEAT
    magnify: Filter = Filter.LINEAR
    minify: Filter = Filter.LINEAR
    mipmap: MipmapMode = MipmapMode.LINEAR
    anisotropy: float = 1.0


class VertexAttribute(Struct, frozen=True):
    """One attribute in an interleaved vertex.

    ``type`` is a NumPy type code (``f4``, ``f2``, ``u1``, ``u2``, ``i1``,
    ``i2``, ``u4``); integers reach the shader as floats, divided by their
    range if ``normalised``.
    """

    name: str
    type: str
    components: int
    offset: int
    normalised: bool = False


class VertexLayout(Struct, frozen=True):
    """The attributes of an interleaved vertex of ``stride`` bytes."""

    attributes: tuple[VertexAttribute, ...]
    stride: int


class IndexType(Enum):
    """Width of an index; the value is its NumPy type."""

    UINT8 = "u1"
    UINT16 = "u2"
    UINT32 = "u4"


class Topology(Enum):
    """How vertices form primitives; the values are glTF's mode names."""

    POINTS = "points"
    LINES = "lines"
    LINE_LOOP = "line_loop"
    LINE_STRIP = "line_strip"
    TRIANGLES = "triangles"
    TRIANGLE_STRIP = "triangle_strip"
    TRIANGLE_FAN = "triangle_fan"


class MeshDescriptor(Struct, frozen=True):
    """A range of a vertex buffer, read through an index buffer or not.

    ``first`` and ``count`` are indices (vertices without an index buffer);
    ``base_vertex`` is added to every index, so that many meshes can share
    one pair of buffers. Without a vertex buffer the vertex shader makes its
    vertices from ``gl_VertexID``.
    """

    topology: Topology
    count: int
    first: int = 0
    base_vertex: int = 0
    vertex_buffer: Handle | None = None
    layout: VertexLayout | None = None
    index_buffer: Handle | None = None
    index_type: IndexType = IndexType.UINT32


class ShaderText(Struct, frozen=True):
    """Preprocessed GLSL and the names of the files its ``#line`` count.

    File ``n`` of a ``#line l n`` directive is ``files[n]``.
    """

    source: str
    files: tuple[str, ...] = ()


class ProgramDescriptor(Struct, frozen=True):
    """A vertex and a fragment shader linked together."""

    vertex: ShaderText
    fragment: ShaderText
    label: str = ""


class Attachment(Struct, frozen=True):
    """One mip level of a texture, and for cubes one face (+X -X +Y .. -Z)."""

    texture: Handle
    level: int = 0
    face: int = 0


class FramebufferDescriptor(Struct, frozen=True):
    """Where draws go: colour attachments in output order, and depth."""

    colour: tuple[Attachment, ...]
    depth: Attachment | None = None
    label: str = ""


class CullMode(Enum):
    """Which faces are not drawn."""

    NONE = "none"
    BACK = "back"
    FRONT = "front"


class CompareFunction(Enum):
    """When a fragment passes the depth test."""

    LESS = "less"
    LESS_EQUAL = "less_equal"
    EQUAL = "equal"
    GREATER = "greater"
    GREATER_EQUAL = "greater_equal"
    ALWAYS = "always"


class BlendState(Enum):
    """How a fragment is combined with what is there; alpha is coverage."""

    PREMULTIPLIED = "premultiplied"
    ALPHA = "alpha"
    ADDITIVE = "additive"


class RasterState(Struct, frozen=True):
    """Everything fixed about a draw; nothing is inherited from the last."""

    cull: CullMode = CullMode.BACK
    front_clockwise: bool = False
    depth_test: CompareFunction | None = CompareFunction.LESS_EQUAL
    depth_write: bool = True
    blend: BlendState | None = None
    colour_write: bool = True
    wireframe: bool = False
    alpha_to_coverage: bool = False


class TextureBinding(Struct, frozen=True):
    """A texture and its sampler for the sampler uniform ``name``.

    With ``level`` that one mip level is all there is, as level 0: so a pass
    can read one level of a texture while it draws into another.
    """

    name: str
    texture: Handle
    sampler: SamplerDescriptor = SamplerDescriptor()
    level: int | None = None


class UniformBinding(Struct, frozen=True):
    """A range of a uniform buffer for the block ``name``; size 0 = all."""

    name: str
    buffer: Handle
    offset: int = 0
    size: int = 0


class BindGroupDescriptor(Struct, frozen=True):
    """Textures and uniform blocks that a program reads, bound together."""

    textures: tuple[TextureBinding, ...] = ()
    uniforms: tuple[UniformBinding, ...] = ()
