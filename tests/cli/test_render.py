"""moka render: options, outputs, and one line for every fault."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as PillowImage

from moka.cli import main
from moka.core.exr import read_exr
from moka.core.png import encode_png
from moka.core.tone_map import tone_map
from moka.material.material import Material
from moka.model import model_of, quad, save_model


def fail(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """The one line that a failing command prints."""
    assert main(["render", *arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("moka: error: ")
    assert captured.err.count("\n") == 1
    assert "Traceback" not in captured.err
    return captured.err.removeprefix("moka: error: ").strip()


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A red unlit square."""
    path = tmp_path / "square.glb"
    red = Material(unlit=True, base_colour_factor=(1, 0, 0, 1))
    save_model(model_of([(quad(2.0), red, np.eye(4))]), path)
    return path


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--size", "12"], "'12' is not WIDTHxHEIGHT"),
        (["--size", "0x4"], "each side must be from 1"),
        (["--size", "99999x4"], "each side must be from 1"),
        (["--exposure", "bright"], "'bright' is not a number"),
        (["--exposure", "inf"], "not a finite number"),
        (["--exposure", "1000"], "not between -64 and 64"),
        (["--samples", "0"], "is not 1, 2, 3"),
        (["--samples", "1000"], "not between 1 and 64"),
        (["--tone-map", "film"], "'film' is unknown; choose from neutral"),
        (["--brdf", "phong"], "'phong' is unknown; choose from gltf"),
        (["--diffuse", "silk"], "'silk' is unknown; choose from lambert"),
        (["--multiscatter", "maybe"], "invalid choice: 'maybe'"),
        (["--backend", "metal"], "invalid choice: 'metal'"),
        (["--environment-intensity", "-1"], "must not be negative"),
        (["--bogus"], "unrecognized arguments: --bogus"),
    ],
)
def test_a_bad_option_is_named(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    arguments: list[str],
    message: str,
) -> None:
    output = tmp_path / "out.png"
    assert message in fail(capsys, "-o", str(output), *arguments)
    assert not output.exists()


@pytest.mark.parametrize("name", ["picture.jpg", "picture", "picture.tiff"])
def test_an_unknown_output_is_refused_before_the_work(
    capsys: pytest.CaptureFixture[str], name: str
) -> None:
    assert fail(capsys, "missing.glb", "-o", name) == (
        f"{name}: the output needs the ending .png or .exr"
    )


