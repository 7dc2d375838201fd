"""What a context's driver can do, as far as moka acts on it."""

from moka.backend.contexts import GraphicsContext
from moka.backend.protocol import BackendInfo

__all__ = ["read_info"]


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
        max_samples=info["GL_MAX_SAMPLES"],
        max_texture_size=info["GL_MAX_TEXTURE_SIZE"],
        max_uniform_block_size=info["GL_MAX_UNIFORM_BLOCK_SIZE"],
        uniform_alignment=info["GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT"],
        max_texture_units=info["GL_MAX_TEXTURE_IMAGE_UNITS"],
        clip_control=clip_control
        and (version >= 450 or "GL_ARB_clip_control" in extensions),
        multi_draw_indirect=multi_draw and base_instance and indirect,
    )
