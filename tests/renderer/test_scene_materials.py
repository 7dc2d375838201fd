"""What the materials of a scene ask of the pool of textures."""

from pathlib import Path

from moka.core.encoded_image import EncodedImage
from moka.renderer.scene_materials import _longest_first
from moka.renderer.texture_request import TextureRequest


def test_what_takes_longest_is_decoded_first(tmp_path: Path) -> None:
    """A file is as long as it is, one that is gone takes no time."""
    file = tmp_path / "image.png"
    file.write_bytes(bytes(30))
    images = {
        "gone": [EncodedImage("", path=tmp_path / "gone.png")],
        "embedded": [EncodedImage("", data=bytes(20))],
        "file": [EncodedImage("", path=file)],
        "two": [EncodedImage("", data=bytes(size)) for size in (15, 25)],
    }
    ordered = _longest_first(
        {
            TextureRequest(name, is_colour=False, has_levels=True): given
            for name, given in images.items()
        }
    )
    assert [request.identity for request in ordered] == [
        "two",
        "file",
        "embedded",
        "gone",
    ]
    assert [*ordered.values()] == [
        images[request.identity] for request in ordered
    ]
