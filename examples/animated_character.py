"""A character that walks, and stops when you press the space bar.

    python examples/animated_character.py [CHARACTER.glb]

Without a file it is a figure of boxes that is made here, with an animation
of a walk and one of standing still, as a file would have them: keyframes of
nodes. Going from one to the other they are blended over half a second.
"""

import math
import sys

import numpy as np

import moka
from moka.app.keys import Key
from moka.core.maths import compose
from moka.model import Primitive, cube
from moka.model.animation import (
    Animation,
    AnimationChannel,
    AnimationTarget,
    Interpolation,
)
from moka.model.mesh import Mesh
from moka.model.nodes import NodeTree

SECONDS = 1.2
SWING = math.radians(32)

# Name, parent, where its joint is in the parent's space, and of its box: the
# middle and the size.
PARTS = (
    ("hips", -1, (0, 1.0, 0), (0, 0, 0), (0.4, 0.2, 0.25)),
    ("chest", 0, (0, 0.12, 0), (0, 0.28, 0), (0.5, 0.5, 0.3)),
    ("head", 1, (0, 0.6, 0), (0, 0.16, 0), (0.26, 0.28, 0.26)),
    ("left arm", 1, (0.33, 0.5, 0), (0, -0.3, 0), (0.13, 0.65, 0.13)),
    ("right arm", 1, (-0.33, 0.5, 0), (0, -0.3, 0), (0.13, 0.65, 0.13)),
    ("left leg", 0, (0.12, -0.1, 0), (0, -0.42, 0), (0.16, 0.8, 0.18)),
    ("right leg", 0, (-0.12, -0.1, 0), (0, -0.42, 0), (0.16, 0.8, 0.18)),
)
# Which limbs swing, and on which side of the step.
SWINGS = {"left arm": 1, "right arm": -1, "left leg": -1, "right leg": 1}


def figure() -> moka.Model:
    """Seven boxes in a hierarchy, and two animations of their joints."""
    skin = moka.Material(
        base_colour_factor=(0.9, 0.35, 0.1, 1.0),
        metallic_factor=0.0,
        roughness_factor=0.4,
    )
    meshes = [
        Mesh(name, [box(middle, size).with_material(skin)])
        for name, _, _, middle, size in PARTS
    ]
    count = len(PARTS)
    nothing = np.full(count, -1, np.int32)
    joints = np.array([joint for _, _, joint, _, _ in PARTS], np.float64)
    nodes = NodeTree(
        names=[name for name, *_ in PARTS],
        parents=np.array([parent for _, parent, *_ in PARTS], np.int32),
        local=compose(joints, np.tile([0.0, 0, 0, 1], (count, 1)), np.ones(3)),
        mesh=np.arange(count, dtype=np.int32),
        camera=nothing,
        light=nothing,
        source=np.arange(count, dtype=np.int32),
    )
    return moka.Model(
        name="figure",
        nodes=nodes,
        meshes=meshes,
        materials=[skin],
        cameras=[],
        lights=[],
        scenes=[[0]],
        scene_names=["figure"],
        animations=[
            Animation("walk", SECONDS, tuple(channels(SWING))),
            Animation("stand", SECONDS, tuple(channels(0.0))),
        ],
    )


def box(middle: tuple[float, ...], size: tuple[float, ...]) -> Primitive:
    """A cube that is stretched and moved."""
    unit = cube(1.0)
    moved = unit.attributes["POSITION"] * size + middle
    return Primitive(
        {**unit.attributes, "POSITION": moved.astype(np.float32)},
        unit.indices,
    )


def channels(swing: float) -> list[AnimationChannel]:
    """Arms and legs that swing about +X, as a sine of time."""
    times = np.linspace(0.0, SECONDS, 17, dtype=np.float32)
    phase = np.sin(2 * np.pi * times / SECONDS)
    made = []
    for name, side in SWINGS.items():
        half = 0.5 * swing * side * phase
        turns = np.zeros((len(times), 4), np.float32)
        turns[:, 0], turns[:, 3] = np.sin(half), np.cos(half)
        row = [part[0] for part in PARTS].index(name)
        made.append(
            AnimationChannel(
                AnimationTarget("node", row, "rotation"),
                Interpolation.LINEAR,
                times,
                turns,
            )
        )
    return made


class AnimatedCharacter(moka.App):
    """Plays the first animation; the space bar goes to the next one."""

    def __init__(self, path: str | None = None) -> None:
        super().__init__()
        self.path = path

    def load(self) -> None:
        model = moka.load_model(self.path) if self.path else figure()
        self.character = self.scene.add(model)
        self.character.animations.play(0)
        self.scene.environment = moka.load_environment("studio")
        width, height = self.size
        self.camera.frame(
            self.scene.bounds(), width / height, yaw=0.7, pitch=0.15
        )

    def update(self, time: moka.GameTime) -> None:  # noqa: ARG002
        if self.input.keyboard.was_pressed(Key.SPACE):
            self.next_animation()

    def next_animation(self) -> None:
        """Blend into the animation that follows."""
        player = self.character.animations
        number = player.current.animation + 1
        player.play(number % len(player.names), fade=0.5)


def render(size: tuple[int, int] = (720, 720), frames: int = 20) -> moka.Image:
    """The last of ``frames`` frames, made without a window."""
    app = moka.run(AnimatedCharacter(), headless=True, frames=frames, size=size)
    assert app.image is not None
    return app.image


if __name__ == "__main__":
    moka.run(AnimatedCharacter(*sys.argv[1:2]))
