"""A model's animations made ready to be sampled, each when it first plays."""

import numpy as np

from moka.core.errors import OptionError
from moka.core.maths import Array
from moka.model.model import Model
from moka.scene.animated_copies import AnimatedCopies
from moka.scene.animation_pose import PoseLayout, Poses
from moka.scene.keyframes import KeyframeSampler

__all__ = ["Clips"]


class Clips:
    """What all copies of a model share of its animations.

    ``layout`` says what their poses are made of, ``copies`` which they have.
    """

    def __init__(self, model: Model) -> None:
        self._model = model
        self.layout = PoseLayout(model)
        self.copies = AnimatedCopies(self.layout)
        self._samplers: dict[int, KeyframeSampler] = {}

    def number_of(self, animation: str | int) -> int:
        """The position of an animation that is named by it or by its name.

        Of several with one name the first; a text that is no name may be a
        position. Raises OptionError, listing what there is, for one that is
        not there.
        """
        names = [each.name for each in self._model.animations]
        if animation in names:
            return names.index(str(animation))
        position = animation
        if isinstance(animation, str) and animation.isdecimal():
            position = int(animation)
        if isinstance(position, int) and 0 <= position < len(names):
            return position
        listed = ", ".join(f"{i} {name!r}" for i, name in enumerate(names))
        model = self._model.path or self._model.name or "the model"
        raise OptionError(
            f"animation: there is no {animation!r}; {model} has "
            f"{listed or 'none'}"
        )

    def duration(self, number: int) -> float:
        """How long an animation is, in seconds."""
        return self._model.animations[number].duration

    def poses(self, number: int, times: Array) -> Poses:
        """The poses of an animation at ``times`` (P,) in seconds.

        What it does not move is as the file has it.
        """
        sampler = self._samplers.get(number)
        if sampler is None:
            channels = self._model.animations[number].channels
            sampler = self._samplers[number] = KeyframeSampler(
                channels, self.layout.places(channels)
            )
        poses = self.layout.rest_poses(len(times))
        for property_, places, values in sampler.sample(times):
            poses[property_][:, places] = values
        return poses

    def pose(self, number: int, time: float) -> Poses:
        """The one pose of an animation at a time in seconds."""
        return self.poses(number, np.array([time]))
