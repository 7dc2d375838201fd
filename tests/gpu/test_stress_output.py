"""The way out of the renderer: display values, files, pipes, Ctrl-C."""

import itertools
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from moka.commands.command_list import CommandList
from moka.core.errors import OptionError
from moka.core.exr import read_exr
from moka.core.tone_map import TONE_MAPS, tone_map
from moka.graphics.device import GraphicsDevice
from moka.lighting.environment import Environment
from moka.material.material import AlphaMode, Material
from moka.model import model_of, quad, save_model, sphere
from moka.renderer.renderer import Renderer
from moka.renderer.settings import RenderSettings
from tests.support.pictures import (
    draw_radiance,
    draw_with_display,
    placed_at,
    scene_of,
    square_camera,
)

pytestmark = pytest.mark.gpu

LEVELS = (0.0, 1e-30, 1e-7, 0.18, 1.0, 100.0, 65504.0, 1e9, 1e30)
MOKA = [sys.executable, "-m", "moka"]


def strips() -> list:
    """Glowing squares side by side, each of one level."""
    width = 2.0 / len(LEVELS)
    items = []
    for index, level in enumerate(LEVELS):
        glow = Material(
            base_colour_factor=(0, 0, 0, 1),
            emissive_factor=(level, level / 2, 0),
        )
        x = (index + 0.5) * width - 1.0
        items.append((quad(width), glow, placed_at(x)))
    return items


@pytest.mark.parametrize("name", TONE_MAPS)
@pytest.mark.parametrize("float_output", [True, False])
def test_a_tone_map_at_every_level_and_exposure(
    egl_device: GraphicsDevice, name: str, float_output: bool
) -> None:
    """Against the curve in float64, within a step of 8 bits."""
    scene = scene_of(strips())
    size = (len(LEVELS), 1)
    for exposure in (-64, -20, 0, 20, 64):
        radiance, display = draw_with_display(
            egl_device,
            scene,
            square_camera(1.0 / len(LEVELS)),
            size,
            tone_map=name,
            exposure=exposure,
            float_output=float_output,
        )
        assert np.isfinite(radiance).all()
        shown = tone_map(radiance[..., :3].astype(float), name, exposure)
        codes = np.where(
            shown <= 0.0031308,
            12.92 * shown,
            1.055 * shown ** (1 / 2.4) - 0.055,
        )
        difference = np.abs(display[..., :3] - 255.0 * codes)
        assert difference.max() <= 1.01, exposure
        assert (display[..., 3] == 255).all()


@pytest.mark.parametrize("name", TONE_MAPS)
def test_infinite_and_broken_radiance_on_the_cpu(name: str) -> None:
    """What :class:`moka.Image` shows of pixels that others made."""
    levels = [0.0, 65504.0, 3e38, np.inf, -np.inf, np.nan, -1.0]
    pixels = np.array([[level] * 3 for level in levels], np.float32)
    for exposure in (-64, 0, 64):
        shown = tone_map(pixels, name, exposure)
        assert np.isfinite(shown).all()
        assert shown.min() >= 0.0
        assert shown.max() <= 1.0
        assert np.allclose(shown[4:], shown[0])


def test_nearly_transparent_surfaces_keep_their_colour(
    egl_device: GraphicsDevice,
) -> None:
    """Alpha is divided out before it is encoded, however small it is."""
    for alpha in (0.0, 1e-30, 1e-7, 1e-3, 1.0):
        glass = Material(
            unlit=True,
            base_colour_factor=(1, 0.5, 0.25, alpha),
            alpha_mode=AlphaMode.BLEND,
        )
        scene = scene_of([(quad(2.0), glass, np.eye(4))], None, "transparent")
        for float_output in (True, False):
            for samples in (1, 4):
                radiance, display = draw_with_display(
                    egl_device,
                    scene,
                    square_camera(),
                    (2, 2),
                    tone_map="none",
                    float_output=float_output,
                    samples=samples,
                )
                assert np.isfinite(radiance).all()
                if alpha >= 1e-3:
                    expected = np.array([255, 188, 137])
                    got = display[0, 0, :3].astype(int)
                    assert np.abs(got - expected).max() <= 1


def test_averages_of_samples_stay_finite(egl_device: GraphicsDevice) -> None:
    """Sums of the largest values that targets hold are not infinite."""
    glow = Material(emissive_factor=(1e300, 1e30, 65504))
    scene = scene_of(
        [(sphere(0.8), glow, np.eye(4))],
        Environment(np.full((8, 16, 3), 1e30, np.float32)),
    )
    most = egl_device.info.max_samples
    for samples in {1, 2, most}:
        for float_output in (True, False):
            picture = draw_radiance(
                egl_device,
                scene,
                square_camera(),
                (8, 8),
                samples=samples,
                float_output=float_output,
            )
            assert np.isfinite(picture).all()
    picture = draw_radiance(
        egl_device,
        scene,
        square_camera(),
        (8, 8),
        ibl="reference",
        reference_samples=64,
        max_error=0.5,
    )
    assert np.isfinite(picture).all()


