"""Plays animations: clocks, cross-fades, and when a pose is due."""

import math
from collections import defaultdict
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from moka.core.errors import OptionError
from moka.scene.animation_clips import Clips
from moka.scene.animation_pose import blended

if TYPE_CHECKING:
    from moka.scene.scene_model import SceneModel

__all__ = ["AnimationPlayer", "Playback", "apply_poses"]


class Playback:
    """One animation as it plays; the newest one covers those before it.

    ``animation`` is its position in ``model.animations``. ``time`` in
    seconds, ``speed`` (negative plays backwards), ``loop`` and ``weight`` may
    be changed at any time; ``weight`` is 1 where only this one shows and 0
    where only what played before it does.
    """

    def __init__(
        self,
        animation: int,
        duration: float,
        *,
        time: float,
        speed: float,
        loop: bool,
    ) -> None:
        self.animation = animation
        self.duration = duration
        self.speed = _finite(speed, "the speed")
        self.loop = loop
        self.weight = 1.0
        self.fade = 0.0  # In how many seconds the weight grows to 1.
        self.time = time

    @property
    def time(self) -> float:
        """Seconds from the start; from 0 to the duration.

        Setting a time outside goes around if it loops, else to the end that
        is nearer.
        """
        return self._time

    @time.setter
    def time(self, value: float) -> None:
        value = _finite(value, "the time")
        if self.loop and not 0 <= value <= self.duration:
            value = value % self.duration if self.duration else 0.0
        self._time = min(max(value, 0.0), self.duration)

    @property
    def has_ended(self) -> bool:
        """Whether time would change nothing more."""
        if self.fade:
            return False
        if self.loop or not self.speed:
            return not self.speed
        return self._time == (self.duration if self.speed > 0 else 0.0)

    def advance(self, delta: float) -> None:
        """Let ``delta`` seconds pass."""
        self.time = self._time + delta * self.speed
        if self.fade:
            grown = self.weight + delta / self.fade
            self.weight = min(max(grown, 0.0), 1.0)
            if self.weight == 1:
                self.fade = 0.0


