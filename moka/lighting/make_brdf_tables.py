"""Makes the tables that :mod:`moka.lighting.brdf_table` reads.

    python -m moka.lighting.make_brdf_tables

To be run when a specular term in shaders/include/brdf.glsl changes; a test
says so if it is not.
"""

import numpy as np
from numpy.typing import NDArray

from moka.commands.descriptors import Attachment
from moka.graphics.device import GraphicsDevice
from moka.graphics.passes import FullscreenPasses
from moka.lighting.brdf_table import TABLE, TABLE_SIZE, table_path
from moka.lighting.preintegration_passes import PreintegrationPasses

__all__ = ["draw_brdf_table"]

BRDFS = ("gltf", "karis", "blinn-phong")

# Enough that what is left of the error is rounding to 16 bits.
_SAMPLES = 1 << 14


def draw_brdf_table(
    device: GraphicsDevice, brdf: str, samples: int = _SAMPLES
) -> NDArray[np.float32]:
    """The table (128, 128, 2), integrated on the GPU with ``samples``."""
    jobs = PreintegrationPasses(device, FullscreenPasses(device))
    texture = device.create_texture(TABLE)
    jobs.draw(
        "brdf_table.frag",
        {
            f"MOKA_BRDF_{brdf.upper().replace('-', '_')}": 1,
            "MOKA_SAMPLE_COUNT": samples,
            "MOKA_TABLE_SIZE": TABLE_SIZE,
        },
        [Attachment(texture)],
    )
    jobs.run()
    table: NDArray[np.float32] = device.read_texture(texture)[..., :2]
    device.destroy(texture)
    return table


def main() -> None:
    """Write all of them."""
    with GraphicsDevice.open() as device:
        for brdf in BRDFS:
            table = draw_brdf_table(device, brdf)
            path = table_path(brdf)
            np.rint(65535.0 * table).astype("<u2").tofile(path)
            print(path)


if __name__ == "__main__":
    main()
