"""What the ratings of a survey say about the renderers.

The unit is the participant: people differ in how they use a scale, and the
ratings of one person are not independent. Each renderer therefore has one
value per participant, the mean over the scenes, and pairs of renderers are
compared by the differences of these, over the scenes that both have.

The criterion of success is that a candidate is "rated like the engines".
A test that finds no difference would not show that; a small survey never
finds one. So it is a test of non-inferiority against a margin: the candidate
is like an engine if the one-sided 95 % limit below the mean difference lies
above minus the margin. Where the limit above lies below the margin as well,
the two are equivalent (the two one-sided tests of Schuirmann, "A comparison
of the two one-sided tests procedure and the power approach", 1987). The
candidate must be like every engine, which needs no correction for their
number: each could only make the whole fail.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from moka.core.errors import OptionError
from moka.survey.answers import Answers
from moka.survey.statistics import (
    Summary,
    holm,
    mean_ranks,
    paired_t,
    summarise,
    wilcoxon,
)

__all__ = [
    "Analysis",
    "Criterion",
    "PairResult",
    "RendererResult",
    "Verdict",
    "analyse",
]


@dataclass(frozen=True)
class RendererResult:
    """One renderer: its ratings, and its mean rank within scenes."""

    name: str
    ratings: Summary
    rank: float


@dataclass(frozen=True)
class PairResult:
    """The differences ``first`` - ``second`` over participants.

    ``p_t`` and ``p_wilcoxon`` are the p-values of the paired tests,
    ``p_holm`` is ``p_t`` adjusted for the number of pairs.
    """

    first: str
    second: str
    difference: Summary
    p_t: float
    p_holm: float
    p_wilcoxon: float


@dataclass(frozen=True)
class Verdict:
    """How the candidate stands to one engine.

    ``difference`` is candidate - engine; ``verdict`` is ``equivalent``,
    ``not worse``, ``worse`` or ``undecided``.
    """

    engine: str
    difference: Summary
    verdict: str


@dataclass(frozen=True)
class Criterion:
    """Whether ``candidate`` is rated like each of the engines."""

    candidate: str
    margin: float
    verdicts: Sequence[Verdict]

    @property
    def met(self) -> bool:
        """True if the candidate is equivalent or not worse everywhere."""
        return all(
            each.verdict in ("equivalent", "not worse")
            for each in self.verdicts
        )


@dataclass(frozen=True)
class Analysis:
    """All results; ``criterion`` is None where no engines were named."""

    participants: int
    repeated: int
    scenes: int
    renderers: Sequence[RendererResult]
    pairs: Sequence[PairResult]
    criterion: Criterion | None


def analyse(
    answers: Answers,
    *,
    candidate: str = "moka",
    engines: Sequence[str] = (),
    margin: float = 1.0,
) -> Analysis:
    """Analyse the ratings of a survey.

    ``engines`` are the renderers that ``candidate`` is held against,
    ``margin`` is in points of the scale. Renderers come best first. Raises
    OptionError for names that were not in the survey or that share no scene
    with the candidate, and where SciPy is missing.
    """
    scenes, names, ratings = _table(answers)
    for name in (candidate, *engines) if engines else ():
        if name not in names:
            raise OptionError(
                f"{name}: is not a renderer of this survey; it has "
                f"{', '.join(names)}"
            )
    if candidate in engines:
        raise OptionError(f"{candidate}: cannot be its own engine")
    ranks = mean_ranks(ratings.reshape(-1, len(names)))
    renderers = [
        RendererResult(
            name,
            summarise(np.nanmean(ratings[:, :, index], axis=1)),
            float(ranks[index]),
        )
        for index, name in enumerate(names)
    ]
    renderers.sort(key=lambda each: -each.ratings.mean)
    pairs = _pairs([each.name for each in renderers], names, ratings)
    criterion = None
    if engines:
        verdicts = [
            _judge(
                engine, _differences(candidate, engine, names, ratings), margin
            )
            for engine in engines
        ]
        criterion = Criterion(candidate, margin, verdicts)
    return Analysis(
        answers.participants,
        answers.repeated,
        len(scenes),
        renderers,
        pairs,
        criterion,
    )


def _table(
    answers: Answers,
) -> tuple[list[str], list[str], NDArray[np.float64]]:
    """Scenes, renderers, and ratings (participants, scenes, renderers).

    A picture that a person saw in several pairs has the mean of these
    ratings, one that a scene does not have is NaN.
    """
    scenes = sorted({each.scene for each in answers.ratings})
    names = sorted({each.renderer for each in answers.ratings})
    shape = (answers.participants, len(scenes), len(names))
    total, count = np.zeros(shape), np.zeros(shape)
    for each in answers.ratings:
        cell = (
            each.participant,
            scenes.index(each.scene),
            names.index(each.renderer),
        )
        total[cell] += each.rating
        count[cell] += 1
    table = np.full(shape, np.nan)
    np.divide(total, count, out=table, where=count > 0)
    return scenes, names, table


def _differences(
    first: str,
    second: str,
    names: Sequence[str],
    ratings: NDArray[np.float64],
) -> NDArray[np.float64] | None:
    """One difference per participant, or None without a common scene."""
    differences = (
        ratings[:, :, names.index(first)] - ratings[:, :, names.index(second)]
    )
    # Every participant rated every picture, so that a scene is either in
    # all of the rows or in none.
    common = ~np.isnan(differences[0])
    if not common.any():
        return None
    mean: NDArray[np.float64] = differences[:, common].mean(axis=1)
    return mean


def _pairs(
    order: Sequence[str],
    names: Sequence[str],
    ratings: NDArray[np.float64],
) -> list[PairResult]:
    found = []
    for first, second in combinations(order, 2):
        sample = _differences(first, second, names, ratings)
        if sample is not None:
            found.append((first, second, sample))
    p_values = [paired_t(sample) for _, _, sample in found]
    return [
        PairResult(
            first, second, summarise(sample), p_t, p_holm, wilcoxon(sample)
        )
        for (first, second, sample), p_t, p_holm in zip(
            found, p_values, holm(p_values), strict=True
        )
    ]


def _judge(
    engine: str, sample: NDArray[np.float64] | None, margin: float
) -> Verdict:
    if sample is None:
        raise OptionError(f"{engine}: shares no scene with the candidate")
    difference = summarise(sample)
    # Comparisons with NaN, the limits of a single participant, are false.
    not_worse = difference.least > -margin
    if not_worse and difference.most < margin:
        verdict = "equivalent"
    elif not_worse:
        verdict = "not worse"
    else:
        verdict = "worse" if difference.most < -margin else "undecided"
    return Verdict(engine, difference, verdict)
