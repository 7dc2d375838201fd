"""A model that turns, in a window.

    python examples/hello_model.py [MODEL.gltf]

Without a file it is the built-in demo scene.
"""

import math
import sys

import moka
from moka.model import demo_model


class HelloModel(moka.App):
    """Loads one model and turns it by 30 degrees a second."""

    def __init__(self, path: str | None = None) -> None:
        super().__init__()
        self.path = path

    def load(self) -> None:
        model = moka.load_model(self.path) if self.path else demo_model()
        self.model = self.scene.add(model)
        self.scene.environment = moka.load_environment("studio")

    def update(self, time: moka.GameTime) -> None:
        angle = math.radians(30) * time.delta
        self.model.transform.rotate_around((0, 0, 0), (0, 1, 0), angle)


def render(size: tuple[int, int] = (1280, 720), frames: int = 1) -> moka.Image:
    """The last of ``frames`` frames, made without a window."""
    app = moka.run(HelloModel(), headless=True, frames=frames, size=size)
    assert app.image is not None
    return app.image


if __name__ == "__main__":
    moka.run(HelloModel(*sys.argv[1:2]))