def test_a_missing_folder_is_named(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    output = tmp_path / "nowhere" / "out.png"
    assert "the folder" in fail(capsys, "-o", str(output))
    stats = tmp_path / "nowhere" / "out.json"
    fail(capsys, "-o", str(tmp_path / "a.png"), "--stats", str(stats))


def broken_files(folder: Path, model: Path) -> dict[str, Path]:
    """Models that cannot be drawn, by what is wrong with them."""
    whole = model.read_bytes()
    contents = {
        "empty.glb": b"",
        "cut.glb": whole[: len(whole) // 2],
        "magic.glb": b"nope" + whole[4:],
        "version.glb": whole[:4] + struct.pack("<I", 7) + whole[8:],
        "text.gltf": b"{ not json",
        "version.gltf": b'{"asset": {"version": "1.0"}}',
        "reference.gltf": json.dumps(
            {
                "asset": {"version": "2.0"},
                "nodes": [{"mesh": 5}],
                "scenes": [{"nodes": [0]}],
            }
        ).encode(),
        "required.gltf": json.dumps(
            {
                "asset": {"version": "2.0"},
                "extensionsRequired": ["ACME_magic"],
                "extensionsUsed": ["ACME_magic"],
            }
        ).encode(),
    }
    paths = {}
    for name, content in contents.items():
        paths[name] = folder / name
        paths[name].write_bytes(content)
    return paths


def test_broken_models_are_one_line_that_names_the_file(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, model: Path
) -> None:
    output = tmp_path / "out.png"
    for name, path in broken_files(tmp_path, model).items():
        line = fail(capsys, str(path), "-o", str(output))
        assert name in line
        assert not output.exists()
    assert "missing.glb" in fail(capsys, "missing.glb", "-o", str(output))
    assert "ACME_magic" in fail(
        capsys, str(tmp_path / "required.gltf"), "-o", str(output)
    )


@pytest.mark.gpu
def test_broken_environments_are_one_line_that_names_the_file(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, model: Path
) -> None:
    output = tmp_path / "out.png"
    for name, content in {
        "empty.hdr": b"",
        "header.hdr": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n",
        "square.hdr": b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n"
        + bytes(16),
        "noise.exr": b"not an exr file at all",
        "sky.bmp": b"BM",
    }.items():
        path = tmp_path / name
        path.write_bytes(content)
        line = fail(
            capsys, str(model), "--environment", str(path), "-o", str(output)
        )
        assert name in line
        assert not output.exists()


@pytest.mark.gpu
def test_a_broken_image_is_one_line_that_names_it(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    from moka.core.encoded_image import EncodedImage
    from moka.material.material import Texture

    texels = np.full((8, 8, 3), 90, np.uint8)
    data = encode_png(texels)[:-30]
    material = Material(
        base_colour_texture=Texture(EncodedImage("image", data=data))
    )
    path = tmp_path / "broken.glb"
    save_model(model_of([(quad(2.0), material, np.eye(4))]), path)
    output = tmp_path / "out.png"
    line = fail(capsys, str(path), "-o", str(output))
    assert "broken.glb: images[0]" in line
    assert not output.exists()


@pytest.mark.gpu
def test_one_render_writes_several_files_and_statistics(
    tmp_path: Path, model: Path
) -> None:
    png, exr, half = (tmp_path / name for name in ("a.png", "b.exr", "c.EXR"))
    stats = tmp_path / "stats.json"
    arguments = ["render", str(model), "--size", "16x8"]
    arguments += ["--background", "#102030", "--environment", "none"]
    arguments += ["--stats", str(stats), "--tone-map", "aces"]
    for path in (png, exr, half):
        arguments += ["-o", str(path)]
    assert main(arguments) == 0

    pixels = read_exr(exr)[0]
    assert pixels.shape == (8, 16, 4)
    assert pixels.dtype == np.float32
    assert pixels[4, 8].tolist() == [1, 0, 0, 1]
    display = np.asarray(PillowImage.open(png).convert("RGB"))
    assert display.shape == (8, 16, 3)
    assert display[0, 0].tolist() == [0x10, 0x20, 0x30]
    red = tone_map(np.array([[[1.0, 0, 0]]]), "aces")
    encoded = np.where(
        red <= 0.0031308, red * 12.92, 1.055 * red ** (1 / 2.4) - 0.055
    )
    assert np.abs(display[4, 8] - 255 * encoded[0, 0]).max() <= 1

    content = json.loads(stats.read_text())
    assert {"moka", "gl", "stages_ms", "total_ms", "counts"} <= set(content)
    stages = content["stages_ms"]
    assert {
        "import",
        "parse",
        "context",
        "compile",
        "upload",
        "frame",
        "readback",
        "encode",
    } <= set(stages)
    assert "environment" not in stages
    assert all(value >= 0 for value in stages.values())
    counts = content["counts"]
    assert counts["objects"] == counts["visible"] == 1
    assert counts["programs"] == 1
    assert counts["textures_loaded"] == 0


@pytest.mark.gpu
def test_exposure_brightens_the_png_and_not_the_exr(
    tmp_path: Path, model: Path
) -> None:
    pictures = {}
    for stops in (0, -2):
        png, exr = tmp_path / f"{stops}.png", tmp_path / f"{stops}.exr"
        arguments = ["render", str(model), "--size", "8x8", "-o", str(png)]
        arguments += ["-o", str(exr), "--exposure", str(stops)]
        arguments += ["--tone-map", "none", "--environment", "none"]
        assert main(arguments) == 0
        pictures[stops] = (
            int(np.asarray(PillowImage.open(png))[4, 4, 0]),
            float(read_exr(exr)[0][4, 4, 0]),
        )
    assert pictures[0] == (255, 1.0)
    encoded = round(255 * (1.055 * 0.25 ** (1 / 2.4) - 0.055))
    assert pictures[-2] == (encoded, 1.0)


@pytest.mark.gpu
@pytest.mark.parametrize("backend", ["egl", "osmesa"])
def test_the_backend_that_is_asked_for_draws(
    tmp_path: Path, model: Path, backend: str
) -> None:
    stats = tmp_path / "stats.json"
    arguments = ["render", str(model), "-o", str(tmp_path / "a.png")]
    arguments += ["--size", "8x8", "--backend", backend]
    assert main([*arguments, "--stats", str(stats)]) == 0
    assert json.loads(stats.read_text())["gl"]["backend"] == backend


@pytest.mark.gpu
def test_a_failed_write_leaves_no_file_behind(
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    model: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The second file cannot be written, so the first does not appear."""

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("moka.core.exr.store_exr", full)
    png, exr = tmp_path / "out.png", tmp_path / "out.exr"
    line = fail(
        capsys,
        str(model),
        "--size",
        "8x8",
        "-o",
        str(png),
        "-o",
        str(exr),
    )
    assert line == f"{exr}: cannot write the image: No space left on device"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["square.glb"]


def test_an_internal_error_is_one_line_and_exit_code_1(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def crash(*_: object) -> None:
        raise ZeroDivisionError("oh no")

    monkeypatch.setattr("moka.cli.render._check_outputs", crash)
    assert main(["render"]) == 1
    captured = capsys.readouterr()
    assert captured.err.count("\n") == 1
    assert "internal error: ZeroDivisionError: oh no" in captured.err
    assert main(["render", "--debug"]) == 1
    assert "Traceback" in capsys.readouterr().err
