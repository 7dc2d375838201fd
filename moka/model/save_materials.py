"""From moka's materials to those of a glTF file that is being written."""

from typing import TYPE_CHECKING, Any

from moka.commands.descriptors import SamplerDescriptor
from moka.core.encoded_image import EncodedImage
from moka.core.errors import ModelError
from moka.core.image_header import media_type
from moka.material.material import (
    AlphaMode,
    Material,
    Texture,
    TextureTransform,
)
from moka.model.binary import BinaryWriter
from moka.model.images import IMAGE_EXTENSIONS, MAGNIFY, MINIFY, WRAPS

if TYPE_CHECKING:
    import pygltflib

__all__ = ["MaterialWriter"]

_WRAP_CODES = {wrap: code for code, wrap in WRAPS.items()}
_MAGNIFY_CODES = {magnify: code for code, magnify in MAGNIFY.items()}
_MINIFY_CODES = {minify: code for code, minify in MINIFY.items()}
_DEFAULT = Material()


class MaterialWriter:
    """Writes materials, each image, sampler and texture once."""

    def __init__(self, gltf: "pygltflib.GLTF2", binary: BinaryWriter) -> None:
        self._gltf = gltf
        self._binary = binary
        self._materials: dict[int, int] = {}
        self._images: dict[int, int] = {}
        self._samplers: dict[SamplerDescriptor, int] = {}
        self._textures: dict[tuple[int, int], int] = {}
        self.extensions: set[str] = set()
        self.required: set[str] = set()

    def material(self, material: Material) -> int:
        """The index of ``material``, written when first asked for.

        Raises ModelError if a texture is neither PNG nor JPEG nor what an
        extension of glTF holds, ImageFileError if its file is gone.
        """
        index = self._materials.get(id(material))
        if index is None:
            index = self._materials[id(material)] = len(self._gltf.materials)
            self._gltf.materials.append(self._write(material))
        return index

    def _write(self, material: Material) -> "pygltflib.Material":
        import pygltflib as gltf

        strength = max(1.0, *material.emissive_factor)
        extensions: dict[str, Any] = {}
        if strength > 1.0:
            extensions["KHR_materials_emissive_strength"] = {
                "emissiveStrength": strength
            }
        if material.unlit:
            extensions["KHR_materials_unlit"] = {}
        if material.ior != _DEFAULT.ior:
            extensions["KHR_materials_ior"] = {"ior": material.ior}
        specular = self._specular(material)
        if specular:
            extensions["KHR_materials_specular"] = specular
        self.extensions.update(extensions)
        masked = material.alpha_mode is AlphaMode.MASK
        return gltf.Material(
            name=material.name,
            extensions=extensions,
            pbrMetallicRoughness=gltf.PbrMetallicRoughness(
                baseColorFactor=list(material.base_colour_factor),
                metallicFactor=material.metallic_factor,
                roughnessFactor=material.roughness_factor,
                baseColorTexture=self._info(
                    gltf.TextureInfo, material.base_colour_texture
                ),
                metallicRoughnessTexture=self._info(
                    gltf.TextureInfo, material.metallic_roughness_texture
                ),
            ),
            normalTexture=self._info(
                gltf.NormalMaterialTexture,
                material.normal_texture,
                scale=material.normal_scale,
            ),
            occlusionTexture=self._info(
                gltf.OcclusionTextureInfo,
                material.occlusion_texture,
                strength=material.occlusion_strength,
            ),
            emissiveTexture=self._info(
                gltf.TextureInfo, material.emissive_texture
            ),
            emissiveFactor=[
                factor / strength for factor in material.emissive_factor
            ],
            alphaMode=material.alpha_mode.value,
            alphaCutoff=material.alpha_cutoff if masked else None,
            doubleSided=material.double_sided,
        )

    def _specular(self, material: Material) -> dict[str, Any]:
        """What KHR_materials_specular says where it is not the default."""
        import pygltflib

        result: dict[str, Any] = {}
        if material.specular_factor != _DEFAULT.specular_factor:
            result["specularFactor"] = material.specular_factor
        colour = material.specular_colour_factor
        if tuple(colour) != _DEFAULT.specular_colour_factor:
            result["specularColorFactor"] = list(colour)
        for name, texture in (
            ("specularTexture", material.specular_texture),
            ("specularColorTexture", material.specular_colour_texture),
        ):
            info = self._info(pygltflib.TextureInfo, texture)
            if info is not None:
                result[name] = {
                    key: value for key, value in vars(info).items() if value
                } | {"index": info.index}
        return result

    def _info(
        self, type_: Any, texture: Texture | None, **properties: float
    ) -> Any:
        """A reference to ``texture`` of pygltflib's ``type_``."""
        if texture is None:
            return None
        extensions = {}
        if texture.transform is not None:
            extensions["KHR_texture_transform"] = _transform(texture.transform)
        self.extensions.update(extensions)
        return type_(
            index=self._texture(texture),
            texCoord=texture.uv_set,
            extensions=extensions,
            **properties,
        )

    def _texture(self, texture: Texture) -> int:
        import pygltflib

        image, sampler = (
            self._image(texture.image),
            self._sampler(texture.sampler),
        )
        if (image, sampler) not in self._textures:
            self._textures[image, sampler] = len(self._gltf.textures)
            kind = self._gltf.images[image].mimeType
            name = IMAGE_EXTENSIONS.get(kind)
            self._gltf.textures.append(
                pygltflib.Texture(sampler=sampler, source=image)
                if name is None
                else pygltflib.Texture(
                    sampler=sampler, extensions={name: {"source": image}}
                )
            )
            if name is not None:
                self.extensions.add(name)
                self.required.add(name)
        return self._textures[image, sampler]

    def _image(self, image: EncodedImage) -> int:
        import pygltflib

        if id(image) not in self._images:
            data = image.read()
            kind = media_type(data)
            if kind is None:
                raise ModelError(
                    f"{image.where}: neither PNG nor JPEG nor what an "
                    "extension of glTF can hold"
                )
            self._images[id(image)] = len(self._gltf.images)
            self._gltf.images.append(
                pygltflib.Image(
                    bufferView=self._binary.view(data), mimeType=kind
                )
            )
        return self._images[id(image)]

    def _sampler(self, sampler: SamplerDescriptor) -> int:
        import pygltflib

        if sampler not in self._samplers:
            self._samplers[sampler] = len(self._gltf.samplers)
            self._gltf.samplers.append(
                pygltflib.Sampler(
                    wrapS=_WRAP_CODES[sampler.wrap_s],
                    wrapT=_WRAP_CODES[sampler.wrap_t],
                    magFilter=_MAGNIFY_CODES[sampler.magnify],
                    minFilter=_MINIFY_CODES[sampler.minify, sampler.mipmap],
                )
            )
        return self._samplers[sampler]


def _transform(transform: TextureTransform) -> dict[str, Any]:
    return {
        "offset": list(transform.offset),
        "rotation": transform.rotation,
        "scale": list(transform.scale),
    }
