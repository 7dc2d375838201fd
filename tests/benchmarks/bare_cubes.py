"""Many cubes of sixteen materials as one instanced draw, with bare ModernGL.

The floor for scenes of many objects: transforms and material numbers in one
vertex buffer, materials in one uniform block, a directional light with the
GGX BRDF of glTF 2.0, one draw call a frame. Prints medians as JSON:
``submit_median`` is the time until Python has handed the frame over (with a
software driver this holds the vertex work), ``median`` until it is finished.

    python tests/benchmarks/bare_cubes.py --cubes 10000 --frames 100
"""

import argparse
import json
import math
import time
from pathlib import Path

import moderngl
import numpy as np

MATERIALS = 16
VERTEX = """
#version 330 core
uniform mat4 view_projection;
in vec3 in_position, in_normal;
in vec4 in_row_0, in_row_1, in_row_2;  // affine transform, row by row
in float in_material;
out vec3 position, normal;
flat out int material;
void main() {
    vec4 p = vec4(in_position, 1.0);
    position = vec3(dot(in_row_0, p), dot(in_row_1, p), dot(in_row_2, p));
    normal = vec3(dot(in_row_0.xyz, in_normal), dot(in_row_1.xyz, in_normal),
                  dot(in_row_2.xyz, in_normal));
    material = int(in_material);
    gl_Position = view_projection * vec4(position, 1.0);
}
"""
FRAGMENT = """
#version 330 core
in vec3 position, normal;
flat in int material;
struct Material { vec4 base_metalness; vec4 roughness; };
layout(std140) uniform Materials { Material materials[16]; };
uniform vec3 eye, light;
out vec4 colour;
void main() {
    vec3 base = materials[material].base_metalness.rgb;
    float metalness = materials[material].base_metalness.a;
    float a2 = pow(materials[material].roughness.x, 4.0);
    vec3 n = normalize(normal), v = normalize(eye - position);
    vec3 h = normalize(v + light);
    float nv = max(dot(n, v), 1e-4), nl = max(dot(n, light), 0.0);
    float nh = max(dot(n, h), 0.0), vh = max(dot(v, h), 0.0);
    float q = nh * nh * (a2 - 1.0) + 1.0;
    float d = a2 / (3.14159265 * q * q);
    float smith = 0.5 / (nl * sqrt(nv * nv * (1.0 - a2) + a2)
                         + nv * sqrt(nl * nl * (1.0 - a2) + a2));
    vec3 f0 = mix(vec3(0.04), base, metalness);
    vec3 f = f0 + (1.0 - f0) * pow(1.0 - vh, 5.0);
    vec3 diffuse = (1.0 - f) * (1.0 - metalness) * base * 0.31830989;
    colour = vec4((diffuse + d * smith * f) * nl * 3.0 + base * 0.03, 1.0);
}
"""


def cube() -> tuple[np.ndarray, np.ndarray]:
    """Vertices (24, 6) of position and normal, indices (36,)."""
    vertices, indices = [], []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            normal = np.eye(3)[axis] * sign
            u = np.eye(3)[(axis + 1) % 3]
            v = np.cross(normal, u)
            first = len(vertices)
            vertices += [
                [*(0.5 * (normal + s * u + t * v)), *normal]
                for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))
            ]
            indices += [first + i for i in (0, 1, 2, 0, 2, 3)]
    return np.array(vertices, np.float32), np.array(indices, np.uint16)


def instances(count: int) -> np.ndarray:
    """Rows (count, 13): a cubic lattice turned at random, and materials."""
    random = np.random.default_rng(1)
    side = math.ceil(count ** (1 / 3))
    places = np.stack(np.unravel_index(np.arange(count), (side,) * 3), -1)
    q = random.normal(size=(count, 4))
    w, x, y, z = (q / np.linalg.norm(q, axis=1, keepdims=True)).T
    rotation = np.stack(
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
         2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
         2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        -1,
    ).reshape(count, 3, 3)  # fmt: skip
    rows = np.empty((count, 13), np.float32)
    matrices = rows[:, :12].reshape(count, 3, 4)
    matrices[:, :, :3] = rotation * 0.5
    matrices[:, :, 3] = places - (side - 1) / 2
    rows[:, :12] = matrices.reshape(count, 12)
    rows[:, 12] = np.arange(count) % MATERIALS
    return rows


