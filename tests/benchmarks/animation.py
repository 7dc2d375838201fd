"""Time what animations cost: to load, and for each frame.

    python tests/benchmarks/animation.py [--channels 10000] [MODEL ...]

A file of so many channels (translations, rotations and scales of one third
each, LINEAR, STEP and CUBICSPLINE in turn) is made in memory, once with one
set of times for all and once with a set for each. ``sample`` is the values
of all channels at one time, ``pose`` those in their columns, ``frame`` what
Scene.animate and Scene.update take together: with the matrices of all nodes
made and passed down the tree. ``still`` is a frame in which time stands.
Of models that are named, so many copies play at different times: ``10`` and
``100``. Best and median of the runs, in milliseconds.
"""

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from moka.model import load_model
from moka.model.source import ModelSource
from moka.scene.keyframes import KeyframeSampler
from moka.scene.scene import Scene
from tests.support.animated import AnimatedFile

KEYS = 30
WIDTHS = {"translation": 3, "rotation": 4, "scale": 3}
MODES = ("LINEAR", "STEP", "CUBICSPLINE")


def made_file(channels: int, *, shared: bool) -> bytes:
    """A file whose nodes all move, one channel for each part of each."""
    random = np.random.default_rng(0)
    file = AnimatedFile(-(-channels // 3))
    times = np.linspace(0, 1, KEYS)
    input_ = file.accessor(times)
    for index in range(channels):
        path = tuple(WIDTHS)[index % 3]
        mode = MODES[index // 3 % 3]
        count = KEYS * (3 if mode == "CUBICSPLINE" else 1)
        file.channel(
            (index // 3, path),
            input_ if shared else file.accessor(times * random.uniform(1, 2)),
            random.normal(size=(count, WIDTHS[path])),
            mode,
        )
    return file.glb()


def timed(work: Callable[[int], object], runs: int = 30) -> tuple[float, float]:
    """Best and median milliseconds of ``work``, which is given the run."""
    taken = []
    for run in range(runs):
        start = time.perf_counter()
        work(run)
        taken.append((time.perf_counter() - start) * 1e3)
    return min(taken), median(taken)


def crowd(source: ModelSource, count: int) -> tuple[float, float]:
    """Frames of so many copies that play the longest animation."""
    scene, model = Scene(), load_model(source)
    lengths = [animation.duration for animation in model.animations]
    number = lengths.index(max(lengths))
    for index in range(count):
        scene.add(model).animations.play(number, start=0.013 * index)

    def frame(_: int) -> None:
        scene.animate(1 / 60)
        scene.update()

    frame(0)
    return timed(frame)


def report(
    name: str, source: ModelSource, copies: tuple[int, ...] = ()
) -> None:
    """Print a line for each thing that is timed."""
    results = {"load": timed(lambda _: load_model(source), 5)}
    scene = Scene()
    model = scene.add(load_model(source))
    animation = max(model.model.animations, key=lambda a: len(a.channels))
    number = model.model.animations.index(animation)
    clips = model.layout.clips
    places = clips.layout.places(animation.channels)
    sampler = KeyframeSampler(animation.channels, places)
    step = animation.duration / 97 or 1.0
    results["sample"] = timed(
        lambda run: list(sampler.sample(np.array([run * step])))
    )
    results["pose"] = timed(lambda run: clips.pose(number, run * step))
    model.animations.play(number)

    def frame(_: int) -> None:
        scene.animate(step)
        scene.update()

    frame(0)
    results["frame"] = timed(frame)
    model.animations.pause()
    results["still"] = timed(frame)
    for count in copies:
        results[str(count)] = crowd(source, count)
    print(f"{name}: {len(animation.channels)} channels")
    for what, (best, usual) in results.items():
        print(f"  {what:<7} {best:9.3f}  {usual:9.3f}")


def main() -> None:
    """Time the file that is made, and the models that are named."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("models", nargs="*", type=Path)
    parser.add_argument("--channels", type=int, default=10000)
    arguments = parser.parse_args()
    count = arguments.channels
    report("one set of times", made_file(count, shared=True))
    report("a set for each", made_file(count, shared=False))
    for path in arguments.models:
        report(path.name, path, (10, 100))


if __name__ == "__main__":
    main()
