"""The folder that is handed out, and the key that is not."""

import base64
import hashlib
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from moka.core.errors import ImageFileError, ModelError, OptionError
from moka.core.image import Image
from moka.core.picture_file import read_picture
from moka.core.png import write_png
from moka.survey.credits import collect_credits
from moka.survey.make import SurveyOptions, make_survey
from tests.survey.pictures import RENDERERS, SCENES, write_pictures

OPTIONS = SurveyOptions(title="A <title>")


@pytest.fixture
def pictures(tmp_path: Path) -> list[Path]:
    return write_pictures(tmp_path / "pictures")


def make(
    folder: Path, pictures: list[Path], options: SurveyOptions = OPTIONS
) -> dict[str, Any]:
    """Make a survey and return its key."""
    key = folder / "key.json"
    make_survey(pictures, folder / "out", key, options)
    found: dict[str, Any] = json.loads(key.read_text("utf-8"))
    return found


def page_data(page: str) -> dict[str, Any]:
    (text,) = re.findall(r'id="data">(.*?)</script>', page)
    found: dict[str, Any] = json.loads(text)
    return found


def test_the_key_names_every_picture(
    tmp_path: Path, pictures: list[Path]
) -> None:
    key = make(tmp_path, pictures)
    shown = {
        (each["scene"], each["renderer"]) for each in key["pictures"].values()
    }
    assert shown == {(scene, name) for scene in SCENES for name in RENDERERS}
    for name, each in key["pictures"].items():
        original = read_picture(tmp_path / "pictures" / each["file"])
        copy = read_picture(tmp_path / "out" / name)
        assert np.array_equal(copy.pixels, original.pixels)
        assert original.path.stem == f"{each['scene']}@{each['renderer']}"
    assert sorted(name for each in key["sets"] for name in each) == sorted(
        key["pictures"]
    )
    for each in key["sets"]:
        assert len({key["pictures"][name]["scene"] for name in each}) == 1


def test_the_folder_holds_nothing_that_tells(
    tmp_path: Path, pictures: list[Path]
) -> None:
    from PIL import Image as PillowImage
    from PIL.PngImagePlugin import PngInfo

    told = PngInfo()
    told.add_text("Software", "moka")
    with PillowImage.open(pictures[1]) as image:
        image.save(pictures[1], pnginfo=told)
    key = make(tmp_path, pictures)
    files = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert files == sorted([*key["pictures"], "index.html"])
    for path in (tmp_path / "out").iterdir():
        content = path.read_bytes()
        for word in (*RENDERERS, *SCENES):
            assert word.encode() not in content


def test_page_and_key_agree(tmp_path: Path, pictures: list[Path]) -> None:
    key = make(tmp_path, pictures)
    data = page_data((tmp_path / "out" / "index.html").read_text("utf-8"))
    assert data["survey"] == key["survey"]
    assert [
        [each["name"] for each in pictures] for pictures in data["sets"]
    ] == key["sets"]
    sizes = {
        (each["width"], each["height"])
        for pictures in data["sets"]
        for each in pictures
    }
    assert sizes == {(48, 32)}


def test_names_and_orders_are_drawn_anew_each_time(
    tmp_path: Path, pictures: list[Path]
) -> None:
    keys = []
    for number in range(8):
        folder = tmp_path / str(number)
        folder.mkdir()
        keys.append(make(folder, pictures))
    assert len({key["survey"] for key in keys}) == 8
    assert len({name for key in keys for name in key["pictures"]}) == 48
    orders = {
        tuple(
            key["pictures"][name]["file"]
            for names in key["sets"]
            for name in names
        )
        for key in keys
    }
    # 72 orders: all eight alike once in 72^7 runs.
    assert len(orders) > 1


def test_pairs(tmp_path: Path, pictures: list[Path]) -> None:
    key = make(tmp_path, pictures, SurveyOptions(title="", pairs=True))
    assert [len(each) for each in key["sets"]] == [2] * 6
    assert len({frozenset(each) for each in key["sets"]}) == 6


def test_the_policy_names_the_hashes_of_style_and_script(
    tmp_path: Path, pictures: list[Path]
) -> None:
    make(tmp_path, pictures)
    page = (tmp_path / "out" / "index.html").read_text("utf-8")
    for pattern in (r"<style>(.*?)</style>", r"<script>(.*?)</script>"):
        (text,) = re.findall(pattern, page, re.DOTALL)
        digest = hashlib.sha256(text.encode()).digest()
        assert f"'sha256-{base64.b64encode(digest).decode()}'" in page
    assert "{{" not in page
    assert "://" not in page


def test_texts_are_escaped(tmp_path: Path, pictures: list[Path]) -> None:
    notice = "One </script><b> & two.\n\nThe {{DATA}} of it."
    contact = "A & B <a@b>"
    options = SurveyOptions(title="<i>", notice=notice, contact=contact)
    make(tmp_path, pictures, options)
    page = (tmp_path / "out" / "index.html").read_text("utf-8")
    assert "<title>&lt;i&gt;</title>" in page
    assert "<p>One &lt;/script&gt;&lt;b&gt; &amp; two.</p>" in page
    assert "<p>The {{DATA}} of it.</p>" in page
    assert page.count("A &amp; B &lt;a@b&gt;") == 2