def camera(yaw: float, distance: float) -> tuple[bytes, bytes]:
    """View-projection and eye of an orbit around the origin."""
    eye = distance * np.array((math.sin(yaw), 0.5, math.cos(yaw)))
    back = eye / np.linalg.norm(eye)
    right = np.cross((0, 1, 0), back)
    right /= np.linalg.norm(right)
    view = np.eye(4)
    view[:3, :3] = right, np.cross(back, right), back
    view[:3, 3] = -view[:3, :3] @ eye
    near, far = distance / 10, distance * 3
    y = 1 / math.tan(math.radians(45) / 2)
    projection = np.diag((y, y, (far + near) / (near - far), 0.0))
    projection[2, 3] = 2 * far * near / (near - far)
    projection[3, 2] = -1
    matrix = (projection @ view).T.astype("f4")
    return matrix.tobytes(), eye.astype("f4").tobytes()


def main() -> None:
    """Draw, time, print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cubes", type=int, default=10_000)
    parser.add_argument("--frames", type=int, default=100)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument(
        "--moving", action="store_true", help="write all transforms each frame"
    )
    parser.add_argument("-o", "--output", type=Path, help="PNG of the last")
    options = parser.parse_args()

    ctx = moderngl.create_context(
        standalone=True,
        backend="egl",
        libgl="libGL.so.1",
        libegl="libEGL.so.1",
    )
    # glibc then keeps freed blocks of this size: a software driver allocates
    # its transformed vertices anew in every frame, and page faults cost more
    # than the transformation.
    ctx.buffer(reserve=1 << 24).release()
    program = ctx.program(VERTEX, FRAGMENT)
    random = np.random.default_rng(2)
    materials = random.random((MATERIALS, 8), np.float32)
    materials[:, 3] = materials[:, 3] > 0.5
    materials[:, 4] = 0.1 + 0.9 * materials[:, 4]
    ctx.buffer(materials.tobytes()).bind_to_uniform_block(0)
    program["Materials"].binding = 0
    program["light"] = (0.48, 0.8, 0.36)
    vertices, indices = cube()
    rows = instances(options.cubes)
    buffer = ctx.buffer(rows.tobytes(), dynamic=options.moving)
    mesh = ctx.buffer(vertices.tobytes())
    per_instance = ("in_row_0", "in_row_1", "in_row_2", "in_material")
    draw = ctx.vertex_array(
        program,
        [
            (mesh, "3f 3f", "in_position", "in_normal"),
            (buffer, "4f 4f 4f 1f/i", *per_instance),
        ],
        ctx.buffer(indices.tobytes()),
        index_element_size=2,
    )
    size = (options.size, options.size)
    target = ctx.framebuffer(
        [ctx.texture(size, 4)], ctx.depth_renderbuffer(size)
    )
    target.use()
    ctx.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
    distance = 2.05 * math.ceil(options.cubes ** (1 / 3))

    submits, times = [], []
    for index in range(options.frames + 3):
        start = time.perf_counter()
        if options.moving:
            rows[:, 3] += 0.001
            buffer.orphan()
            buffer.write(rows)
        view_projection, eye = camera(index * 0.01, distance)
        program["view_projection"].write(view_projection)
        program["eye"].write(eye)
        target.clear(0.02, 0.02, 0.03)
        draw.render(instances=options.cubes)
        submits.append((time.perf_counter() - start) * 1e3)
        ctx.finish()
        times.append((time.perf_counter() - start) * 1e3)
    submits, times = sorted(submits[3:]), sorted(times[3:])
    middle = len(times) // 2
    print(
        json.dumps(
            {
                "frame_ms": {
                    "median": round(times[middle], 3),
                    "p95": round(times[int(0.95 * len(times))], 3),
                    "submit_median": round(submits[middle], 3),
                },
                "counts": {"objects": options.cubes, "gl_draws": 1},
            }
        )
    )
    if options.output:
        from PIL import Image

        image = Image.frombytes("RGB", size, target.read(components=3))
        image.transpose(Image.Transpose.FLIP_TOP_BOTTOM).save(options.output)


if __name__ == "__main__":
    main()
