"""GL enumerants, and how moka's descriptors map to them."""

from moka.commands.descriptors import (
    BlendState,
    CompareFunction,
    CullMode,
    Filter,
    IndexType,
    MipmapMode,
    PixelFormat,
    Topology,
    Wrap,
)

ACTIVE_ATTRIBUTES = 0x8B89
ACTIVE_ATTRIBUTE_MAX_LENGTH = 0x8B8A
ACTIVE_UNIFORMS = 0x8B86
ACTIVE_UNIFORM_BLOCKS = 0x8A36
ACTIVE_UNIFORM_BLOCK_MAX_NAME_LENGTH = 0x8A35
ACTIVE_UNIFORM_MAX_LENGTH = 0x8B87
ALREADY_SIGNALED = 0x911A
ARRAY_BUFFER = 0x8892
BACK = 0x0405
BYTE = 0x1400
BLEND = 0x0BE2
CCW = 0x0901
CLAMP_TO_EDGE = 0x812F
COLOR = 0x1800
COLOR_ATTACHMENT0 = 0x8CE0
COLOR_BUFFER_BIT = 0x4000
CULL_FACE = 0x0B44
CONDITION_SATISFIED = 0x911C
COMPILE_STATUS = 0x8B81
CW = 0x0900
DEPTH = 0x1801
DEPTH_ATTACHMENT = 0x8D00
DEPTH_COMPONENT = 0x1902
DEPTH_TEST = 0x0B71
DRAW_FRAMEBUFFER = 0x8CA9
DRAW_INDIRECT_BUFFER = 0x8F3F
DYNAMIC_DRAW = 0x88E8
ELEMENT_ARRAY_BUFFER = 0x8893
FILL = 0x1B02
FLOAT = 0x1406
FRAGMENT_SHADER = 0x8B30
FRAMEBUFFER = 0x8D40
FRAMEBUFFER_COMPLETE = 0x8CD5
FRAMEBUFFER_SRGB = 0x8DB9
FRONT = 0x0404
FRONT_AND_BACK = 0x0408
FUNC_ADD = 0x8006
HALF_FLOAT = 0x140B
INFO_LOG_LENGTH = 0x8B84
LINE = 0x1B01
LINEAR = 0x2601
LINK_STATUS = 0x8B82
LOWER_LEFT = 0x8CA1
NEAREST = 0x2600
NONE = 0
PACK_ALIGNMENT = 0x0D05
PIXEL_PACK_BUFFER = 0x88EB
PROGRAM_POINT_SIZE = 0x8642
QUERY_RESULT = 0x8866
QUERY_RESULT_AVAILABLE = 0x8867
READ_FRAMEBUFFER = 0x8CA8
SAMPLE_ALPHA_TO_COVERAGE = 0x809E
SCISSOR_TEST = 0x0C11
SHORT = 0x1402
SYNC_FLUSH_COMMANDS_BIT = 0x1
SYNC_GPU_COMMANDS_COMPLETE = 0x9117
TEXTURE0 = 0x84C0
TEXTURE_2D = 0x0DE1
TEXTURE_2D_MULTISAMPLE = 0x9100
TEXTURE_BASE_LEVEL = 0x813C
TEXTURE_BUFFER = 0x8C2A
TEXTURE_CUBE_MAP = 0x8513
TEXTURE_CUBE_MAP_POSITIVE_X = 0x8515
TEXTURE_CUBE_MAP_SEAMLESS = 0x884F
TEXTURE_MAG_FILTER = 0x2800
TEXTURE_MAX_ANISOTROPY = 0x84FE
TEXTURE_MAX_LEVEL = 0x813D
TEXTURE_MIN_FILTER = 0x2801
TEXTURE_WRAP_S = 0x2802
TEXTURE_WRAP_T = 0x2803
TIMESTAMP = 0x8E28
UNIFORM_BUFFER = 0x8A11
TIMEOUT_EXPIRED = 0x911B
UNIFORM_BLOCK_ACTIVE_UNIFORMS = 0x8A42
UNIFORM_BLOCK_DATA_SIZE = 0x8A40
UNIFORM_BLOCK_INDEX = 0x8A3A
UNPACK_ALIGNMENT = 0x0CF5
UNSIGNED_BYTE = 0x1401
UNSIGNED_INT = 0x1405
UNSIGNED_SHORT = 0x1403
VERTEX_SHADER = 0x8B31
ZERO_TO_ONE = 0x935F

TOPOLOGY = {
    Topology.POINTS: 0,
    Topology.LINES: 1,
    Topology.LINE_LOOP: 2,
    Topology.LINE_STRIP: 3,
    Topology.TRIANGLES: 4,
    Topology.TRIANGLE_STRIP: 5,
    Topology.TRIANGLE_FAN: 6,
}

INDEX_TYPE = {
    IndexType.UINT8: UNSIGNED_BYTE,
    IndexType.UINT16: UNSIGNED_SHORT,
    IndexType.UINT32: UNSIGNED_INT,
}

COMPARE = {
    CompareFunction.LESS: 0x0201,
    CompareFunction.LESS_EQUAL: 0x0203,
    CompareFunction.EQUAL: 0x0202,
    CompareFunction.GREATER: 0x0204,
    CompareFunction.GREATER_EQUAL: 0x0206,
    CompareFunction.ALWAYS: 0x0207,
}

