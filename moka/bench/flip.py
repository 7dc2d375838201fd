"""FLIP: the error that a person sees when flipping between two pictures.

Andersson et al., "FLIP: A Difference Evaluator for Alternating Images",
HPG 2020, for pictures as a display shows them; Andersson et al.,
"Visualizing Errors in Rendered High Dynamic Range Images", Eurographics
short papers 2021, for radiance. Both come from the authors' own package,
``flip-evaluator``, at its 67 pixels per degree: a monitor of 3840 pixels
and 0.7 m, seen from 0.7 m.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from moka.core.colour import luminance
from moka.core.errors import OptionError

__all__ = ["exposure_range", "flip_display", "flip_radiance", "magma"]

#: Display-referred value at which the second paper's exposures start and
#: stop, and the curve that takes them there: Narkowicz' fit of ACES, with
#: the factor 0.6 of its pre-exposure in the coefficients.
_TARGET = 0.85
_NUMERATOR = np.array([0.36 * 2.51, 0.6 * 0.03, 0.0])
_DENOMINATOR = np.array([0.36 * 2.43, 0.6 * 0.59, 0.14])


def flip_display(
    reference: NDArray[np.floating[Any]], test: NDArray[np.floating[Any]]
) -> NDArray[np.float32]:
    """The FLIP error, 0..1, of each pixel of sRGB-encoded pictures.

    Both are (H, W, 3) with values of 0..1; the result is (H, W). Its mean is
    the FLIP value of the pair. Raises OptionError where ``flip-evaluator``
    is not installed.
    """
    return _evaluate(reference, test, "LDR", {})


def flip_radiance(
    reference: NDArray[np.floating[Any]], test: NDArray[np.floating[Any]]
) -> NDArray[np.float32]:
    """The HDR-FLIP error, 0..1, of each pixel of linear Rec.709 radiance.

    Both are finite and (H, W, 3), the result is (H, W); negative values
    count as 0. Each pixel's error is the largest over a range of exposures
    that :func:`exposure_range` takes from the reference. Raises OptionError
    where ``flip-evaluator`` is not installed.
    """
    first, second = np.maximum(reference, 0.0), np.maximum(test, 0.0)
    # A black reference has no exposure; that of the other shows most of it.
    lit = first if first.any() else second
    start, stop = exposure_range(lit)
    count = max(2, int(np.ceil(stop - start)))
    return _evaluate(
        first,
        second,
        "HDR",
        {"startExposure": start, "stopExposure": stop, "numExposures": count},
    )


def exposure_range(radiance: NDArray[np.floating[Any]]) -> tuple[float, float]:
    """The exposures in EV between which HDR-FLIP looks at a picture.

    Section 3.1 of the second paper: those that bring the brightest and the
    median luminance of (H, W, 3) to 0.85 on the display. Where more than
    half of the pixels are black the median is that of the others; the
    paper's is then at an infinite exposure. (0, 0) for a black picture.
    """
    values = luminance(np.asarray(radiance, np.float64))
    lit = values[values > 0.0]
    if not lit.size:
        return 0.0, 0.0
    median = float(np.median(values)) or float(np.median(lit))
    # The positive root of numerator(x) - target * denominator(x).
    roots = np.roots(_NUMERATOR - _TARGET * _DENOMINATOR)
    shown = float(roots.max())
    start = float(np.log2(shown / float(lit.max())))
    return start, max(start, float(np.log2(shown / median)))


def magma(errors: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
    """Errors of 0..1, (H, W), as sRGB (H, W, 3) in the colours of FLIP.

    The colour map is magma, from black over purple and orange to a pale
    yellow, as both papers show their errors. Raises OptionError where
    Matplotlib is not installed.
    """
    try:
        from matplotlib import colormaps
    except ImportError as error:
        raise OptionError(
            "the colours of a FLIP map need the package matplotlib: "
            "pip install 'moka-pbr[bench]'"
        ) from error
    colours: NDArray[np.float64] = colormaps["magma"](np.arange(256))
    table = np.rint(255.0 * colours[:, :3]).astype(np.uint8)
    codes = np.rint(255.0 * np.clip(errors, 0.0, 1.0))
    shown: NDArray[np.uint8] = table[codes.astype(np.uint8)]
    return shown


def _evaluate(
    reference: NDArray[np.floating[Any]],
    test: NDArray[np.floating[Any]],
    dynamic_range: str,
    parameters: dict[str, float],
) -> NDArray[np.float32]:
    errors, _, _ = _import().evaluate(
        np.ascontiguousarray(reference, np.float32),
        np.ascontiguousarray(test, np.float32),
        dynamic_range,
        applyMagma=False,
        computeMeanError=False,
        parameters=parameters,
    )
    return np.asarray(errors, np.float32).reshape(reference.shape[:2])


def _import() -> Any:
    try:
        import flip_evaluator
    except ImportError as error:
        raise OptionError(
            "FLIP needs the package flip-evaluator: "
            "pip install 'moka-pbr[bench]'"
        ) from error
    return flip_evaluator
