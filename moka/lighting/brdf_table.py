"""The table of a specular lobe's directional albedo, made on the GPU."""

from moka.commands.descriptors import (
    Attachment,
    PixelFormat,
    TextureDescriptor,
)
from moka.commands.handles import Handle
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.lighting.environment_maps import CUBE_SAMPLER

__all__ = ["TABLE", "TABLE_SAMPLER", "make_brdf_table"]

# Within 0.0028 of float64 quadrature at every texel and, where n.v is above
# 0.02, between them.
_SIZE = 128
_SAMPLES = 512

TABLE = TextureDescriptor(PixelFormat.RG32F, _SIZE, _SIZE, label="table")
TABLE_SAMPLER = CUBE_SAMPLER


def make_brdf_table(
    device: GraphicsDevice, passes: FullscreenPasses, brdf: str
) -> Handle:
    """Make the table of ``gltf``, ``karis`` or ``blinn-phong``.

    x is n.v, y is roughness, red the scale of f0, green that of f90.
    """
    from moka.lighting.preintegration_passes import PreintegrationPasses

    table = device.create_texture(TABLE)
    jobs = PreintegrationPasses(device, passes)
    jobs.draw(
        "brdf_table.frag",
        {
            f"MOKA_BRDF_{brdf.upper().replace('-', '_')}": 1,
            "MOKA_SAMPLE_COUNT": _SAMPLES,
            "MOKA_TABLE_SIZE": _SIZE,
        },
        Attachment(table),
    )
    jobs.run()
    return table
