"""What ``moka render`` does for one model, by hand with bare ModernGL.

The rival that the framework is measured against: one purpose, one file, no
layer in between, and every trick that a patient programmer would use. It
reads a glTF file whose one mesh has five square textures in separate images,
and a Radiance map, lights the one with the other (split-sum, GGX), and
writes a PNG and, if asked, an EXR:

    python tests/benchmarks/bare_moderngl.py MODEL ENVIRONMENT -o out.png

The order of work is what makes it fast on few cores: threads decode and
reduce the images while Python imports and the context is made, each image is
uploaded when it is there, and the environment is filtered meanwhile. GL calls
that wait or that ModernGL lacks go through ctypes, which releases the GIL.
"""

# The clock starts before the imports.
# ruff: noqa: E402

import time

START = time.perf_counter()

import argparse
import ctypes
import json
import math
import os
import struct
import sys
import zlib
from collections.abc import Callable, Iterator
from concurrent import futures
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from PIL import Image

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # NumPy's would spin

CUBE_SIZE, LEVELS, SAMPLES, IRRADIANCE_SIZE = 256, 6, 64, 16
TABLE_SIZE, TABLE_SAMPLES = 32, 128
FIELD_OF_VIEW = math.radians(45)
HALF_LIMIT = 60000.0
POINTER = ctypes.c_void_p
# Directions of s, t and the centre of each face, +X to -Z, as columns.
FACES = (
    (0, 0, -1, 0, -1, 0, 1, 0, 0), (0, 0, 1, 0, -1, 0, -1, 0, 0),
    (1, 0, 0, 0, 0, 1, 0, 1, 0), (1, 0, 0, 0, 0, -1, 0, -1, 0),
    (1, 0, 0, 0, -1, 0, 0, 0, 1), (-1, 0, 0, 0, -1, 0, 0, 0, -1),
)  # fmt: skip
GL_TEXTURE_2D, GL_CUBE_MAP, GL_CUBE_FACE = 0x0DE1, 0x8513, 0x8515
GL_RG, GL_RGB, GL_RGBA = 0x8227, 0x1907, 0x1908
GL_UNSIGNED_BYTE, GL_FLOAT = 0x1401, 0x1406
GL_RGBA8, GL_SRGB8_ALPHA8 = 0x8058, 0x8C43
GL_RG16F, GL_RGBA16F, GL_RGB32F = 0x822F, 0x881A, 0x8815
GL_LINEAR, GL_MIPMAP_NEAREST, GL_MIPMAP_LINEAR = 0x2601, 0x2701, 0x2703
GL_MAG_FILTER, GL_MIN_FILTER, GL_WRAP_S, GL_WRAP_T = range(0x2800, 0x2804)
GL_BASE_LEVEL, GL_MAX_LEVEL, GL_CLAMP_TO_EDGE = 0x813C, 0x813D, 0x812F
GL_TEXTURE0, GL_FRAMEBUFFER, GL_COLOUR0 = 0x84C0, 0x8D40, 0x8CE0
GL_SEAMLESS, GL_UNPACK_ALIGNMENT, GL_PACK_ALIGNMENT = 0x884F, 0x0CF5, 0x0D05

