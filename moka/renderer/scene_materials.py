"""What the materials of a scene ask for: descriptions and textures.

Apart from everything that draws, so that images begin to decode before the
rest of the renderer is imported.
"""

from collections.abc import Iterable, Sequence
from copy import copy

from msgspec.structs import replace

from moka.commands.descriptors import MipmapMode
from moka.core.encoded_image import EncodedImage
from moka.core.image_header import image_media_type
from moka.material.description import (
    Feature,
    MaterialDescription,
    describe_material,
)
from moka.material.material import AlphaMode, Material, Texture
from moka.material.sampled_textures import moves, texture_slots
from moka.model.mesh import Primitive
from moka.renderer.sampled_levels import SampledLevels, StillPicture
from moka.renderer.texture_request import (
    Bumps,
    Coverage,
    Graft,
    TextureRequest,
    texture_request,
)
from moka.renderer.texture_settings import TextureSettings
from moka.renderer.textures import TexturePool

__all__ = ["SceneMaterials"]

_DEFAULT_MATERIAL = Material(name="glTF default")
_DEFAULT_SETTINGS = TextureSettings()


# Which channel of which slot glTF 2.0, 3.9.2 and 3.9.3, has each value in.
_CARRIED = {
    "occlusion": ("occlusion", 0),
    "roughness": ("metallic_roughness", 1),
    "metalness": ("metallic_roughness", 2),
}


class SceneMaterials:
    """Descriptions of the primitives' materials, and their textures begun.

    Made first, so that images decode while everything else goes on. With
    ``picture`` only what it shows is there: ``drawn`` holds the positions
    among ``primitives`` of those that the other lists are about.
    ``requests`` and ``textures`` are what is bound of each, by slot.
    """

    def __init__(
        self,
        primitives: Sequence[Primitive],
        textures: TexturePool,
        picture: StillPicture | None = None,
        settings: TextureSettings = _DEFAULT_SETTINGS,
    ) -> None:
        self.drawn: Sequence[int] = (
            range(len(primitives)) if picture is None else picture.drawn
        )
        self.materials: list[Material] = []
        self.descriptions: list[MaterialDescription] = []
        self.requests: list[dict[str, TextureRequest]] = []
        self.textures: list[dict[str, Texture]] = []
        images: dict[TextureRequest, list[EncodedImage]] = {}
        reads: dict[TextureRequest, list[tuple[int, Texture]]] = {}
        moving: set[TextureRequest] = set()
        known: dict[
            tuple[Material, tuple[str, ...], object, frozenset[str]],
            tuple[MaterialDescription, dict[str, TextureRequest]],
        ] = {}
        alone = _images_of_their_own(
            primitives[index].material or _DEFAULT_MATERIAL
            for index in self.drawn
        )
        for index in self.drawn:
            primitive = primitives[index]
            material = primitive.material or _DEFAULT_MATERIAL
            key = (
                material,
                tuple(primitive.attributes),
                primitive.topology,
                primitive.morphed,
            )
            if key not in known:
                description = describe_material(
                    material,
                    primitive.attributes,
                    primitive.topology,
                    morphed=primitive.morphed,
                    carries=alone.issuperset(_images(material)),
                )
                if settings.specular_aa and _keeps_bumps(material, description):
                    description = replace(
                        description,
                        features=description.features | Feature.NORMAL_VARIANCE,
                    )
                known[key] = (
                    description,
                    _requests(material, description, picture, settings, images),
                )
            description, requests = known[key]
            self.materials.append(material)
            self.descriptions.append(description)
            self.requests.append(requests)
            slots = texture_slots(material)
            sampled = {slot: settings.sampled(slots[slot]) for slot in requests}
            self.textures.append(sampled)
            for slot, request in requests.items():
                reads.setdefault(request, []).append((index, sampled[slot]))
                if moves(material, slot):
                    moving.add(request)
        # Coordinates that animations move are not those of the file.
        levels = {
            request: SampledLevels(picture, read)
            for request, read in reads.items()
            if picture is not None and request not in moving
        }
        textures.begin(_longest_first(images), levels)
        # By identity: embedded images need not be hashed to be left out.
        self.sampled = {id(each) for given in images.values() for each in given}

    def without_blending(self) -> "SceneMaterials":
        """The same where a surface has to be there or not.

        What is blended counts from half coverage on: glTF's default for the
        cutoff of a mask, and so what the rows of these materials say.
        """
        opaque = copy(self)
        opaque.descriptions = [
            replace(
                description,
                features=description.features & ~Feature.ALPHA_BLEND
                | Feature.ALPHA_MASK,
            )
            if description.is_blended
            else description
            for description in self.descriptions
        ]
        return opaque

    @property
    def are_alike(self) -> bool:
        """Whether all ask for one program and sample the same textures."""
        return all(
            each == listed[0]
            for listed in (self.descriptions, self.requests, self.textures)
            for each in listed
        )

    @property
    def has_lit(self) -> bool:
        """Whether light matters at all."""
        return any(
            Feature.UNLIT not in description.features
            for description in self.descriptions
        )

    @property
    def has_diffuse(self) -> bool:
        """Whether anything is not a pure metal."""
        return any(
            Feature.DIFFUSE in description.features
            for description in self.descriptions
        )


