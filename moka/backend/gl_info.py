"""What a context's driver can do, as far as moka acts on it."""

from collections.abc import Collection

from moka.backend.contexts import GraphicsContext
from moka.backend.protocol import BackendInfo
from moka.commands.descriptors import PixelFormat

__all__ = ["compressed_formats", "read_info"]

# Drivers that run on the CPU, by what their names hold.
_SOFTWARE = (
    "llvmpipe",
    "softpipe",
    "swrast",
    "swiftshader",
    "software",
    "basic render",
)

# The version of OpenGL or the extension that brings formats of blocks.
_COMPRESSED = (
    (420, "GL_ARB_texture_compression_bptc", ("bc7",)),
    (None, "GL_EXT_texture_compression_s3tc", ("bc1", "bc3")),
    (430, "GL_ARB_ES3_compatibility", ("etc2_rgb", "etc2_rgba")),
    (None, "GL_KHR_texture_compression_astc_ldr", ("astc_4x4",)),
)


def read_info(
    context: GraphicsContext, *, multi_draw: bool, clip_control: bool
) -> BackendInfo:
    """The facts; the arguments can leave abilities out."""
    ctx = context.gl
    info = ctx.info
    extensions = ctx.extensions
    version = ctx.version_code
    base_instance = version >= 420 or "GL_ARB_base_instance" in extensions
    indirect = version >= 430 or "GL_ARB_multi_draw_indirect" in extensions
    return BackendInfo(
        kind=context.kind,
        vendor=info["GL_VENDOR"],
        renderer=info["GL_RENDERER"],
        version=info["GL_VERSION"],
        max_samples=min(
            info["GL_MAX_COLOR_TEXTURE_SAMPLES"],
            info["GL_MAX_DEPTH_TEXTURE_SAMPLES"],
        ),
        max_integer_samples=info["GL_MAX_INTEGER_SAMPLES"],
        max_texture_size=info["GL_MAX_TEXTURE_SIZE"],
        max_buffer_texels=info["GL_MAX_TEXTURE_BUFFER_SIZE"],
        # 0 where the driver does not have the extension.
        max_anisotropy=max(1.0, ctx.max_anisotropy),
        max_uniform_block_size=info["GL_MAX_UNIFORM_BLOCK_SIZE"],
        uniform_alignment=info["GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT"],
        max_texture_units=info["GL_MAX_TEXTURE_IMAGE_UNITS"],
        clip_control=clip_control
        and (version >= 450 or "GL_ARB_clip_control" in extensions),
        multi_draw_indirect=multi_draw and base_instance and indirect,
        compressed_formats=compressed_formats(
            info["GL_RENDERER"], version, extensions
        ),
    )


def compressed_formats(
    renderer: str, version: int, extensions: Collection[str]
) -> frozenset[PixelFormat]:
    """The formats of blocks that are worth giving to a driver.

    None to one in software: every sample decodes its blocks anew. On
    llvmpipe two trilinear samples a pixel of a 2048 x 2048 texture take, as
    multiples of the time for sRGB texels of four bytes, 1.2 to 1.3 for BC1,
    1.4 to 1.5 for BC3 and 22 to 39 for BC7; ETC2 and ASTC it decodes when
    they are uploaded, in three to eight times the time.
    """
    if any(name in renderer.lower() for name in _SOFTWARE):
        return frozenset()
    found: set[str] = set()
    for since, extension, names in _COMPRESSED:
        in_core = since is not None and version >= since
        if in_core or extension in extensions:
            found.update(names)
    # sRGB came to S3TC with an extension of its own.
    if "GL_EXT_texture_sRGB" in extensions:
        srgb = found
    else:
        srgb = found - {"bc1", "bc3"}
    return frozenset(
        [PixelFormat(name) for name in found]
        + [PixelFormat(f"{name}_srgb") for name in srgb]
    )
