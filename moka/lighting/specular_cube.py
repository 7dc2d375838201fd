"""Radiance prefiltered for the GGX lobe of growing roughness, as levels.

The first factor of the split sum (Karis 2013), with samples that read the
level of their own share of the lobe (:mod:`moka.lighting.samples`).
"""

import math

from moka.commands.descriptors import TextureBinding
from moka.commands.handles import Handle
from moka.lighting.environment_maps import SOURCE_SAMPLER
from moka.lighting.preintegration_passes import PreintegrationPasses
from moka.lighting.samples import ggx_prefilter_samples, pack

__all__ = [
    "SMALLEST_SPECULAR",
    "level_roughness",
    "prefilter",
    "specular_level_count",
]

# Samples for the first rough level; each level below has a quarter of the
# texels, a wider lobe, and twice as many. Without suns in the map more than
# 128 change nothing: spheres under a beach and a studio have the same median
# error within 0.001 with up to 512. Half as many for all levels take the
# error at roughness 0.1 to 0.3 from 0.014 to 0.022 and 0.031 to 0.044.
SPECULAR_SAMPLES = 32
MOST_SPECULAR_SAMPLES = 128
# The level of roughness 1 has this many texels along an edge: its lobe is
# wider than they are. With 8 the errors of spheres under a studio and a beach
# are 0.086 and 0.072 in place of 0.082 and 0.068: what counts is that there
# are more levels for narrow lobes.
SMALLEST_SPECULAR = 4


def specular_level_count(size: int) -> int:
    """Levels of a prefiltered cube of ``size``; the last is roughness 1."""
    return max(1, (size // SMALLEST_SPECULAR).bit_length())


def level_roughness(level: int, levels: int) -> float:
    """The roughness that level ``level`` of ``levels`` is filtered for.

    The inverse of ``specular_level`` in ``include/lighting.glsl``.
    """
    return 1.0 - math.sqrt(1.0 - level / max(1, levels - 1))


def prefilter(
    passes: PreintegrationPasses,
    source: Handle,
    size: int,
    cube: Handle,
    first: int,
) -> None:
    """Filter ``source``, with all of its levels, into those of ``cube``.

    Both have ``size`` texels along an edge at level 0; levels of ``cube``
    before ``first`` are left as they are.
    """
    levels = specular_level_count(size)
    for level in range(first, levels):
        count = min(
            SPECULAR_SAMPLES << max(0, level - 1), MOST_SPECULAR_SAMPLES
        )
        samples = ggx_prefilter_samples(
            level_roughness(level, levels), count, size
        )
        passes.cube_level(
            "prefilter_specular.frag",
            cube,
            level,
            size >> level,
            TextureBinding("environment_cube", source, SOURCE_SAMPLER),
            # One program for all levels: the block holds the most.
            defines={"MOKA_SAMPLE_COUNT": MOST_SPECULAR_SAMPLES},
            samples=pack(samples, MOST_SPECULAR_SAMPLES),
            reads=len(samples),
        )
