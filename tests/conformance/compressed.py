"""Compressed geometry and compressed images."""

import io
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pygltflib
from PIL import Image

from tests.conformance.case import SIZE, Case
from tests.conformance.painting import (
    Array,
    black,
    inside,
    paint,
    srgb_to_linear,
)
from tests.conformance.scene_file import SceneFile
from tests.support.bump_scenes import bump_by_geometry
from tests.support.compressed import with_draco, with_meshopt
from tests.support.ktx2_files import FILES, KTX2_PICTURE, ktx2_file

__all__ = ["COMPRESSED"]

_NEAREST = {"magFilter": 9728, "minFilter": 9728}


def _file_of(compress: Callable[[Path], bytes]) -> bytes:
    """The bump of 18 432 triangles, compressed."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bump.glb"
        bump_by_geometry().save(str(path))
        return compress(path)


def shown(image: bytes, mime: str, extension: str) -> bytes:
    """A square with an image that an extension brings."""
    file = SceneFile()
    file.uses(extension)
    source = file.image(image, mime)
    file.gltf.samplers = [pygltflib.Sampler(**_NEAREST)]
    file.gltf.textures = [
        pygltflib.Texture(sampler=0, extensions={extension: {"source": source}})
    ]
    material = file.material(texture=0)
    file.node(file.square(material), scale=[0.8, 0.4, 1])
    return file.glb()


def painted(x: Array, y: Array) -> Array:
    """The blocks that were encoded, without their alpha."""
    height, width, _ = KTX2_PICTURE.shape
    column = np.clip((x / 0.8 + 1) / 2 * width, 0, width - 1).astype(int)
    row = np.clip((1 - y / 0.4) / 2 * height, 0, height - 1).astype(int)
    texels = srgb_to_linear(KTX2_PICTURE[row, column, :3] / 255)
    return paint(black(x), inside(x, y, (0, 0), (0.8, 0.4)), texels)


def _encoded(kind: str, **options: Any) -> bytes:
    buffer = io.BytesIO()
    image = Image.fromarray(np.ascontiguousarray(KTX2_PICTURE[..., :3]))
    image.save(buffer, kind, **options)
    return buffer.getvalue()


_LIT = {"environment": "studio", "environment_intensity": 0.4}
_BUMP = "the bump of the normal maps, of 18 432 triangles"
_PICTURE = "eight blocks of colour"

COMPRESSED = [
    Case(
        "EXT_meshopt_compression",
        _BUMP,
        "the file that is not compressed",
        lambda: _file_of(with_meshopt),
        plain=bump_by_geometry,
        options=_LIT,
    ),
    Case(
        "KHR_draco_mesh_compression",
        _BUMP + ", with 14 bits a position",
        "the file that is not compressed",
        lambda: _file_of(with_draco),
        plain=bump_by_geometry,
        options=_LIT,
        allowed=1 / SIZE,
    ),
    *(
        Case(
            f"KHR_texture_basisu, {name}",
            _PICTURE,
            "painted: what was encoded",
            partial(shown, ktx2_file(name), "image/ktx2", "KHR_texture_basisu"),
            painted,
            tolerance=0.04 if "etc1s" in name else 2e-3,
        )
        for name in FILES
    ),
    Case(
        "EXT_texture_webp",
        _PICTURE,
        "painted: what was encoded, without loss",
        lambda: shown(
            _encoded("WEBP", lossless=True), "image/webp", "EXT_texture_webp"
        ),
        painted,
    ),
    Case(
        "EXT_texture_avif",
        _PICTURE,
        "painted: what was encoded, with little loss",
        lambda: shown(
            _encoded("AVIF", quality=95, subsampling="4:4:4"),
            "image/avif",
            "EXT_texture_avif",
        ),
        painted,
        tolerance=0.02,
    ),
]
