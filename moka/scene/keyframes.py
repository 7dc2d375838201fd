"""All channels of an animation sampled at once, whatever their number.

Channels are grouped by what they move, their interpolation and how many
numbers they have; a group's keyframes are one array. The keyframe before a
time is found for all different sets of times by one binary search over one
sorted array of integers::

    bit 63          32 31                 0
       +--------------+-------------------+
       | set of times | bits of the time  |
       +--------------+-------------------+

The bits of float32 numbers from 0 on have the order of the numbers, so that
the search is exact, and sets stay apart however long they last.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from moka.core.interpolation import hermite, lerp, slerp
from moka.core.maths import Array
from moka.model.animation import AnimationChannel, Interpolation, Property
from moka.scene.forest import Rows

__all__ = ["KeyframeSampler"]

_ROTATION: Property = ("node", "rotation")
_LATEST = float(np.finfo(np.float32).max)


class KeyframeSampler:
    """The keyframes of one animation, ready to be sampled.

    ``places`` holds for each channel where its values belong in the column
    of its property: one place, or as many as it moves weights.
    """

    def __init__(
        self, channels: Sequence[AnimationChannel], places: Sequence[Rows]
    ) -> None:
        self._timeline = _Timeline([channel.times for channel in channels])
        members = defaultdict(list)
        for index, channel in enumerate(channels):
            target = channel.target
            key = (
                (target.kind, target.property),
                channel.interpolation,
                channel.values.shape[-1],
            )
            members[key].append(index)
        self._groups = [
            _Group(
                property_,
                interpolation,
                np.concatenate([places[index] for index in indices]),
                self._timeline.numbers[indices],
                _offsets(channels, indices, self._timeline),
                np.concatenate([channels[index].values for index in indices]),
            )
            for (property_, interpolation, _), indices in members.items()
        ]

    def sample(self, times: Array) -> Iterator[tuple[Property, Rows, Array]]:
        """What every property is at ``times`` (T,) in seconds.

        Properties, the places (P,) of their values in the property's column,
        and the values, float64 (T, P, C). Before its first keyframe a channel
        has the first value, after its last one the last (glTF 2.0, 3.11).
        """
        moments = self._timeline.locate(times)
        for group in self._groups:
            values = group.sample(moments)
            # Weights of one node are of many places.
            yield (
                group.property,
                group.places,
                values.reshape(len(times), len(group.places), -1),
            )


class _Moments(Struct, frozen=True):
    """Where times lie in each set of times (T, U).

    Rows of the keyframes around them, 0 to 1 between these, and the seconds
    from one to the other.
    """

    before: Rows
    after: Rows
    fraction: Array
    span: Array


class _Timeline:
    """Every different set of times, one behind the other.

    ``numbers`` holds the set that each of the given ``times`` is, ``starts``
    the row of the first time of each set.
    """

    def __init__(self, times: Sequence[NDArray[np.float32]]) -> None:
        # By identity: what the file shares is one array.
        number_of: dict[int, int] = {}
        sets: list[NDArray[np.float32]] = []
        numbers = []
        for each in times:
            if id(each) not in number_of:
                number_of[id(each)] = len(sets)
                sets.append(each)
            numbers.append(number_of[id(each)])
        counts = np.array([len(each) for each in sets], np.intp)
        self.numbers: Rows = np.array(numbers, np.intp)
        self._ends: Rows = np.cumsum(counts) - 1
        self.starts: Rows = self._ends - counts + 1
        # Adding 0 makes 0 of -0, whose bits are no small number.
        joined = np.concatenate([np.zeros(0, np.float32), *sets]) + np.float32()
        self._times: Array = joined.astype(np.float64)
        self._prefix = np.arange(len(sets), dtype=np.uint64) << np.uint64(32)
        self._keys = np.repeat(self._prefix, counts) | joined.view(np.uint32)

    def locate(self, times: Array) -> _Moments:
        """The keyframes around ``times`` (T,), exact for float64 times."""
        times = np.clip(times, 0.0, _LATEST)
        # The last float32 that is not later: no keyframe is between.
        bounds = times.astype(np.float32)
        late = bounds > times
        bounds[late] = np.nextafter(bounds[late], np.float32(0))
        found = np.searchsorted(
            self._keys,
            self._prefix | bounds.view(np.uint32)[:, None],
            side="right",
        )
        before = np.maximum(found - 1, self.starts)
        after = np.minimum(before + 1, self._ends)
        start = self._times[before]
        span = self._times[after] - start
        fraction = np.zeros(span.shape)
        np.divide(times[:, None] - start, span, out=fraction, where=span > 0)
        return _Moments(before, after, np.maximum(fraction, 0), span)


class _Group(Struct, frozen=True, eq=False):
    """G channels that move one property in one way, by C numbers each.

    ``sets`` (G,) are numbers of sets of times, ``offsets`` (G,) what to add
    to a row of the timeline to get that of the channel's keyframe in
    ``values``, float32 (K, C), or (K, 3, C) of cubic splines.
    """

    property: Property
    interpolation: Interpolation
    places: Rows
    sets: Rows
    offsets: Rows
    values: NDArray[np.float32]

    def sample(self, moments: _Moments) -> Array:
        """The values (T, G, C) at T moments."""
        turns = self.property == _ROTATION
        before = self.offsets + moments.before[:, self.sets]
        first = self.values[before].astype(np.float64)
        if self.interpolation is Interpolation.STEP:
            return _unit(first) if turns else first
        after = self.offsets + moments.after[:, self.sets]
        second = self.values[after].astype(np.float64)
        fraction = moments.fraction[:, self.sets]
        if self.interpolation is Interpolation.LINEAR:
            if turns:
                return slerp(_unit(first), _unit(second), fraction)
            return lerp(first, second, fraction)
        values = hermite(
            first[..., 1, :],
            first[..., 2, :],
            second[..., 0, :],
            second[..., 1, :],
            fraction,
            moments.span[:, self.sets],
        )
        return _unit(values) if turns else values


def _offsets(
    channels: Sequence[AnimationChannel],
    indices: Sequence[int],
    timeline: _Timeline,
) -> Rows:
    """From rows of the timeline to rows of a group's joined keyframes."""
    counts = np.array([len(channels[index].times) for index in indices])
    first = np.cumsum(counts) - counts
    return np.asarray(first - timeline.starts[timeline.numbers[indices]])


def _unit(quaternions: Array) -> Array:
    """Quaternions (..., 4) of length 1; that of length 0, no turn, stays.

    Squares of float32 numbers neither vanish nor overflow in float64.
    """
    squared = np.einsum("...i,...i->...", quaternions, quaternions)
    length = np.sqrt(squared)[..., None]
    return np.asarray(quaternions / np.where(length > 0, length, 1))