def _images(material: Material) -> frozenset[int]:
    """The images of a material, by their Python id."""
    return frozenset(id(texture.image) for texture in material.textures)


def _images_of_their_own(materials: Iterable[Material]) -> set[int]:
    """Images that no two materials use together with different others.

    To carry the values of others one of these would be uploaded twice.
    """
    together: dict[int, frozenset[int]] = {}
    shared = set()
    for material in {id(each): each for each in materials}.values():
        images = _images(material)
        for image in images:
            if together.setdefault(image, images) != images:
                shared.add(image)
    return together.keys() - shared


def _requests(
    material: Material,
    description: MaterialDescription,
    picture: StillPicture | None,
    settings: TextureSettings,
    images: dict[TextureRequest, list[EncodedImage]],
) -> dict[str, TextureRequest]:
    """The textures of a material by slot; their images join ``images``."""
    slots = texture_slots(material)
    # By slot, the channel that comes from another image, and where it goes.
    grafts: dict[str, tuple[EncodedImage, int, int]] = {
        slot: (slots[_CARRIED[value][0]].image, _CARRIED[value][1], 3)
        for value, slot in description.carriers
    }
    if Feature.PACKED_OCCLUSION in description.features:
        packed = slots["occlusion"].image
        if packed.identity != slots["metallic_roughness"].image.identity:
            grafts["metallic_roughness"] = (packed, 0, 0)
    requests = {}
    for use in description.textures:
        texture = slots[use.slot]
        given = [texture.image]
        graft = None
        if use.slot in grafts:
            image, of, into = grafts[use.slot]
            given.append(image)
            graft = Graft(image.identity, of, into)
        request = texture_request(
            use.slot,
            texture,
            graft=graft,
            coverage=_coverage(material, use.slot),
            bumps=(
                _bumps(material, description)
                if use.slot == "normal" and settings.specular_aa
                else None
            ),
            max_size=settings.max_size,
            picture=picture.number if picture else 0,
        )
        images.setdefault(request, given)
        requests[use.slot] = request
    return requests


def _coverage(material: Material, slot: str) -> Coverage | None:
    """What the alpha of a texture in ``slot`` says of the surface, if it does.

    The texture's part of what the shader compares with the cutoff.
    """
    if slot != "base_colour" or material.alpha_mode is AlphaMode.OPAQUE:
        return None
    factor = material.base_colour_factor[3]
    if material.alpha_mode is AlphaMode.BLEND or factor <= 0:
        return Coverage()
    cutoff = material.alpha_cutoff / factor
    return Coverage(cutoff if 0 < cutoff <= 1 else None)


def _bumps(material: Material, description: MaterialDescription) -> Bumps:
    """Where levels of the normal map leave what they average."""
    carried = ("roughness", "normal") in description.carriers
    factor = material.roughness_factor if carried else None
    return Bumps(material.normal_scale, factor)


def _keeps_bumps(material: Material, description: MaterialDescription) -> bool:
    """Whether the alpha of the normal map is free for what levels average.

    Files of blocks bring their own levels.
    """
    texture = material.normal_texture
    return (
        texture is not None
        and any(use.slot == "normal" for use in description.textures)
        and all(slot != "normal" for _, slot in description.carriers)
        and texture.sampler.mipmap is not MipmapMode.NONE
        and image_media_type(texture.image) != "image/ktx2"
    )


def _longest_first(
    images: dict[TextureRequest, list[EncodedImage]],
) -> dict[TextureRequest, list[EncodedImage]]:
    """What takes longest to decode before the rest.

    Threads then end together (Graham 1969); what an image takes grows with
    its bytes more than with its pixels.
    """
    return dict(
        sorted(
            images.items(),
            key=lambda item: -sum(image.size for image in item[1]),
        )
    )