CULL = {CullMode.BACK: BACK, CullMode.FRONT: FRONT}

# Source and destination factors for colour, then for alpha. Alpha is
# coverage, so it always accumulates as "over".
_ONE = 1
_SRC_ALPHA = 0x0302
_ONE_MINUS_SRC_ALPHA = 0x0303
BLEND_FACTORS = {
    BlendState.PREMULTIPLIED: (
        _ONE,
        _ONE_MINUS_SRC_ALPHA,
        _ONE,
        _ONE_MINUS_SRC_ALPHA,
    ),
    BlendState.ALPHA: (
        _SRC_ALPHA,
        _ONE_MINUS_SRC_ALPHA,
        _ONE,
        _ONE_MINUS_SRC_ALPHA,
    ),
    BlendState.ADDITIVE: (_ONE, _ONE, _ONE, _ONE),
}

WRAP = {
    Wrap.REPEAT: 0x2901,
    Wrap.MIRRORED_REPEAT: 0x8370,
    Wrap.CLAMP_TO_EDGE: CLAMP_TO_EDGE,
}

MAGNIFY = {Filter.NEAREST: NEAREST, Filter.LINEAR: LINEAR}

MINIFY = {
    (Filter.NEAREST, MipmapMode.NONE): NEAREST,
    (Filter.LINEAR, MipmapMode.NONE): LINEAR,
    (Filter.NEAREST, MipmapMode.NEAREST): 0x2700,
    (Filter.LINEAR, MipmapMode.NEAREST): 0x2701,
    (Filter.NEAREST, MipmapMode.LINEAR): 0x2702,
    (Filter.LINEAR, MipmapMode.LINEAR): 0x2703,
}

_RED, _RG, _RGB, _RGBA = 0x1903, 0x8227, 0x1907, 0x1908
_BY_CHANNELS = {1: _RED, 2: _RG, 3: _RGB, 4: _RGBA}
_INTEGER_BY_CHANNELS = {1: 0x8D94, 4: 0x8D99}
#: By NumPy's type codes, of texels and of vertex attributes.
COMPONENT_TYPE = {
    "i1": BYTE,
    "u1": UNSIGNED_BYTE,
    "i2": SHORT,
    "u2": UNSIGNED_SHORT,
    "f2": HALF_FLOAT,
    "f4": FLOAT,
    "u4": UNSIGNED_INT,
}
_INTERNAL = {
    PixelFormat.R8: 0x8229,
    PixelFormat.RG8: 0x822B,
    PixelFormat.RGB8: 0x8051,
    PixelFormat.RGBA8: 0x8058,
    PixelFormat.SRGB8: 0x8C41,
    PixelFormat.SRGB8_ALPHA8: 0x8C43,
    PixelFormat.R16: 0x822A,
    PixelFormat.RG16: 0x822C,
    PixelFormat.RGB16: 0x8054,
    PixelFormat.RGBA16: 0x805B,
    PixelFormat.R16F: 0x822D,
    PixelFormat.RG16F: 0x822F,
    PixelFormat.RGB16F: 0x881B,
    PixelFormat.RGBA16F: 0x881A,
    PixelFormat.R32F: 0x822E,
    PixelFormat.RG32F: 0x8230,
    PixelFormat.RGB32F: 0x8815,
    PixelFormat.RGBA32F: 0x8814,
    PixelFormat.R16UI: 0x8234,
    PixelFormat.R32UI: 0x8236,
    PixelFormat.RGBA32UI: 0x8D70,
    PixelFormat.DEPTH24: 0x81A6,
    PixelFormat.DEPTH32F: 0x8CAC,
    PixelFormat.BC1: 0x83F0,
    PixelFormat.BC1_SRGB: 0x8C4C,
    PixelFormat.BC3: 0x83F3,
    PixelFormat.BC3_SRGB: 0x8C4F,
    PixelFormat.BC7: 0x8E8C,
    PixelFormat.BC7_SRGB: 0x8E8D,
    PixelFormat.ETC2_RGB: 0x9274,
    PixelFormat.ETC2_RGB_SRGB: 0x9275,
    PixelFormat.ETC2_RGBA: 0x9278,
    PixelFormat.ETC2_RGBA_SRGB: 0x9279,
    PixelFormat.ASTC_4X4: 0x93B0,
    PixelFormat.ASTC_4X4_SRGB: 0x93D0,
}


def pixel_format(pixels: PixelFormat) -> tuple[int, int, int]:
    """Internal format, transfer format and transfer type."""
    return (
        _INTERNAL[pixels],
        transfer_format(pixels),
        COMPONENT_TYPE[pixels.dtype],
    )


def transfer_format(pixels: PixelFormat) -> int:
    """Which channels host memory holds."""
    if pixels.is_depth:
        return DEPTH_COMPONENT
    if pixels.is_integer:
        return _INTEGER_BY_CHANNELS[pixels.channels]
    return _BY_CHANNELS[pixels.channels]


def readback_format(channels: int, dtype: str) -> tuple[int, int]:
    """Transfer format and type of pixels read from a framebuffer."""
    if dtype == "u4":
        return _INTEGER_BY_CHANNELS[channels], UNSIGNED_INT
    return _BY_CHANNELS[channels], COMPONENT_TYPE[dtype]
