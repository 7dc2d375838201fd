"""What the materials of a scene ask for: descriptions and textures.

Apart from everything that draws, so that images begin to decode before the
rest of the renderer is imported.
"""

from collections.abc import Sequence
from copy import copy

from msgspec.structs import replace

from moka.core.encoded_image import EncodedImage
from moka.material.description import (
    Feature,
    MaterialDescription,
    describe_material,
    texture_slots,
)
from moka.material.material import Material, Texture
from moka.model.mesh import Primitive
from moka.renderer.sampled_levels import SampledLevels, StillPicture
from moka.renderer.textures import (
    TexturePool,
    TextureRequest,
    texture_request,
)

__all__ = ["SceneMaterials"]

_DEFAULT_MATERIAL = Material(name="glTF default")


class SceneMaterials:
    """Descriptions of the primitives' materials, and their textures begun.

    Made first, so that images decode while everything else goes on. With
    ``picture`` only what it shows is there: ``drawn`` holds the positions
    among ``primitives`` of those that the other lists are about.
    """

    def __init__(
        self,
        primitives: Sequence[Primitive],
        textures: TexturePool,
        picture: StillPicture | None = None,
    ) -> None:
        self.drawn: Sequence[int] = (
            range(len(primitives)) if picture is None else picture.drawn
        )
        self.materials: list[Material] = []
        self.descriptions: list[MaterialDescription] = []
        self.requests: list[dict[str, TextureRequest]] = []
        images: dict[TextureRequest, list[EncodedImage]] = {}
        reads: dict[TextureRequest, list[tuple[int, Texture]]] = {}
        known: dict[
            tuple[Material, tuple[str, ...], object],
            tuple[MaterialDescription, dict[str, TextureRequest]],
        ] = {}
        for index in self.drawn:
            primitive = primitives[index]
            material = primitive.material or _DEFAULT_MATERIAL
            key = (material, tuple(primitive.attributes), primitive.topology)
            if key not in known:
                description = describe_material(
                    material, primitive.attributes, primitive.topology
                )
                known[key] = (
                    description,
                    _requests(material, description, picture, images),
                )
            description, requests = known[key]
            self.materials.append(material)
            self.descriptions.append(description)
            self.requests.append(requests)
            slots = texture_slots(material)
            for slot, request in requests.items():
                reads.setdefault(request, []).append((index, slots[slot]))
        for request, given in images.items():
            levels = None
            if picture is not None:
                levels = SampledLevels(picture, reads[request])
            textures.begin(request, given, levels)
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


def _requests(
    material: Material,
    description: MaterialDescription,
    picture: StillPicture | None,
    images: dict[TextureRequest, list[EncodedImage]],
) -> dict[str, TextureRequest]:
    """The textures of a material by slot; their images join ``images``."""
    slots = texture_slots(material)
    packed = Feature.PACKED_OCCLUSION in description.features
    requests = {}
    for use in description.textures:
        texture = slots[use.slot]
        occlusion = (
            slots["occlusion"].image
            if packed and use.slot == "metallic_roughness"
            else texture.image
        )
        request = texture_request(
            use.slot, texture, occlusion, picture.number if picture else 0
        )
        given = [texture.image]
        if request.occlusion is not None:
            given.append(occlusion)
        images.setdefault(request, given)
        requests[use.slot] = request
    return requests