class AnimationPlayer:
    """Plays the animations of one model in a scene.

    Nothing plays by itself: until :meth:`play`, :meth:`blend` or
    :meth:`pose` the model stands as its file has it. The scene lets time
    pass (:meth:`moka.Scene.animate`, which the loop of :func:`moka.run`
    calls before each ``update``), and a pose is written where it differs
    from the one before; then a node is where the animation has it, whatever
    moved it. Animations are named by their name or their position in
    ``model.animations``; one that is not there is an OptionError that lists
    what there is.
    """

    def __init__(self, model: "SceneModel", clips: Clips) -> None:
        self._clips = clips
        self._model = model
        self._copy = clips.copies.add(model)
        self._layers: list[Playback] = []
        self._shown: tuple[tuple[int, float, float], ...] = ()
        self.paused = False

    def __repr__(self) -> str:
        playing = ", ".join(
            f"{self.names[layer.animation]!r} at {layer.time:.3g} s"
            for layer in self._layers
        )
        return f"<AnimationPlayer: {playing or 'nothing'}>"

    @property
    def names(self) -> list[str]:
        """The names of the model's animations, in the file's order."""
        return [each.name for each in self._model.model.animations]

    @property
    def current(self) -> Playback | None:
        """What was played last; None if nothing is."""
        return self._layers[-1] if self._layers else None

    @property
    def is_playing(self) -> bool:
        """Whether time changes anything: not paused, not all ended."""
        return not self.paused and not all(
            layer.has_ended for layer in self._layers
        )

    def play(
        self,
        animation: str | int = 0,
        *,
        loop: bool = True,
        speed: float = 1.0,
        start: float = 0.0,
        fade: float = 0.0,
    ) -> Playback:
        """Play an animation from ``start`` seconds on.

        It replaces what plays, or the pose of the file, over ``fade``
        seconds in which both are blended, so that nothing jumps. Without
        ``loop`` it stays in its last pose. Ends a pause.
        """
        if not fade >= 0:
            raise OptionError(f"animation: a fade of {fade} s is negative")
        layer = self._layer(animation, loop=loop, speed=speed, start=start)
        if fade:
            layer.weight, layer.fade = 0.0, fade
        else:
            self._layers.clear()
        self._layers.append(layer)
        self.paused = False
        return layer

    def blend(
        self,
        first: str | int,
        second: str | int,
        weight: float,
        *,
        loop: bool = True,
        speed: float = 1.0,
    ) -> tuple[Playback, Playback]:
        """Play two animations at once, ``weight`` (0 to 1) of the second.

        Called again with the same two it only changes the weight, and their
        times go on: a walk becomes a run with the speed of the walker.
        """
        if not 0 <= weight <= 1:
            raise OptionError(f"animation: a weight of {weight} is not 0 to 1")
        wanted = [self._clips.number_of(each) for each in (first, second)]
        if [layer.animation for layer in self._layers] != wanted:
            self._layers = [
                self._layer(each, loop=loop, speed=speed, start=0.0)
                for each in wanted
            ]
        below, above = self._layers
        below.fade, above.fade = 0.0, 0.0
        below.weight, above.weight = 1.0, weight
        self.paused = False
        return below, above

    def pose(self, animation: str | int = 0, time: float = 0.0) -> None:
        """Hold the pose of an animation at ``time`` seconds.

        Before its start it is the first pose, behind its end the last.
        """
        self.play(animation, loop=False, speed=0.0, start=time)

    def pause(self) -> None:
        """Stop the clock; poses stay as they are."""
        self.paused = True

    def resume(self) -> None:
        """Let the clock go on."""
        self.paused = False

    def stop(self) -> None:
        """Play nothing: back to the pose of the file."""
        self._layers.clear()

    def seek(self, time: float) -> None:
        """Set the time of what was played last, in seconds.

        Raises OptionError if nothing plays.
        """
        if not self._layers:
            raise OptionError("animation: nothing plays, so nothing to seek")
        self._layers[-1].time = time

    def advance(self, delta: float) -> None:
        """Let ``delta`` seconds pass, unless paused; see apply_poses."""
        if self.paused:
            return
        fading = [layer for layer in self._layers if layer.fade]
        for layer in self._layers:
            layer.advance(delta)
        for layer in fading:
            if layer.weight == 1:
                # It covers all that played before, which ends so.
                del self._layers[: self._layers.index(layer)]

    def close(self) -> None:
        """Forget the model, which is not in its scene any more."""
        self._clips.copies.remove(self._copy)

    def _due(self) -> list[Playback] | None:
        """What covers all else, and what shows over it, if that is news."""
        shown = tuple(
            (layer.animation, layer.time, layer.weight)
            for layer in self._layers
        )
        if shown == self._shown:
            return None
        self._shown = shown
        covering = [n for n, each in enumerate(shown) if each[2] == 1]
        return self._layers[covering[-1] if covering else 0 :]

    def _blend(self, layers: Iterable[Playback]) -> None:
        """Take the pose that layers show together over that of the file."""
        pose = self._clips.layout.rest_poses(1)
        for layer in layers:
            above = self._clips.pose(layer.animation, layer.time)
            pose = blended(pose, above, layer.weight)
        self._clips.copies.take([self._copy], pose)

    def _layer(
        self, animation: str | int, *, loop: bool, speed: float, start: float
    ) -> Playback:
        number = self._clips.number_of(animation)
        return Playback(
            number,
            self._clips.duration(number),
            time=start,
            speed=speed,
            loop=loop,
        )


def apply_poses(players: Iterable[AnimationPlayer]) -> None:
    """Let models have the poses that their players show now.

    Costs nothing for those that show what they did before. Copies of one
    model that play one animation are sampled together.
    """
    crowds: dict[tuple[Clips, int], dict[int, float]] = defaultdict(dict)
    for player in players:
        layers = player._due()
        if layers is None:
            continue
        if len(layers) == 1 and layers[0].weight == 1:
            crowd = crowds[player._clips, layers[0].animation]
            crowd[player._copy] = layers[0].time
        else:
            player._blend(layers)
    for (clips, animation), members in crowds.items():
        times = np.array(list(members.values()))
        clips.copies.take(list(members), clips.poses(animation, times))


def _finite(value: float, what: str) -> float:
    if not math.isfinite(value):
        raise OptionError(f"animation: {what} must be a finite number")
    return float(value)
