"""``moka compare``: numbers, difference pictures, exit codes, errors."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from moka.cli.main import main
from moka.core.exr import read_exr, write_exr
from moka.core.image import Image
from moka.core.picture_file import read_picture
from moka.core.png import write_png

PLAIN = "psnr,rmse,rel-rmse"


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def codes(seed: int, channels: int = 3) -> np.ndarray:
    generator = np.random.default_rng(seed)
    return generator.integers(0, 256, (12, 16, channels), np.uint8)


def radiance(seed: int) -> np.ndarray:
    pixels = np.random.default_rng(seed).random((12, 16, 4)) * 5
    pixels[:, :, 3] = 1
    return pixels.astype(np.float32)


def compared(
    capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0
) -> dict[str, Any]:
    assert main(["compare", *arguments, "--json"]) == code
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


def error(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(["compare", *arguments]) == 2
    printed = capsys.readouterr()
    assert not printed.out
    assert printed.err.startswith("moka: error: ")
    assert printed.err.count("\n") == 1
    return printed.err


@pytest.mark.parametrize("suffix", [".png", ".exr"])
def test_equal_pictures(
    suffix: str, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("flip_evaluator")
    Image(radiance(1)).save(f"a{suffix}")
    assert main(["compare", f"a{suffix}", f"a{suffix}"]) == 0
    assert capsys.readouterr().out == (
        "flip     0\npsnr     inf dB\nrmse     0\n"
    )
    found = compared(capsys, f"a{suffix}", f"a{suffix}")
    # JSON has no infinity.
    assert found["metrics"] == {"flip": 0.0, "psnr": None, "rmse": 0.0}


def test_a_known_difference_for_displays(
    capsys: pytest.CaptureFixture[str],
) -> None:
    first = codes(1)
    second = first.copy()
    second[:6] ^= 0b1000  # each differs by 8 codes in half of the picture
    write_png("a.png", first)
    write_png("b.png", second)
    found = compared(capsys, "a.png", "b.png", "--metric", PLAIN)
    error = math.sqrt(0.5) * 8 / 255
    power = math.sqrt(np.mean((first / 255.0) ** 2))
    assert found["size"] == [16, 12]
    assert found["space"] == "display"
    assert found["metrics"] == {
        "psnr": pytest.approx(-20 * math.log10(error)),
        "rmse": pytest.approx(error),
        "rel-rmse": pytest.approx(error / power),
    }


def test_a_known_difference_of_radiance(
    capsys: pytest.CaptureFixture[str],
) -> None:
    first = radiance(1)
    second = first.copy()
    second[:, :, :3] += 0.25
    write_exr("a.exr", first)
    write_exr("b.exr", second)
    found = compared(capsys, "a.exr", "b.exr", "--metric", PLAIN)
    peak = first[:, :, :3].max()
    power = math.sqrt(np.mean(np.square(first[:, :, :3], dtype=np.float64)))
    assert found["space"] == "radiance"
    assert found["metrics"] == {
        "psnr": pytest.approx(20 * math.log10(peak / 0.25), abs=1e-4),
        "rmse": pytest.approx(0.25, rel=1e-6),
        "rel-rmse": pytest.approx(0.25 / power, rel=1e-6),
    }


def test_an_exr_is_shown_as_render_would_to_meet_a_png(
    capsys: pytest.CaptureFixture[str],
) -> None:
    image = Image(radiance(1), tone_map="aces", exposure=-1.0)
    image.save("a.png")
    image.save("a.exr")
    options = ["--metric", "rmse", "--tone-map", "aces", "--exposure=-1"]
    for pair in (("a.png", "a.exr"), ("a.exr", "a.png")):
        found = compared(capsys, *pair, *options)
        assert found["space"] == "display"
        assert found["metrics"]["rmse"] == 0.0
    found = compared(capsys, "a.png", "a.exr", "--metric", "rmse")
    assert found["metrics"]["rmse"] > 0.01


def test_what_is_transparent_has_no_colour(
    capsys: pytest.CaptureFixture[str],
) -> None:
    first, second = codes(1, 4), codes(2, 4)
    first[:, :, 3] = second[:, :, 3] = 0
    write_png("a.png", first)
    write_png("b.png", second)
    found = compared(capsys, "a.png", "b.png", "--metric", "rmse,psnr")
    assert found["metrics"] == {"rmse": 0.0, "psnr": None}


def test_a_difference_of_alpha_counts(
    capsys: pytest.CaptureFixture[str],
) -> None:
    pytest.importorskip("flip_evaluator")
    black = np.zeros((12, 16, 4), np.uint8)
    opaque = black.copy()
    opaque[:, :, 3] = 255
    write_png("a.png", opaque)
    write_png("b.png", black)
    found = compared(capsys, "a.png", "b.png", "--metric", "flip,rmse")
    # One of four values is off by 1; over white it is black against white.
    assert found["metrics"]["rmse"] == 0.5
    assert found["metrics"]["flip"] > 0.9


def test_grey_and_16_bits_and_jpeg_are_read(
    capsys: pytest.CaptureFixture[str],
) -> None:
    from PIL import Image as PillowImage

    grey = codes(1, 1)[:, :, 0]
    write_png("grey.png", grey)
    write_png("rgb.png", np.repeat(grey[:, :, None], 3, axis=2))
    deep = PillowImage.fromarray(grey.astype(np.uint16) * 257)
    deep.save("deep.png")
    PillowImage.fromarray(np.full((12, 16, 3), 90, np.uint8)).save("flat.jpg")
    for other in ("rgb.png", "deep.png"):
        found = compared(capsys, "grey.png", other, "--metric", "rmse")
        assert found["metrics"]["rmse"] == 0.0
    assert read_picture("flat.jpg").pixels[0, 0].tolist() == pytest.approx(
        [90 / 255] * 3 + [1], abs=1 / 255
    )


def test_limits_decide_the_exit_code(
    capsys: pytest.CaptureFixture[str],
) -> None:
    write_png("a.png", codes(1))
    write_png("b.png", codes(2))
    pair = ["compare", "a.png", "b.png", "--metric", "psnr,rmse"]
    assert main([*pair, "--max", "rmse=0.9", "--min", "psnr=1"]) == 0
    capsys.readouterr()
    assert main([*pair, "--max", "rmse=0.1", "--min", "psnr=1"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].endswith(" dB")
    assert lines[1].endswith("  above 0.1")
    found = compared(capsys, *pair[1:], "--min", "psnr=50", code=1)
    assert found["exceeded"] == ["psnr"]


def test_the_difference_is_absolute_without_flip() -> None:
    first, second = codes(1), codes(2)
    write_png("a.png", first)
    write_png("b.png", second)
    pair = ["compare", "a.png", "b.png", "--metric", "rmse", "--diff"]
    assert main([*pair, "diff.png"]) == 0
    assert main([*pair, "diff.exr"]) == 0
    expected = np.abs(first.astype(int) - second.astype(int))
    shown = read_picture("diff.png").pixels[:, :, :3] * 255
    assert np.abs(shown - expected).max() < 1e-3
    values, _ = read_exr("diff.exr")
    assert np.abs(values[:, :, :3] * 255 - expected).max() < 1e-3


def test_the_difference_of_radiance_is_srgb_encoded() -> None:
    first = radiance(1)
    second = first.copy()
    second[:, :, 0] += 0.5
    write_exr("a.exr", first)
    write_exr("b.exr", second)
    arguments = ["a.exr", "b.exr", "--metric", "rmse", "--diff", "diff.png"]
    assert main(["compare", *arguments]) == 0
    shown = read_picture("diff.png").pixels[0, 0]
    assert shown.tolist() == pytest.approx([188 / 255, 0, 0, 1], abs=1e-6)


def test_the_difference_is_the_map_of_flip(
    capsys: pytest.CaptureFixture[str],
) -> None:
    pytest.importorskip("flip_evaluator")
    pytest.importorskip("matplotlib")
    from moka.bench.flip import magma

    write_png("a.png", codes(1))
    write_png("b.png", codes(2))
    found = compared(capsys, "a.png", "b.png", "--diff", "diff.exr")
    compared(capsys, "a.png", "b.png", "--diff", "diff.png")
    errors, _ = read_exr("diff.exr")
    assert errors[:, :, 0].mean() == pytest.approx(found["metrics"]["flip"])
    shown = read_picture("diff.png").pixels[:, :, :3] * 255
    assert np.abs(shown - magma(errors[:, :, 0])).max() < 1e-3


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("a.png", "none.png"), "none.png: cannot read the picture: No such"),
        (("a.png", "."), ".: cannot read pictures of this kind; use .png"),
        (("a.png", "a.gif"), "a.gif: cannot read pictures of this kind"),
        (("a.png", "broken.png"), "broken.png: cannot decode the image"),
        (("a.exr", "broken.exr"), "broken.exr: not a readable EXR file"),
        (("a.exr", "nan.exr"), "not finite: 1, the first in column 3 of row 2"),
        (("a.png", "small.png"), "small.png: is 2 x 3, but a.png is 16 x 12"),
        (("a.png", "a.png", "--metric", "ssim"), "unknown metric 'ssim'"),
        (("a.png", "a.png", "--max", "rmse"), "is not METRIC=VALUE"),
        (("a.png", "a.png", "--max", "rel-rmse=1"), "not among the metrics"),
        (("a.png", "a.png", "--max", "psnr=1"), "use --min"),
        (("a.png", "a.png", "--min", "rmse=1"), "use --max"),
        (("a.png", "a.png", "--diff", "d.gif"), "the ending .png or .exr"),
        (("a.png", "a.exr", "--tone-map", "x"), "unknown tone map 'x'"),
        (("a.png", "a.png", "--exposure", "nan"), "must be finite"),
        (
            ("a.png", "a.png", "--metric", "rmse", "--diff", "no/d.png"),
            "no/d.png: cannot write the image",
        ),
    ],
)
def test_a_mistake_is_one_line(
    arguments: tuple[str, ...],
    message: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    write_png("a.png", codes(1))
    write_png("small.png", codes(1)[:3, :2])
    data = Path("a.png").read_bytes()
    Path("broken.png").write_bytes(data[: len(data) // 2])
    pixels = radiance(1)
    write_exr("a.exr", pixels)
    data = Path("a.exr").read_bytes()
    Path("broken.exr").write_bytes(data[: len(data) // 2])
    pixels[2, 3, 1] = np.nan
    write_exr("nan.exr", pixels)
    assert message in error(capsys, *arguments)