FULL_SCREEN = """
#version 330 core
uniform mat3 basis;
out vec3 direction;
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
    direction = basis * vec3(corner, 1.0);
    gl_Position = vec4(corner, 1.0, 1.0);
}
"""
EQUIRECTANGULAR = """
#version 330 core
in vec3 direction;
uniform sampler2D map;
uniform float scale;
layout(location = 0) out vec4 environment;
layout(location = 1) out vec4 mirror;
void main() {
    vec3 d = normalize(direction);
    vec2 uv = vec2(0.5 + atan(d.z, d.x) * 0.15915494, acos(d.y) * 0.31830989);
    environment = vec4(textureLod(map, uv, 0.0).rgb * scale, 1.0);
    mirror = environment;
}
"""
PREFILTER = """
#version 330 core
in vec3 direction;
uniform samplerCube environment;
uniform vec4 samples[64];  // direction around +Z, mip level
uniform float weights[64];
uniform int count;
out vec4 radiance;
void main() {
    vec3 n = normalize(direction);
    vec3 t = abs(n.y) < 0.9 ? vec3(n.z, 0, -n.x) : vec3(0, -n.z, n.y);
    t = normalize(t);
    mat3 frame = mat3(t, cross(n, t), n);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < count; ++i)
        sum += weights[i]
            * textureLod(environment, frame * samples[i].xyz, samples[i].w).rgb;
    radiance = vec4(sum, 1.0);
}
"""
SKY = """
#version 330 core
in vec3 direction;
uniform samplerCube environment;
out vec4 colour;
void main() { colour = vec4(textureLod(environment, direction, 0.0).rgb, 1.0); }
"""
MODEL_VERTEX = """
#version 330 core
uniform mat4 model, view_projection;
in vec3 in_position, in_normal;
in vec2 in_uv;
out vec3 position, normal;
out vec2 uv;
void main() {
    vec4 world = model * vec4(in_position, 1.0);
    position = world.xyz;
    normal = mat3(model) * in_normal;
    uv = in_uv;
    gl_Position = view_projection * world;
}
"""
MODEL_FRAGMENT = """
#version 330 core
in vec3 position, normal;
in vec2 uv;
uniform vec3 eye;
uniform float scale;
uniform sampler2D base_map, orm_map, normal_map, emissive_map, table;
uniform samplerCube specular, irradiance;
out vec4 colour;

// The normal map in a frame from screen derivatives (Mikkelsen 2010): glTF's
// v runs down the image and its normal maps have +Y up.
vec3 perturbed(vec3 n) {
    vec3 dx = dFdx(position), dy = dFdy(position);
    vec2 ux = dFdx(uv), uy = dFdy(uv);
    vec3 px = cross(dy, n), py = cross(n, dx);
    vec3 t = px * ux.x + py * uy.x, b = px * ux.y + py * uy.y;
    float size = inversesqrt(max(max(dot(t, t), dot(b, b)), 1e-30));
    vec3 texel = texture(normal_map, uv).xyz * 2.0 - 1.0;
    return normalize((t * texel.x - b * texel.y) * size + n * texel.z);
}

void main() {
    vec3 n = perturbed(normalize(normal));
    vec3 v = normalize(eye - position);
    float nv = clamp(dot(n, v), 0.0, 1.0);
    vec3 base = texture(base_map, uv).rgb;
    vec3 orm = texture(orm_map, uv).rgb;
    vec3 f0 = mix(vec3(0.04), base, orm.b);
    vec2 ab = textureLod(table, vec2(nv, orm.g), 0.0).rg;
    vec3 single = f0 * ab.x + ab.y;
    // Energy that single scattering loses (Turquin 2019).
    vec3 reflected = single * (1.0 + f0 * (1.0 / (ab.x + ab.y) - 1.0));
    vec3 diffuse = base * (1.0 - orm.b) * (1.0 - reflected);
    vec3 light = diffuse * textureLod(irradiance, n, 0.0).rgb + reflected
        * textureLod(specular, reflect(-v, n), orm.g * 5.0).rgb;
    colour = vec4(light * orm.r + texture(emissive_map, uv).rgb * scale, 1.0);
}
"""
RESOLVE = """
#version 330 core
in vec3 direction;
uniform SAMPLER samples;
uniform samplerCube environment;
uniform float scale;
layout(location = 0) out vec4 encoded;
layout(location = 1) out vec4 radiance;

// Khronos PBR Neutral (KhronosGroup/ToneMapping, 2024).
vec3 neutral(vec3 c) {
    float x = min(c.r, min(c.g, c.b));
    c -= x < 0.08 ? x - 6.25 * x * x : 0.04;
    float peak = max(c.r, max(c.g, c.b));
    if (peak < 0.76) return c;
    float bent = 1.0 - 0.0576 / (peak - 0.52);
    return mix(vec3(bent), c * (bent / peak),
               1.0 / (0.15 * (peak - bent) + 1.0));
}

void main() {  // upside down, so that row 0 is the top when read back
    ivec2 p = ivec2(gl_FragCoord.x, HEIGHT - 1 - int(gl_FragCoord.y));
    vec4 sum = vec4(0.0);
    for (int i = 0; i < COUNT; ++i) sum += texelFetch(samples, p, i);
    // The sky is smooth: drawn here, it costs one sample a pixel.
    if (sum.a < COUNT.0)
        sum += (COUNT.0 - sum.a) * textureLod(environment, direction, 0.0);
    radiance = vec4(sum.rgb * scale, 1.0);
    vec3 c = clamp(neutral(radiance.rgb), 0.0, 1.0);
    encoded = vec4(mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055,
                       greaterThan(c, vec3(0.0031308))), 1.0);
}
"""

stages: dict[str, float] = {}
gl = ctypes.CDLL("libGL.so.1")


@contextmanager
def stage(name: str) -> Iterator[None]:
    """Add the main thread's time in the block to ``stages`` in ms."""
    start = time.perf_counter()
    yield
    stages[name] = stages.get(name, 0.0) + (time.perf_counter() - start) * 1e3


