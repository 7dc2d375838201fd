"""Encodings and tone maps against their twins for arrays."""

from collections.abc import Callable

import numpy as np

from moka.core.colour import decode_srgb, encode_srgb
from moka.core.tone_map import TONE_MAPS, tone_map
from tests.support.gpu import gpu
from tests.support.oracles.directions import Array
from tests.support.stated_errors.grids import absolute, single


def srgb(function: str, twin: Callable[[Array], Array]) -> float:
    x = single(np.tile(np.linspace(0.0, 1.0, 5000)[:, None], (1, 3)))
    return absolute(gpu().evaluate(f"{function}(x)", "srgb", x=x), twin(x))


def tone_curve(name: str) -> float:
    generator = np.random.default_rng(1)
    hue = generator.uniform(0.0, 1.0, (8000, 3))
    x = single(hue * 10.0 ** generator.uniform(-7.0, 5.0, (8000, 1)))
    defines = {f"MOKA_TONE_MAP_{name.upper()}": 1}
    value = gpu().evaluate("tone_map(x)", "tone_map", defines, x=x)
    return absolute(value, tone_map(x, name))


MEASURES: dict[str, Callable[[], float]] = {
    "srgb_encode": lambda: srgb("srgb_encode", encode_srgb),
    "srgb_decode": lambda: srgb("srgb_decode", decode_srgb),
    **{
        f"tone_curve {name}": lambda name=name: tone_curve(name)
        for name in TONE_MAPS
    },
}
