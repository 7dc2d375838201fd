"""Images and samplers of a glTF document; nothing is decoded here.

Sources: glTF 2.0 specification, sections 3.8.3 (images) and 3.8.4
(samplers).
"""

from moka.commands.descriptors import (
    Filter,
    MipmapMode,
    SamplerDescriptor,
    Wrap,
)
from moka.core.encoded_image import EncodedImage
from moka.model import schema
from moka.model.source import GltfSource
from moka.model.uri import is_data_uri

__all__ = ["MAGNIFY", "MINIFY", "WRAPS", "ImageReader", "sampler_descriptor"]

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