def test_what_is_transparent_shows_the_page(tmp_path: Path) -> None:
    clear = np.zeros((4, 4, 4), np.uint8)
    clear[:, :, :3] = 200
    half = clear.copy()
    half[:, :, 3] = 128
    for name, pixels in (("a@x", clear), ("a@y", half)):
        write_png(tmp_path / f"{name}.png", pixels)
    paths = [tmp_path / "a@x.png", tmp_path / "a@y.png"]
    key = make(tmp_path, paths)
    for name, each in key["pictures"].items():
        pixel = read_picture(tmp_path / "out" / name).pixels[0, 0] * 255
        part = 0 if each["renderer"] == "x" else 128 / 255
        expected = part * 200 + (1 - part) * 0x2E
        assert pixel == pytest.approx([expected] * 3 + [255], abs=0.51)


def test_radiance_is_shown_as_it_is_rendered(tmp_path: Path) -> None:
    pixels = np.full((4, 4, 4), 1.0, np.float32)
    pixels[:, :, 0] = 3.0
    image = Image(pixels, tone_map="aces", exposure=-1.0)
    image.save(tmp_path / "a@x.exr")
    image.save(tmp_path / "a@y.png")
    options = SurveyOptions(title="", tone_map="aces", exposure=-1.0)
    make(tmp_path, [tmp_path / "a@x.exr", tmp_path / "a@y.png"], options)
    first, second = (tmp_path / "out").glob("*.png")
    assert first.read_bytes() == second.read_bytes()


def test_credits_from_metadata_models_and_text(tmp_path: Path) -> None:
    from PIL import Image as PillowImage
    from PIL.PngImagePlugin import PngInfo

    image = PillowImage.new("RGB", (4, 4))
    text = PngInfo()
    text.add_text("Author", "Ada")
    text.add_itxt("Copyright", "© Ada")
    text.add_text("Software", "secret")
    image.save(tmp_path / "a.png", pnginfo=text)
    exif = PillowImage.Exif()
    exif[0x8298] = "(c) Bob"
    image.save(tmp_path / "b.jpg", exif=exif)
    Image(np.ones((4, 4, 4), np.float32)).save(tmp_path / "c.exr")
    model = tmp_path / "m.gltf"
    model.write_text('{"asset": {"version": "2.0", "copyright": "CC0 M"}}')
    lines = tmp_path / "credits.txt"
    lines.write_text("Carol\n\nCC0 M\n")
    found = collect_credits(
        [tmp_path / name for name in ("a.png", "b.jpg", "c.exr")],
        [model, lines],
    )
    assert found == ["(c) Bob", "Ada", "CC0 M", "Carol", "© Ada"]


def test_credits_stand_in_a_file_and_on_the_page(
    tmp_path: Path, pictures: list[Path]
) -> None:
    lines = tmp_path / "credits.txt"
    lines.write_text("Model by <A>\n")
    make(tmp_path, pictures, SurveyOptions(title="", credits=[lines]))
    out = tmp_path / "out"
    assert (out / "credits.txt").read_text() == "Model by <A>\n"
    assert "<li>Model by &lt;A&gt;</li>" in (out / "index.html").read_text()


@pytest.mark.parametrize(
    ("name", "content", "error", "message"),
    [
        ("none.txt", None, OptionError, "cannot read the credits: No such"),
        ("bad.txt", b"\xff", OptionError, "is not UTF-8"),
        ("bad.gltf", b"{", ModelError, "not valid JSON"),
        ("bad.glb", b"nonsense", ModelError, "neither a .glb"),
        (
            "bad.gltf",
            b'{"asset": {"copyright": 1}}',
            ModelError,
            "asset.copyright: is not a string",
        ),
    ],
)
def test_broken_credits_are_an_error(
    name: str,
    content: bytes | None,
    error: type[Exception],
    message: str,
    tmp_path: Path,
) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(error, match=message):
        collect_credits([], [path])


def test_nothing_is_left_after_a_mistake(
    tmp_path: Path, pictures: list[Path]
) -> None:
    write_png(pictures[4], np.zeros((8, 8), np.uint8))
    with pytest.raises(OptionError, match=r"is 8 x 8, but .* is 48 x 32"):
        make(tmp_path, pictures)
    pictures[4].write_bytes(b"\x89PNG\r\n\x1a\nbroken")
    with pytest.raises(ImageFileError):
        make(tmp_path, pictures)
    assert [path.name for path in tmp_path.iterdir()] == ["pictures"]


def test_targets_must_be_new_and_apart(
    tmp_path: Path, pictures: list[Path]
) -> None:
    new = tmp_path / "new"
    for folder, key, message in (
        (tmp_path, new, "exists already"),
        (new, pictures[0], "exists already"),
        (new, new / "key.json", "the folder .* is missing"),
        (tmp_path / "no" / "new", tmp_path / "key", "is missing"),
    ):
        with pytest.raises(OptionError, match=message):
            make_survey(pictures, folder, key, OPTIONS)
    assert not new.exists()
    assert pictures[0].exists()
