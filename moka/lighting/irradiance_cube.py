"""Irradiance as a small cube of E / pi, by samples of density n.l / pi."""

from moka.commands.descriptors import TextureBinding
from moka.commands.handles import Handle
from moka.lighting.environment_maps import SOURCE_SAMPLER
from moka.lighting.preintegration_passes import PreintegrationPasses
from moka.lighting.samples import cosine_samples, pack

__all__ = ["irradiance_cube"]

IRRADIANCE_SAMPLES = 512
IRRADIANCE_SIZE = 16


def irradiance_cube(
    passes: PreintegrationPasses, source: Handle, size: int
) -> Handle:
    """The cube, from ``source`` of ``size`` texels with all its levels."""
    cube = passes.cube(IRRADIANCE_SIZE)
    passes.cube_level(
        "prefilter_irradiance.frag",
        cube,
        0,
        IRRADIANCE_SIZE,
        TextureBinding("environment_cube", source, SOURCE_SAMPLER),
        defines={"MOKA_SAMPLE_COUNT": IRRADIANCE_SAMPLES},
        samples=pack(
            cosine_samples(IRRADIANCE_SAMPLES, size), IRRADIANCE_SAMPLES
        ),
        reads=IRRADIANCE_SAMPLES,
    )
    return cube
