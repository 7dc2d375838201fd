"""Small glTF files, written with pygltflib."""

import io
from typing import Any

import numpy as np
import pygltflib
from numpy.typing import ArrayLike, NDArray
from PIL import Image

__all__ = ["SceneFile", "png"]

_TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
_CODES = {
    "i1": 5120,
    "u1": 5121,
    "i2": 5122,
    "u2": 5123,
    "u4": 5125,
    "f4": 5126,
}
_CORNERS = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float)
# v runs downwards: the first row of an image is at the top of a square.
_UPRIGHT = np.array([(0, 1), (1, 1), (1, 0), (0, 0)], float)


class SceneFile:
    """One buffer, and objects that are numbered as they are added.

    ``gltf`` may be changed at will. Nodes that are nobody's children are
    those of the scene, unless ``gltf.scenes`` is set.
    """

    def __init__(self) -> None:
        self.gltf = pygltflib.GLTF2(extensionsUsed=[])
        self._binary = bytearray()

    def view(self, data: bytes) -> int:
        """A part of the buffer."""
        self._binary += bytes(-len(self._binary) % 4)
        self.gltf.bufferViews.append(
            pygltflib.BufferView(
                buffer=0,
                byteOffset=len(self._binary),
                byteLength=len(data),
            )
        )
        self._binary += data
        return len(self.gltf.bufferViews) - 1

    def accessor(
        self,
        array: ArrayLike,
        dtype: str = "f4",
        *,
        normalized: bool = False,
        limits: bool = False,
    ) -> int:
        """Numbers (N,) or (N, C), rows at multiples of four bytes."""
        values = np.asarray(array).astype("<" + dtype)
        rows = values.reshape(len(values), -1)
        size = rows.shape[1] * rows.itemsize
        padded = np.zeros((len(rows), -(-size // 4) * 4), np.uint8)
        padded[:, :size] = np.ascontiguousarray(rows).view(np.uint8)
        # Indices and keyframes are packed; vertices stand at strides.
        packed = values.ndim == 1
        view = self.view(values.tobytes() if packed else padded.tobytes())
        if not packed and padded.shape[1] != size:
            self.gltf.bufferViews[view].byteStride = padded.shape[1]
        made = pygltflib.Accessor(
            bufferView=view,
            componentType=_CODES[dtype],
            count=len(values),
            type=_TYPES[rows.shape[1]],
            normalized=normalized,
        )
        if limits:
            made.min = rows.min(axis=0).tolist()
            made.max = rows.max(axis=0).tolist()
        self.gltf.accessors.append(made)
        return len(self.gltf.accessors) - 1

    def texture(
        self, image: bytes, mime: str = "image/png", **sampler: Any
    ) -> int:
        """A texture of an encoded image, and the sampler it is read with."""
        source = self.image(image, mime)
        self.gltf.textures.append(pygltflib.Texture(source=source))
        if sampler:
            self.gltf.samplers.append(pygltflib.Sampler(**sampler))
            self.gltf.textures[-1].sampler = len(self.gltf.samplers) - 1
        return len(self.gltf.textures) - 1

    def image(self, data: bytes, mime: str = "image/png") -> int:
        """An encoded image in the buffer."""
        self.gltf.images.append(
            pygltflib.Image(bufferView=self.view(data), mimeType=mime)
        )
        return len(self.gltf.images) - 1

    def material(
        self,
        colour: ArrayLike = (1, 1, 1, 1),
        texture: int | dict[str, Any] | None = None,
        *,
        lit: bool = False,
        metallic: float = 0.0,
        roughness: float = 1.0,
        **fields: Any,
    ) -> int:
        """A material; unless ``lit`` its base colour is its radiance."""
        rgba = [*np.asarray(colour, float).tolist(), 1.0][:4]
        pbr = pygltflib.PbrMetallicRoughness(
            baseColorFactor=rgba,
            metallicFactor=metallic,
            roughnessFactor=roughness,
        )
        if texture is not None:
            info = {"index": texture} if isinstance(texture, int) else texture
            pbr.baseColorTexture = pygltflib.TextureInfo(**info)
        extensions = fields.pop("extensions", {})
        if not lit:
            extensions = {"KHR_materials_unlit": {}, **extensions}
        self.gltf.materials.append(
            pygltflib.Material(
                pbrMetallicRoughness=pbr, extensions=extensions, **fields
            )
        )
        return len(self.gltf.materials) - 1

    def mesh(
        self,
        attributes: dict[str, Any],
        indices: ArrayLike | None = None,
        material: int | None = None,
        mode: int = 4,
        **fields: Any,
    ) -> int:
        """A mesh of one primitive; arrays, or numbers of accessors."""
        primitive = pygltflib.Primitive(
            attributes=pygltflib.Attributes(
                **{
                    name: value
                    if isinstance(value, int)
                    else self.accessor(value, limits=name == "POSITION")
                    for name, value in attributes.items()
                }
            ),
            material=material,
            mode=mode,
            **fields,
        )
        if indices is not None:
            primitive.indices = self.accessor(np.ravel(indices), "u2")
        self.gltf.meshes.append(pygltflib.Mesh(primitives=[primitive]))
        return len(self.gltf.meshes) - 1

    def square(
        self,
        material: int,
        half: float = 1.0,
        uv: ArrayLike = _UPRIGHT,
        **attributes: Any,
    ) -> int:
        """The square from -half to half, facing +Z."""
        return self.mesh(
            {
                "POSITION": _CORNERS * half,
                "NORMAL": np.tile((0.0, 0.0, 1.0), (4, 1)),
                "TEXCOORD_0": np.asarray(uv, float),
                **attributes,
            },
            [0, 1, 2, 0, 2, 3],
            material,
        )

    def node(
        self, mesh: int | None = None, at: Any = None, **fields: Any
    ) -> int:
        """A node, ``at`` a place in two or three dimensions."""
        if at is not None:
            fields["translation"] = [*map(float, at), 0.0][:3]
        self.gltf.nodes.append(pygltflib.Node(mesh=mesh, **fields))
        return len(self.gltf.nodes) - 1

    def uses(self, *names: str, **document: Any) -> None:
        """Declare extensions, and what they say of the whole file."""
        self.gltf.extensionsUsed = sorted(
            {*self.gltf.extensionsUsed, *names, *document}
        )
        self.gltf.extensions = {**self.gltf.extensions, **document}

    def glb(self) -> bytes:
        """The bytes of the file."""
        gltf = self.gltf
        if any("KHR_materials_unlit" in m.extensions for m in gltf.materials):
            self.uses("KHR_materials_unlit")
        if not gltf.scenes:
            children = {c for node in gltf.nodes for c in node.children}
            roots = sorted(set(range(len(gltf.nodes))) - children)
            gltf.scenes = [pygltflib.Scene(nodes=roots)]
            gltf.scene = 0
        gltf.buffers = [pygltflib.Buffer(byteLength=len(self._binary))]
        gltf.set_binary_blob(bytes(self._binary))
        return b"".join(gltf.save_to_bytes())


def png(texels: ArrayLike) -> bytes:
    """A PNG of uint8 or uint16 (H, W) or (H, W, C)."""
    array: NDArray[Any] = np.asarray(texels)
    if array.dtype != np.uint16:
        array = array.astype(np.uint8)
    buffer = io.BytesIO()
    Image.fromarray(array).save(buffer, "PNG")
    return buffer.getvalue()
