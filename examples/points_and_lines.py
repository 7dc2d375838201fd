"""A cloud of points and the lines of a curve, with colours of their own.

    python examples/points_and_lines.py

Neither has normals, so that nothing lights them: their colours are what is
seen. The points lie on a torus, the line winds around it.
"""

import numpy as np

import moka
from moka.commands.descriptors import Topology
from moka.model import Primitive, model_of

POINTS = 40_000
TURNS = 12


def torus(around: np.ndarray, across: np.ndarray, thin: float) -> np.ndarray:
    """Points (N, 3) of a torus at two angles (N,) in radians."""
    radius = 1.0 + thin * np.cos(across)
    return np.column_stack(
        [
            radius * np.cos(around),
            thin * np.sin(across),
            radius * np.sin(around),
        ]
    ).astype(np.float32)


def colours(angle: np.ndarray) -> np.ndarray:
    """Linear colours (N, 4) around the wheel."""
    turns = angle[:, None] / (2 * np.pi) + np.array([0, 1, 2]) / 3
    rgb = 0.5 + 0.5 * np.cos(2 * np.pi * turns)
    return np.column_stack([rgb, np.ones(len(angle))]).astype(np.float32)


def model() -> moka.Model:
    """The cloud and the curve."""
    random = np.random.default_rng(0)
    around, across = random.uniform(0, 2 * np.pi, (2, POINTS))
    cloud = Primitive(
        {
            "POSITION": torus(around, across, 0.35),
            "COLOR_0": colours(around),
        },
        topology=Topology.POINTS,
    )
    angle = np.linspace(0, 2 * np.pi, 2000)
    curve = Primitive(
        {
            "POSITION": torus(angle, TURNS * angle, 0.5),
            "COLOR_0": np.ones((len(angle), 4), np.float32),
        },
        topology=Topology.LINE_STRIP,
    )
    plain = moka.Material(unlit=True)
    return model_of([(cloud, plain, np.eye(4)), (curve, plain, np.eye(4))])


def render(size: tuple[int, int] = (1280, 720)) -> moka.Image:
    """The torus from above."""
    return moka.render(
        model(),
        environment="none",
        background="#101014",
        camera="orbit:20,35",
        size=size,
        tone_map="none",
    )


if __name__ == "__main__":
    render().save("points_and_lines.png")
