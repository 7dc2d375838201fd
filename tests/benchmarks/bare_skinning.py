"""Where joint matrices and morph targets should lie, measured by hand.

    python tests/benchmarks/bare_skinning.py

Vertices are moved beside a target of one pixel. Joints: a 2D texture, a texture
buffer and a uniform block of as many rows as OpenGL 3.3 promises. Morph
targets: added by the vertex shader from a texture, or by NumPy and uploaded.
Variants take turns, so that a busy machine slows all of them.
"""

import statistics
import time
from collections.abc import Callable
from ctypes import addressof, c_int, c_uint, c_void_p

import moderngl
import numpy as np

from moka.backend.contexts import open_context

VERTICES = 200_000
JOINTS = 100  # of the 341 that fit into a uniform block of 16 KiB
TARGETS = 4
ROUNDS = 15

SKIN = """#version 330 core
in vec3 position;
in vec4 joints;
in vec4 weights;
%s
vec4 influence(float joint, float weight) {
    int texel = 3 * int(joint);
    vec4 p = vec4(position, 1.0);
    return weight * vec4(
        dot(row(texel), p), dot(row(texel + 1), p), dot(row(texel + 2), p),
        1.0);
}
void main() {
    vec4 p = influence(joints.x, weights.x) + influence(joints.y, weights.y)
        + influence(joints.z, weights.z) + influence(joints.w, weights.w);
    gl_Position = p + vec4(5.0, 0.0, 0.0, 0.0);
}
"""
TEXTURE_2D = """uniform sampler2D rows;
vec4 row(int i) { return texelFetch(rows, ivec2(i & 255, i >> 8), 0); }
"""
TEXTURE_BUFFER = """uniform samplerBuffer rows;
vec4 row(int i) { return texelFetch(rows, i); }
"""
UNIFORM_BLOCK = """layout(std140) uniform Rows { vec4 rows[1024]; };
vec4 row(int i) { return rows[i]; }
"""
MORPH = """#version 330 core
in vec3 position;
uniform sampler2D deltas;
uniform int count;
void main() {
    vec3 p = position;
    for (int i = 0; i < count; ++i) {
        int texel = i * %d + gl_VertexID;
        p += 0.25 * texelFetch(deltas, ivec2(texel & 4095, texel >> 12), 0).xyz;
    }
    gl_Position = vec4(p + 5.0, 1.0);
}
"""
PLAIN = """#version 330 core
in vec3 position;
void main() { gl_Position = vec4(position + 5.0, 1.0); }
"""
FRAGMENT = """#version 330 core
out vec4 colour;
void main() { colour = vec4(1.0); }
"""
TEXTURE_BUFFER_TARGET, RGBA32F = 0x8C2A, 0x8814


def main() -> None:
    """Print the median of each variant in milliseconds."""
    owner = open_context("auto")
    with owner.gl as context:
        target = context.simple_framebuffer((1, 1))
        target.use()
        random = np.random.default_rng(0)
        positions = random.random((VERTICES, 3), np.float32)
        compare("joints", skinning(owner, context, random, positions))
        compare("morph targets", morphing(context, random, positions))


def skinning(
    owner: object,
    context: moderngl.Context,
    random: np.random.Generator,
    positions: np.ndarray,
) -> dict[str, Callable[[], None]]:
    """Draws with joint matrices in each of the three places."""
    vertices = np.zeros((VERTICES, 11), np.float32)
    vertices[:, :3] = positions
    vertices[:, 3:7] = random.integers(0, JOINTS, (VERTICES, 4))
    vertices[:, 7:] = 0.25
    buffer = context.buffer(vertices)
    rows = random.random((1024, 4), np.float32)
    texture = context.texture((256, 4), 4, rows.tobytes(), dtype="f4")
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    block = context.buffer(rows)
    layout = (buffer, "3f 4f 4f", "position", "joints", "weights")
    draws = {}

    def add(name: str, source: str, bind: Callable[[], None]) -> None:
        program = context.program(
            vertex_shader=SKIN % source, fragment_shader=FRAGMENT
        )
        array = context.vertex_array(program, [layout])

        def draw() -> None:
            bind()
            array.render(moderngl.POINTS)

        draws[name] = draw

    add("2D texture", TEXTURE_2D, lambda: texture.use(0))
    add("uniform block", UNIFORM_BLOCK, lambda: block.bind_to_uniform_block(0))
    load = owner.function  # type: ignore[attr-defined]
    bind = load("glBindTexture", None, c_uint, c_uint)
    attach = load("glTexBuffer", None, c_uint, c_uint, c_uint)
    name = c_uint()
    load("glGenTextures", None, c_int, c_void_p)(1, addressof(name))
    bind(TEXTURE_BUFFER_TARGET, name)
    attach(TEXTURE_BUFFER_TARGET, RGBA32F, block.glo)
    add(
        "texture buffer",
        TEXTURE_BUFFER,
        lambda: bind(TEXTURE_BUFFER_TARGET, name),
    )
    return draws


def morphing(
    context: moderngl.Context,
    random: np.random.Generator,
    positions: np.ndarray,
) -> dict[str, Callable[[], None]]:
    """Draws with targets added here or there."""
    deltas = random.random((TARGETS, VERTICES, 3), np.float32)
    height = -(-TARGETS * VERTICES // 4096)
    texels = np.zeros((height * 4096, 4), np.float32)
    texels[: TARGETS * VERTICES, :3] = deltas.reshape(-1, 3)
    texture = context.texture((4096, height), 4, texels.tobytes(), dtype="f4")
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    still, moved = context.buffer(positions), context.buffer(positions)
    program = context.program(
        vertex_shader=MORPH % VERTICES, fragment_shader=FRAGMENT
    )
    program["count"] = TARGETS
    on_gpu = context.vertex_array(program, [(still, "3f", "position")])
    plain = context.vertex_array(
        context.program(vertex_shader=PLAIN, fragment_shader=FRAGMENT),
        [(moved, "3f", "position")],
    )

    def by_shader() -> None:
        texture.use(0)
        on_gpu.render(moderngl.POINTS)

    def by_numpy() -> None:
        total = positions.copy()
        for delta in deltas:
            total += np.float32(0.25) * delta
        moved.orphan(total.nbytes)
        moved.write(total)
        plain.render(moderngl.POINTS)

    return {
        "vertex shader": by_shader,
        "NumPy and upload": by_numpy,
        "no targets": lambda: plain.render(moderngl.POINTS),
    }


def compare(title: str, draws: dict[str, Callable[[], None]]) -> None:
    """Run all of them in turn and print their medians."""
    times: dict[str, list[float]] = {name: [] for name in draws}
    context = moderngl.get_context()
    for number in range(ROUNDS + 2):
        for name, draw in draws.items():
            start = time.perf_counter()
            draw()
            context.finish()
            if number >= 2:
                times[name].append(1000 * (time.perf_counter() - start))
    print(f"{title}, {VERTICES} vertices")
    for name, each in times.items():
        print(f"  {name:<18} {statistics.median(each):7.2f} ms")


if __name__ == "__main__":
    main()
