"""Images and samplers of a glTF document; nothing is decoded here.

Sources: glTF 2.0 specification, sections 3.8.3 (images) and 3.8.4
(samplers).
"""

from msgspec import Struct

from moka.commands.descriptors import (
    Filter,
    MipmapMode,
    SamplerDescriptor,
    Wrap,
)
from moka.core.encoded_image import EncodedImage
from moka.core.extras import is_installed
from moka.model import schema
from moka.model.schema import read_extension
from moka.model.source import GltfSource
from moka.model.uri import is_data_uri

__all__ = [
    "IMAGE_EXTENSIONS",
    "MAGNIFY",
    "MINIFY",
    "WRAPS",
    "ImageReader",
    "sampler_descriptor",
]

# The extensions of textures whose images are of these media types.
IMAGE_EXTENSIONS = {
    "image/ktx2": "KHR_texture_basisu",
    "image/avif": "EXT_texture_avif",
    "image/webp": "EXT_texture_webp",
}

# What the numbers in samplers mean, which are OpenGL's.
WRAPS = {
    10497: Wrap.REPEAT,
    33071: Wrap.CLAMP_TO_EDGE,
    33648: Wrap.MIRRORED_REPEAT,
}
MAGNIFY = {9728: Filter.NEAREST, 9729: Filter.LINEAR}
MINIFY = {
    9728: (Filter.NEAREST, MipmapMode.NONE),
    9729: (Filter.LINEAR, MipmapMode.NONE),
    9984: (Filter.NEAREST, MipmapMode.NEAREST),
    9985: (Filter.LINEAR, MipmapMode.NEAREST),
    9986: (Filter.NEAREST, MipmapMode.LINEAR),
    9987: (Filter.LINEAR, MipmapMode.LINEAR),
}
_LINEAR = 9729
_TRILINEAR = 9987


def sampler_descriptor(sampler: schema.Sampler) -> SamplerDescriptor:
    """What glTF says of a sampler; filters it leaves open are linear."""
    minify, mipmap = MINIFY[sampler.min_filter or _TRILINEAR]
    return SamplerDescriptor(
        wrap_s=WRAPS[sampler.wrap_s],
        wrap_t=WRAPS[sampler.wrap_t],
        magnify=MAGNIFY[sampler.mag_filter or _LINEAR],
        minify=minify,
        mipmap=mipmap,
    )


class _ImageSource(Struct, gc=False):
    """What those extensions hold: an image instead of the texture's own."""

    source: schema.Index | None = None


class ImageReader:
    """The images of one file, each of them one object however often used."""

    def __init__(self, source: GltfSource) -> None:
        self._source = source
        self._images: dict[int, EncodedImage] = {}

    def image(self, index: int) -> EncodedImage:
        """Image ``index``, still encoded; files are not opened.

        Raises ModelError if its URI or its buffer view is broken.
        """
        image = self._images.get(index)
        if image is None:
            image = self._images[index] = self._open(index)
        return image

    def of_texture(self, index: int) -> EncodedImage | None:
        """The image of texture ``index``; one of an extension comes first.

        None if only an extension that moka does not read has it, or if the
        file offers nothing. Raises ModelError as :meth:`image`.
        """
        texture = self._source.document.textures[index]
        path = f"textures[{index}]"
        place, image = f"{path}.source", texture.source
        for name in IMAGE_EXTENSIONS.values() if texture.extensions else ():
            extension = read_extension(
                texture, name, _ImageSource, self._source.where, path
            )
            if extension is None or extension.source is None:
                continue
            # Who has no decoder is served by the image that has no need of
            # it, if there is one.
            if (
                name == "KHR_texture_basisu"
                and texture.source is not None
                and not is_installed("opengl_basisu")
            ):
                continue
            place = f"{path}.extensions.{name}.source"
            image = extension.source
            break
        if image is None:
            return None
        self._source.check_index(
            place, image, "images", len(self._source.document.images)
        )
        return self.image(image)

    def _open(self, index: int) -> EncodedImage:
        source = self._source
        path = f"images[{index}]"
        image = source.document.images[index]
        where = f"{source.where}: {path}"
        if (image.uri is None) == (image.buffer_view is None):
            raise source.error(path, "needs either a uri or a bufferView")
        if image.buffer_view is not None:
            views = source.document.buffer_views
            source.check_index(
                f"{path}.bufferView",
                image.buffer_view,
                "bufferViews",
                len(views),
            )
            return EncodedImage(where, data=source.view(image.buffer_view))
        assert image.uri is not None
        if is_data_uri(image.uri):
            data = source.uri_data(f"{path}.uri", image.uri)
            return EncodedImage(where, data=data)
        file = source.uri_path(f"{path}.uri", image.uri)
        return EncodedImage(where, path=file)