def claim_heap() -> None:
    """Have threads share a heap that keeps freed blocks (glibc alone).

    In huge pages, so that the kernel clears 2 MiB at a time and not 4 KiB.
    """
    libc = ctypes.CDLL(None)
    libc.sbrk.restype = libc.malloc.restype = POINTER
    arenas, largest, trim, padding = -8, -3, -1, -2
    huge, heap = 1 << 21, 1 << 30
    libc.mallopt(arenas, 1)
    libc.mallopt(largest, 1 << 25)
    libc.mallopt(trim, (1 << 31) - 1)
    libc.mallopt(padding, heap)
    start = -(-libc.sbrk(0) // huge) * huge
    libc.free(POINTER(libc.malloc(huge)))
    libc.madvise(POINTER(start), ctypes.c_size_t(heap), 14)


# --- Files and pixels: in worker threads -----------------------------------


def decode(path: Path) -> Image.Image:
    """A JPEG or PNG as RGB, in one call that releases the GIL once."""
    image = Image.open(path)
    image.decodermaxblock = path.stat().st_size
    image.load()
    return image if image.mode == "RGB" else image.convert("RGB")


def texels(image: Image.Image) -> Any:
    """The bytes (h, w, 4) of an RGB image where Pillow keeps them, uncopied.

    They come through the Arrow C data interface: the first child's second
    buffer. Nothing keeps the image alive.
    """
    import numpy as np

    fields = POINTER * 10  # of struct ArrowArray
    unwrap = ctypes.PYFUNCTYPE(POINTER, ctypes.py_object, ctypes.c_char_p)(
        ("PyCapsule_GetPointer", ctypes.pythonapi)
    )
    _, capsule = image.__arrow_c_array__()
    array = fields.from_address(unwrap(capsule, b"arrow_array"))
    child = fields.from_address(POINTER.from_address(array[6]).value)
    start = (POINTER * 2).from_address(child[5])[1]
    memory = ctypes.c_ubyte * (4 * image.width * image.height)
    return np.frombuffer(memory.from_address(start), np.uint8).reshape(
        image.height, image.width, 4
    )


def halvings(image: Image.Image) -> list[Image.Image]:
    """An image of data and its box-filtered mip levels."""
    levels = [image]
    while levels[-1].size != (1, 1):
        levels.append(levels[-1].reduce(2))
    return levels


def normal_levels(path: Path) -> list[Image.Image]:
    """Mip levels of a normal map."""
    return halvings(decode(path))


def occlusion_levels(path: Path) -> list[Image.Image]:
    """Mip levels of an occlusion map: of a grey JPEG, the luma alone."""
    image = Image.open(path)
    image.draft("L", image.size)
    return halvings(image.getchannel(0))


def packed_levels(occlusion: Any, path: Path) -> list[Image.Image]:
    """Mip levels of occlusion, roughness, metalness in one texture."""
    levels = halvings(decode(path))
    red = occlusion.result()
    import numpy as np

    for level, single in zip(levels, red, strict=True):
        texels(level)[..., 0] = np.frombuffer(
            single.tobytes(), np.uint8
        ).reshape(single.size[::-1])
    return levels


def colour_levels(path: Path) -> list[Any]:
    """A square sRGB image and its mip levels, reduced in linear light.

    One lookup decodes two channels to 14 bits each, so that four texels can
    be added two channels at a time without a carry; another encodes the sum.
    """
    levels: list[Any] = [decode(path)]
    import numpy as np

    code = np.arange(256) / 255
    linear = np.where(
        code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4
    )
    single = np.round(linear * 16383).astype(np.uint32)
    pairs = (single[None, :] | single[:, None] << 16).ravel()
    total = np.arange(65536) / (4 * 16383)
    encode = np.where(
        total <= 0.0031308,
        12.92 * total,
        1.055 * total ** (1 / 2.4) - 0.055,
    ).clip(0, 1)
    encode = np.round(encode * 255).astype(np.uint8)

    larger = texels(levels[0])
    while (size := len(larger)) > 1:
        smaller = np.empty((size // 2, size // 2, 4), np.uint8)
        rows = min(size, 32)  # blocks that stay in the cache
        decoded = np.empty((rows, size, 2), np.uint32)
        for row in range(0, size, rows):
            block = larger[row : row + rows].view(np.uint16)
            pairs.take(block, out=decoded, mode="clip")
            sums = decoded.view(np.uint64).reshape(-1, 2, size // 2, 2)
            sums = sums[:, 0] + sums[:, 1]
            sums = (sums[..., 0] + sums[..., 1]).view(np.uint16)
            encode.take(
                sums.reshape(-1, size // 2, 4),
                out=smaller[row // 2 : (row + rows) // 2],
                mode="clip",
            )
        levels.append(smaller)
        larger = smaller
    return levels


def read_radiance(path: Path) -> Any:
    """A Radiance map as float32 (h, w, 3), by the fastest decoder here."""
    import numpy as np

    try:
        import imagecodecs

        name, texels = "imagecodecs", imagecodecs.rgbe_decode(path.read_bytes())
    except ImportError:
        try:
            import cv2

            texels = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)[..., ::-1]
            name = "OpenCV"
        except ImportError:
            name, texels = "Python", read_radiance_slowly(path.read_bytes())
    print(f"HDR decoder: {name}", file=sys.stderr)
    return np.ascontiguousarray(texels, np.float32)


def read_radiance_slowly(data: bytes) -> Any:
    """The same in Python, for run-length encoded scan lines alone."""
    import numpy as np

    header = data.index(b"\n\n") + 2
    at = data.index(b"\n", header) + 1
    _, height, _, width = data[header:at].split()
    rgbe = np.empty((int(height), 4, int(width)), np.uint8)
    for row in rgbe:
        at += 4  # each line repeats its width
        for channel in row:
            x = 0
            while x < len(channel):
                count, run = data[at] & 127, data[at] > 128
                count = count if run else data[at]
                size = 1 if run else count
                literal = data[at + 1 : at + 1 + size]
                channel[x : x + count] = np.frombuffer(literal, np.uint8)
                at, x = at + 1 + size, x + count
    scale = np.ldexp(np.float32(1), rgbe[:, 3:].astype(np.int32) - 136)
    return (rgbe[:, :3] * scale).transpose(0, 2, 1)


def brdf_table() -> list[Any]:
    """Scale and bias of F0 (roughness, n.v, 2), float32 (Karis 2013).

    Visible normals are sampled (Heitz 2018), so that few samples suffice.
    """
    import numpy as np

    axis = ((np.arange(TABLE_SIZE) + 0.5) / TABLE_SIZE).astype(np.float32)
    nv, a = axis[None, :, None], axis[:, None, None] ** 2
    index = range(TABLE_SAMPLES)
    radius = np.sqrt((np.array(index) + 0.5) / TABLE_SAMPLES).astype(np.float32)
    phi = 2 * np.pi * np.array([van_der_corput(i) for i in index], np.float32)
    sine = np.sqrt(1 - nv * nv)
    length = np.sqrt(a * a * sine * sine + nv * nv)
    x, z = a * sine / length, nv / length
    s, t = radius * np.cos(phi), radius * np.sin(phi)
    t = (1 - z) / 2 * np.sqrt(1 - s * s) + (1 + z) / 2 * t
    k = np.sqrt(np.maximum(1 - s * s - t * t, 0))
    hx, hy, hz = a * (k * x - t * z), a * s, np.maximum(t * x + k * z, 0)
    length = np.sqrt(hx * hx + hy * hy + hz * hz)
    vh, nh = np.clip((sine * hx + nv * hz) / length, 0, 1), hz / length
    nl = np.maximum(2 * vh * nh - nv, 0)
    root = np.sqrt(a * a + (1 - a * a) * nv * nv)
    smith = nl * root + nv * np.sqrt(a * a + (1 - a * a) * nl * nl)
    weight = nl * (nv + root) / smith
    bias = (weight * (1 - vh) ** 5).mean(-1)
    return [np.stack([weight.mean(-1) - bias, bias], -1)]


def write_png(path: Path, pixels: Any, pool: Any) -> None:
    """Write uint8 (h, w, 3); slices are deflated in parallel."""
    import numpy as np

    height, width, _ = pixels.shape
    rows = np.empty((height, 1 + 3 * width), np.uint8)
    flat = pixels.reshape(height, -1)
    rows[:, 0] = 1  # filter "sub"
    rows[:, 1:4] = flat[:, :3]
    np.subtract(flat[:, 3:], flat[:, :-3], out=rows[:, 4:])

    def deflate(part: Any) -> bytes:
        packer = zlib.compressobj(1, zlib.DEFLATED, -15)
        last = part is parts[-1]
        return packer.compress(part) + packer.flush(
            zlib.Z_FINISH if last else zlib.Z_FULL_FLUSH
        )

    parts = np.array_split(rows, os.cpu_count() or 1)
    stream = b"\x78\x01" + b"".join(pool.map(deflate, parts))
    stream += struct.pack(">I", zlib.adler32(rows))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    with path.open("wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for kind, data in (
            (b"IHDR", header),
            (b"sRGB", b"\0"),
            (b"IDAT", stream),
            (b"IEND", b""),
        ):
            file.write(struct.pack(">I", len(data)) + kind + data)
            file.write(struct.pack(">I", zlib.crc32(data, zlib.crc32(kind))))


def write_exr(path: Path, pixels: Any) -> None:
    """Write float32 (h, w, 4) as it is: ZIP saves a third and costs 130 ms."""
    import OpenEXR

    header = {"compression": OpenEXR.NO_COMPRESSION}
    OpenEXR.File(header, {"RGBA": pixels}).write(str(path))


# --- Sample directions, model, camera --------------------------------------


def van_der_corput(index: int) -> float:
    """The bits of ``index`` mirrored at the binary point."""
    return int(f"{index:032b}"[::-1], 2) / 2**32


def lobe(roughness: float | None) -> tuple[bytes, bytes, int]:
    """Directions around +Z with mip levels, weights, and their number.

    Filtered importance sampling (Krivanek and Colbert 2008) of the GGX lobe
    at normal incidence, or of the cosine lobe if ``roughness`` is None.
    """
    texel = 4 * math.pi / (6 * CUBE_SIZE**2)
    samples = []
    for i in range(SAMPLES):
        u, phi = (i + 0.5) / SAMPLES, 2 * math.pi * van_der_corput(i)
        if roughness is None:
            z = weight = math.sqrt(1 - u)
            density, weight = z / math.pi, 1.0
        else:
            a2 = roughness**4
            h2 = (1 - u) / (1 + (a2 - 1) * u)
            z = weight = 2 * h2 - 1
            density = a2 / (math.pi * ((a2 - 1) * h2 + 1) ** 2) / 4
        if z <= 0:
            continue
        r, area = math.sqrt(1 - z * z), 1 / (SAMPLES * density)
        level = max(0.0, 0.5 * math.log2(area / texel))
        samples.append((r * math.cos(phi), r * math.sin(phi), z, level, weight))
    total = sum(sample[4] for sample in samples)
    directions = b"".join(struct.pack("4f", *sample[:4]) for sample in samples)
    weights = b"".join(struct.pack("f", s[4] / total) for s in samples)
    return (
        directions.ljust(16 * SAMPLES, b"\0"),
        weights.ljust(4 * SAMPLES, b"\0"),
        len(samples),
    )


class Model:
    """The first primitive of a glTF file and the images of its material."""

    def __init__(self, path: Path) -> None:
        self.folder = path.parent
        self.document = json.loads(path.read_bytes())
        self.primitive = self.document["meshes"][0]["primitives"][0]
        material = self.document["materials"][self.primitive["material"]]
        self.material = material | material["pbrMetallicRoughness"]
        buffer = self.folder / self.document["buffers"][0]["uri"]
        self.geometry = memoryview(buffer.read_bytes())

    def image(self, name: str) -> Path:
        """The image file of a texture of the material."""
        index = self.document["textures"][self.material[name]["index"]][
            "source"
        ]
        return self.folder / self.document["images"][index]["uri"]

    def accessor(self, index: int) -> memoryview:
        """The bytes of tightly packed elements."""
        entry = self.document["accessors"][index]
        view = self.document["bufferViews"][entry["bufferView"]]
        start = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
        return self.geometry[start : start + view["byteLength"]]

    def vertex_array(self, ctx: Any, program: Any) -> Any:
        """The primitive as ModernGL draws it."""
        attributes, indices = (
            self.primitive["attributes"],
            self.primitive["indices"],
        )
        component = self.document["accessors"][indices]["componentType"]
        return ctx.vertex_array(
            program,
            [
                (ctx.buffer(self.accessor(attributes[name])), format_, variable)
                for name, format_, variable in (
                    ("POSITION", "3f", "in_position"),
                    ("NORMAL", "3f", "in_normal"),
                    ("TEXCOORD_0", "2f", "in_uv"),
                )
            ],
            ctx.buffer(self.accessor(indices)),
            index_element_size={5123: 2, 5125: 4}[component],
        )

    def sphere(self, world: Any) -> tuple[Any, float]:
        """Centre and radius of the sphere around the box of the mesh."""
        import numpy as np

        position = self.primitive["attributes"]["POSITION"]
        entry = self.document["accessors"][position]
        low, high = np.array(entry["min"]), np.array(entry["max"])
        centre, reach = (low + high) / 2, (high - low) / 2
        reach = np.abs(world[:3, :3]) @ reach
        return world[:3, :3] @ centre + world[:3, 3], float(
            np.linalg.norm(reach)
        )


def node_matrix(document: Any) -> Any:
    """World matrix (4, 4) of the node that has the mesh."""
    import numpy as np

    nodes = document["nodes"]
    parents = {c: i for i, n in enumerate(nodes) for c in n.get("children", ())}
    index = next(i for i, node in enumerate(nodes) if "mesh" in node)
    world = np.eye(4)
    while index is not None:
        node, local = nodes[index], np.eye(4)
        x, y, z, w = node.get("rotation", (0, 0, 0, 1))
        axis, cross = np.array((x, y, z)), np.cross(np.eye(3), (x, y, z))
        rotation = (w * w - axis @ axis) * np.eye(3) + 2 * np.outer(axis, axis)
        local[:3, :3] = (rotation + 2 * w * cross) * node.get(
            "scale", (1, 1, 1)
        )
        local[:3, 3] = node.get("translation", (0, 0, 0))
        if "matrix" in node:
            local = np.array(node["matrix"], float).reshape(4, 4).T
        world, index = local @ world, parents.get(index)
    return world


def orbit(
    centre: Any,
    radius: float,
    yaw: float,
    pitch: float,
    distance: float | None,
    aspect: float,
) -> tuple[bytes, bytes, bytes]:
    """View-projection, eye and, top row first, the basis of its pixels."""
    import numpy as np

    right = np.array((math.cos(yaw), 0.0, -math.sin(yaw)))
    level = np.array((math.sin(yaw), 0.0, math.cos(yaw)))
    back = math.cos(pitch) * level + (0.0, math.sin(pitch), 0.0)
    up = np.cross(back, right)
    y = 1 / math.tan(FIELD_OF_VIEW / 2)
    distance = distance or radius * math.hypot(1, max(y, y / aspect))
    eye = centre + back * distance
    near, far = max(distance - radius, distance / 100), distance + radius
    view = np.eye(4)
    view[:3, :3] = right, up, back
    view[:3, 3] = -view[:3, :3] @ eye
    projection = np.diag((y / aspect, y, (far + near) / (near - far), 0.0))
    projection[2, 3] = 2 * far * near / (near - far)
    projection[3, 2] = -1
    basis = np.array((right * aspect / y, -up / y, -back))
    return (
        (projection @ view).T.astype("f4").tobytes(),
        eye.astype("f4").tobytes(),
        basis.astype("f4").tobytes(),
    )


# --- OpenGL ----------------------------------------------------------------


def texture(unit: int, target: int, minify: int, repeat: bool = False) -> int:
    """A new texture, bound to ``unit``."""
    name = ctypes.c_uint()
    gl.glGenTextures(1, ctypes.byref(name))
    gl.glActiveTexture(GL_TEXTURE0 + unit)
    gl.glBindTexture(target, name)
    gl.glTexParameteri(target, GL_MAG_FILTER, GL_LINEAR)
    gl.glTexParameteri(target, GL_MIN_FILTER, minify)
    if not repeat:
        gl.glTexParameteri(target, GL_WRAP_S, GL_CLAMP_TO_EDGE)
        gl.glTexParameteri(target, GL_WRAP_T, GL_CLAMP_TO_EDGE)
    return name.value


def fill(internal: int, levels: list[Any]) -> None:
    """Give the bound 2D texture its levels, arrays (h, w, c) or images."""
    gl.glTexParameteri(GL_TEXTURE_2D, GL_MAX_LEVEL, len(levels) - 1)
    for level, pixels in enumerate(levels):
        if isinstance(pixels, Image.Image):
            pixels = texels(pixels)
        height, width, channels = pixels.shape
        order = {2: GL_RG, 3: GL_RGB, 4: GL_RGBA}[channels]
        kind = GL_UNSIGNED_BYTE if pixels.itemsize == 1 else GL_FLOAT
        gl.glTexImage2D(
            GL_TEXTURE_2D, level, internal, width, height, 0, order, kind,
            POINTER(pixels.ctypes.data),
        )  # fmt: skip


def read(attachment: int, order: int, kind: int, pixels: Any) -> None:
    """Read one image of the bound framebuffer, without the GIL."""
    height, width, _ = pixels.shape
    gl.glReadBuffer(GL_COLOUR0 + attachment)
    gl.glReadPixels(
        0, 0, width, height, order, kind, POINTER(pixels.ctypes.data)
    )


def cube(unit: int, size: int, levels: int, minify: int) -> int:
    """An empty half-float cube, bound to ``unit``."""
    name = texture(unit, GL_CUBE_MAP, minify)
    gl.glTexParameteri(GL_CUBE_MAP, GL_MAX_LEVEL, levels - 1)
    for level in range(levels):
        for face in range(6):
            gl.glTexImage2D(
                GL_CUBE_FACE + face, level, GL_RGBA16F, size >> level,
                size >> level, 0, GL_RGBA, GL_FLOAT, None,
            )  # fmt: skip
    return name


def draw_faces(draw: Any, size: int, level: int, *cubes: int) -> None:
    """Draw into one level of six faces of each of ``cubes``."""
    gl.glViewport(0, 0, size >> level, size >> level)
    for face, basis in enumerate(FACES):
        for index, name in enumerate(cubes):
            gl.glFramebufferTexture2D(
                GL_FRAMEBUFFER, GL_COLOUR0 + index,
                GL_CUBE_FACE + face, name, level,
            )  # fmt: skip
        draw.program["basis"] = basis
        draw.render(vertices=3)


def light(
    ctx: Any, background: Any, equirectangular: Any
) -> tuple[float, Callable[[], None]]:
    """Start to make the environment's cubes, while the caller uploads.

    Returns the scale of their radiance and the call that completes them.

    Mip levels are drawn by hand, since Mesa compiles the shaders of
    glGenerateMipmap and glBlitFramebuffer anew in every process.
    """
    scale = min(1.0, HALF_LIMIT / float(equirectangular.max()))
    texture(8, GL_TEXTURE_2D, GL_LINEAR, repeat=True)
    fill(GL_RGB32F, [equirectangular])
    specular = cube(5, CUBE_SIZE, LEVELS, GL_MIPMAP_LINEAR)
    irradiance = cube(6, IRRADIANCE_SIZE, 1, GL_LINEAR)
    environment = cube(7, CUBE_SIZE, 9, GL_MIPMAP_NEAREST)
    frame = ctypes.c_uint()
    gl.glGenFramebuffers(1, ctypes.byref(frame))
    gl.glBindFramebuffer(GL_FRAMEBUFFER, frame)

    project = ctx.program(FULL_SCREEN, EQUIRECTANGULAR)
    project["map"], project["scale"] = 8, scale
    both = (ctypes.c_uint * 2)(GL_COLOUR0, GL_COLOUR0 + 1)
    gl.glDrawBuffers(2, both)
    draw = ctx.vertex_array(project, [])
    draw_faces(draw, CUBE_SIZE, 0, environment, specular)
    gl.glFramebufferTexture2D(
        GL_FRAMEBUFFER, GL_COLOUR0 + 1, GL_CUBE_FACE, 0, 0
    )
    gl.glDrawBuffers(1, both)
    for level in range(1, 9):  # half of a face lies between its texels
        gl.glTexParameteri(GL_CUBE_MAP, GL_BASE_LEVEL, level - 1)
        gl.glTexParameteri(GL_CUBE_MAP, GL_MAX_LEVEL, level - 1)
        draw_faces(background, CUBE_SIZE, level, environment)
    gl.glTexParameteri(GL_CUBE_MAP, GL_BASE_LEVEL, 0)
    gl.glTexParameteri(GL_CUBE_MAP, GL_MAX_LEVEL, 8)

    # All lobes into one image: a face is too small to occupy two cores.
    prefilter = ctx.program(FULL_SCREEN, PREFILTER)
    prefilter["environment"] = 7
    draw = ctx.vertex_array(prefilter, [])
    targets = [(irradiance, 0, IRRADIANCE_SIZE, None)] + [
        (specular, level, CUBE_SIZE >> level, level / (LEVELS - 1))
        for level in range(1, LEVELS)
    ]
    width, height = 3 * CUBE_SIZE, sum(size for _, _, size, _ in targets)
    image = ctx.framebuffer([ctx.texture((width, height), 4, dtype="f2")])
    image.use()
    bottom = 0
    for _, _, size, roughness in targets:
        samples, weights, count = lobe(roughness)
        prefilter["samples"].write(samples)
        prefilter["weights"].write(weights)
        prefilter["count"] = count
        for face, basis in enumerate(FACES):
            prefilter["basis"] = basis
            gl.glViewport(face * size, bottom, size, size)
            draw.render(vertices=3)
        bottom += size
    gl.glFlush()

    def complete() -> None:
        image.use()
        gl.glActiveTexture(GL_TEXTURE0 + 8)
        bottom = 0
        for name, level, size, _ in targets:
            gl.glBindTexture(GL_CUBE_MAP, name)
            for face in range(6):
                gl.glCopyTexSubImage2D(
                    GL_CUBE_FACE + face, level, 0, 0,
                    face * size, bottom, size, size,
                )  # fmt: skip
            bottom += size

    return scale, complete


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("model", type=Path)
    parser.add_argument("environment", type=Path)
    parser.add_argument("-o", "--output", type=Path, action="append")
    parser.add_argument("--size", default="1024x1024", metavar="WxH")
    parser.add_argument("--samples", type=int, default=4, metavar="N")
    parser.add_argument("--yaw", type=float, default=0.0, metavar="DEG")
    parser.add_argument("--pitch", type=float, default=0.0, metavar="DEG")
    parser.add_argument("--distance", type=float, metavar="METRES")
    parser.add_argument("--frames", type=int, default=0, metavar="N")
    parser.add_argument("--yaw-per-frame", type=float, default=1.0)
    parser.add_argument("--stats", action="store_true")
    parser.add_argument(
        "--on-request",
        action="store_true",
        help="then draw a frame for each line on stdin and print its wall "
        "and CPU time in ms, as `moka bench frame --against` asks",
    )
    return parser.parse_args()


def main() -> None:
    """Start the work in other threads, draw, write the files."""
    if sys.platform == "linux":
        claim_heap()
    options = arguments()
    width, height = size = tuple(map(int, options.size.split("x")))
    samples = options.samples if options.samples > 1 else 0
    outputs = options.output or [Path("bare.png")]
    stages["import"] = (time.perf_counter() - START) * 1e3

    with stage("parse"):
        model = Model(options.model)
        pool = futures.ThreadPoolExecutor(1 + (os.cpu_count() or 1))
        occlusion = pool.submit(
            occlusion_levels, model.image("occlusionTexture")
        )
        sky = pool.submit(read_radiance, options.environment)
        images = {
            pool.submit(work, *inputs): name
            for name, work, *inputs in (
                ("orm_map", packed_levels, occlusion,
                 model.image("metallicRoughnessTexture")),
                ("base_map", colour_levels, model.image("baseColorTexture")),
                ("normal_map", normal_levels, model.image("normalTexture")),
                ("emissive_map", colour_levels, model.image("emissiveTexture")),
                ("table", brdf_table),
            )
        }  # fmt: skip
    with stage("context"):
        import moderngl
        from glcontext import egl

        ctx = moderngl.create_context(
            context=egl.create_context(
                mode="standalone",
                glversion=330,
                libgl="libGL.so.1",
                libegl="libEGL.so.1",
            )
        )
        gl.glEnable(GL_SEAMLESS)
        gl.glPixelStorei(GL_UNPACK_ALIGNMENT, 1)
        gl.glPixelStorei(GL_PACK_ALIGNMENT, 1)
    with stage("compile"):
        forward = ctx.program(MODEL_VERTEX, MODEL_FRAGMENT)
        background = ctx.vertex_array(ctx.program(FULL_SCREEN, SKY), [])
        background.program["environment"] = 7
        resolve_fragment = (
            RESOLVE.replace(
                "SAMPLER", "sampler2DMS" if samples else "sampler2D"
            )
            .replace("HEIGHT", str(height))
            .replace("COUNT", str(samples or 1))
        )
        resolve = ctx.vertex_array(
            ctx.program(FULL_SCREEN, resolve_fragment), []
        )
    with stage("geometry"):
        import numpy as np

        world = node_matrix(model.document)
        centre, radius = model.sphere(world)
        mesh = model.vertex_array(ctx, forward)
        forward["model"].write(world.T.astype("f4").tobytes())
        forward["specular"], forward["irradiance"] = 5, 6
    with stage("decode"):
        equirectangular = sky.result()
    with stage("environment"):
        scale, complete = light(ctx, background, equirectangular)
        forward["scale"] = scale
        resolve.program["samples"], resolve.program["environment"] = 9, 7
        resolve.program["scale"] = 1 / (scale * options.samples)
    for unit in range(len(images)):
        with stage("decode"):
            done, _ = futures.wait(images, return_when=futures.FIRST_COMPLETED)
            job = done.pop()
            name, levels = images.pop(job), job.result()
        with stage("upload"):
            forward[name] = unit
            if name == "table":
                texture(unit, GL_TEXTURE_2D, GL_LINEAR)
                fill(GL_RG16F, levels)
            else:
                texture(unit, GL_TEXTURE_2D, GL_MIPMAP_LINEAR, repeat=True)
                colour = name in ("base_map", "emissive_map")
                fill(GL_SRGB8_ALPHA8 if colour else GL_RGBA8, levels)
            del done, job, levels  # their memory serves the next texture
    with stage("environment"):
        complete()
    with stage("targets"):  # in the memory that images needed
        radiance = ctx.texture(size, 4, samples=samples, dtype="f2")
        target = ctx.framebuffer(
            [radiance], ctx.depth_renderbuffer(size, samples=samples)
        )
        linear = [path for path in outputs if path.suffix == ".exr"]
        final = ctx.framebuffer(
            [ctx.texture(size, 4)]
            + [ctx.texture(size, 4, dtype="f4")] * bool(linear)
        )
    radiance.use(9)
    ctx.depth_func = "<="

    def frame(yaw: float) -> None:
        view_projection, eye, basis = orbit(
            centre,
            radius,
            math.radians(yaw),
            math.radians(options.pitch),
            options.distance,
            width / height,
        )
        forward["view_projection"].write(view_projection)
        forward["eye"].write(eye)
        resolve.program["basis"].write(basis)
        target.use()
        ctx.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        target.clear()
        mesh.render()
        final.use()
        ctx.enable_only(moderngl.NOTHING)
        resolve.render(vertices=3)
        gl.glFinish()

    with stage("frame"):
        frame(options.yaw)
    with stage("readback"):
        pixels = np.empty((height, width, 3), np.uint8)
        read(0, GL_RGB, GL_UNSIGNED_BYTE, pixels)
        if linear:
            floats = np.empty((height, width, 4), np.float32)
            read(1, GL_RGBA, GL_FLOAT, floats)
    with stage("encode"):
        for path in outputs:
            if path in linear:
                write_exr(path, floats)
            else:
                write_png(path, pixels, pool)

    for number, _ in enumerate(sys.stdin if options.on_request else ()):
        cpu, start = time.process_time(), time.perf_counter()
        frame(options.yaw + number * options.yaw_per_frame)
        wall = time.perf_counter() - start
        print(wall * 1e3, (time.process_time() - cpu) * 1e3, flush=True)

    report: dict[str, Any] = {}
    if options.stats:
        report["stages_ms"] = {k: round(v, 2) for k, v in stages.items()}
        report["total_ms"] = round((time.perf_counter() - START) * 1e3, 2)
    if options.frames:
        times = []
        for index in range(1, options.frames + 1):
            start = time.perf_counter()
            frame(options.yaw + index * options.yaw_per_frame)
            times.append((time.perf_counter() - start) * 1e3)
        middle = sorted(times)[len(times) // 2]
        report["frame_ms"] = {"median": round(middle, 3)}
    if report:
        print(json.dumps(report), flush=True)
    os._exit(0)  # without taking down the driver and its threads


if __name__ == "__main__":
    main()
