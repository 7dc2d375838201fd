"""A model's animations made ready to be sampled, each when it first plays."""

from moka.core.errors import OptionError
from moka.model.model import Model
from moka.scene.animation_pose import Pose, PoseLayout
from moka.scene.keyframes import KeyframeSampler

__all__ = ["Clips"]


class Clips:
    """What all copies of a model share of its animations."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self.layout = PoseLayout(model)
        self._samplers: dict[int, KeyframeSampler] = {}
        # Copies that move in step have one pose.
        self._latest: dict[int, tuple[float, Pose]] = {}

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

    def pose(self, number: int, time: float) -> Pose:
        """The pose of an animation at a time in seconds; not to be written.

        What it does not move is as the file has it.
        """
        latest = self._latest.get(number)
        if latest is not None and latest[0] == time:
            return latest[1]
        sampler = self._samplers.get(number)
        if sampler is None:
            channels = self._model.animations[number].channels
            sampler = self._samplers[number] = KeyframeSampler(
                channels,
                [self.layout.places(channel.target) for channel in channels],
            )
        pose = {
            name: column.copy() for name, column in self.layout.rest.items()
        }
        for property_, places, values in sampler.sample(time):
            pose[property_][places] = values
        self._latest[number] = time, pose
        return pose