def test_the_error_of_extreme_light_is_a_number(
    egl_device: GraphicsDevice,
) -> None:
    """It goes into the statistics' JSON, which knows no NaN.

    Squares of less than 1e-15 and more than 1e15 are beyond float32, and
    such light is taken for even.
    """
    for radiance in (1e-30, 1e-12, 1e12, 1e20, 1e30):
        generator = np.random.default_rng(7)
        pixels = radiance * generator.uniform(0.1, 1.0, (8, 16, 3))
        scene = scene_of([(sphere(0.8), None, np.eye(4))], Environment(pixels))
        settings = RenderSettings(
            ibl="reference", reference_samples=128, max_error=0.01
        )
        renderer = Renderer(egl_device, (8, 8), settings)
        while True:
            commands = CommandList()
            renderer.draw(scene, square_camera(), commands)
            egl_device.submit(commands).wait()
            if renderer.is_complete:
                break
        error = renderer.lighting_statistics["estimated_error"]
        renderer.close()
        assert 0.0 <= error < 1.0, radiance
        if 1e-15 < radiance < 1e15:
            assert error > 0.0, radiance


@pytest.mark.parametrize("exposure", [-65, 65, np.inf, np.nan])
def test_an_exposure_beyond_all_is_refused(
    egl_device: GraphicsDevice, exposure: float
) -> None:
    with pytest.raises(OptionError, match="exposure"):
        draw_radiance(
            egl_device, scene_of([]), square_camera(), exposure=exposure
        )


def test_an_exr_file_keeps_what_half_floats_cannot(tmp_path: Path) -> None:
    model = tmp_path / "glow.glb"
    glow = Material(emissive_factor=(1e6, 0, 0))
    save_model(model_of([(quad(2.0), glow, np.eye(4))]), model)
    for extra, most in (((), 1e6), (("--half",), 65504.0)):
        output = tmp_path / "glow.exr"
        run = [*MOKA, "render", str(model), "-o", str(output), *extra]
        run += ["--size", "8x8", "--environment", "none"]
        subprocess.run(run, check=True)
        assert read_exr(output)[0][4, 4, 0] == pytest.approx(most)


SLOW = ["--size", "4096x4096", "--ibl", "reference"]
SLOW += ["--reference-samples", "100000"]


STARTED = "from moka.cli import main; print(flush=True); main()"


@pytest.mark.parametrize("delay", [0.1, 0.5, 3.0])
def test_control_c_ends_a_render_at_once(tmp_path: Path, delay: float) -> None:
    """While it imports, compiles or draws frames of many seconds."""
    output = tmp_path / "out.png"
    process = subprocess.Popen(
        [sys.executable, "-c", STARTED, "render", "-o", str(output), *SLOW],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(delay)
    process.send_signal(signal.SIGINT)
    start = time.monotonic()
    _, errors = process.communicate(timeout=30)
    # Half a second of it is ours, the rest a busy machine's.
    assert time.monotonic() - start < 2.0
    assert process.returncode == 130
    assert errors == "moka: error: interrupted\n"
    assert not list(tmp_path.iterdir())


def test_control_c_ends_a_device_without_waiting_for_its_work() -> None:
    from threading import Event

    from moka.backend.recording_backend import RecordingBackend

    is_done = Event()
    device = GraphicsDevice(RecordingBackend)

    def draw() -> None:
        with device:
            device._thread.post(lambda _: is_done.wait(20))
            raise KeyboardInterrupt

    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        draw()
    assert time.monotonic() - start < 5.0
    assert device.is_closed
    is_done.set()


@pytest.mark.parametrize("suffix", [".png", ".exr"])
def test_a_full_disk_is_named_and_nothing_is_left(
    tmp_path: Path, suffix: str
) -> None:
    """The limit on a file's size stands for the disk."""
    output = tmp_path / f"out{suffix}"
    # What the driver compiles is kept on disk too.
    environment = {**os.environ, "MESA_SHADER_CACHE_DISABLE": "true"}
    process = subprocess.run(
        [*MOKA, "render", "-o", str(output), "--size", "256x256", "--no-cache"],
        capture_output=True,
        text=True,
        env=environment,
        preexec_fn=lambda: resource.setrlimit(
            resource.RLIMIT_FSIZE, (4096, 4096)
        ),
    )
    assert process.returncode == 2
    assert process.stderr.startswith(f"moka: error: {output}: cannot write")
    assert process.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_reader_who_leaves_is_no_error(tmp_path: Path) -> None:
    model = tmp_path / "square.glb"
    save_model(model_of([(quad(2.0), None, np.eye(4))]), model)
    buffered = {**os.environ, "PYTHONUNBUFFERED": ""}
    for command, environment in itertools.product(
        (["info", str(model)], ["info", str(model), "--json"], ["--help"]),
        (buffered, {**buffered, "PYTHONUNBUFFERED": "1"}),
    ):
        reading, writing = os.pipe()
        os.close(reading)
        with open(writing, "wb") as pipe:
            process = subprocess.run(
                [*MOKA, *command],
                stdout=pipe,
                stderr=subprocess.PIPE,
                env=environment,
            )
        assert process.returncode == 0
        assert process.stderr == b""
