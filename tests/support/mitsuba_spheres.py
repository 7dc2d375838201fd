"""Pictures of a sphere by Mitsuba 3, a path tracer of other people.

It has its own idea of what an environment map, a camera, a normal and a unit
of radiance are, so that a mistake shared by moka and its oracles would show.
Its microfacet term is the separable Smith, which is why the BSDF is written
for it here, from glTF 2.0, appendix B.3, and Heitz 2014.

Run as a program, ``python -m tests.support.mitsuba_spheres OUT.npz``, so that
its threads and its idea of Python's exit stay out of the tests' process. The
scalar variant runs everywhere; those with LLVM end in the middle of a picture
where its version does not know the processor.
"""

import sys
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from moka.lighting.equirectangular import uv_to_direction

SIZE = 16  # pixels along an edge, which the sphere touches
SAMPLES = 256


class Ball(NamedTuple):
    """A material; roughness 0 and metalness 1 is a perfect mirror."""

    colour: tuple[float, float, float]
    metalness: float
    roughness: float


CLAY = (0.8, 0.3, 0.2)
GOLD = (1.0, 0.77, 0.34)
BALLS = {
    "mirror": Ball((1.0, 1.0, 1.0), 1.0, 0.0),
    "matt clay": Ball(CLAY, 0.0, 1.0),
    "glazed clay": Ball(CLAY, 0.0, 0.4),
    "rough gold": Ball(GOLD, 1.0, 0.6),
}


def environment_map(height: int = 512) -> NDArray[np.float32]:
    """Different in every direction, and smooth: no texel is seen."""
    u, v = np.meshgrid(
        (np.arange(2 * height) + 0.5) / (2 * height),
        (np.arange(height) + 0.5) / height,
    )
    x, y, z = np.moveaxis(uv_to_direction(np.stack([u, v], -1)), -1, 0)
    window = 6 * np.exp(12 * (0.6 * x + 0.64 * y + 0.48 * z - 1))
    return np.stack(
        [0.6 + 0.5 * x + window, 0.7 + 0.6 * y + window, 0.5 + 0.4 * z],
        axis=-1,
    ).astype(np.float32)


def register_bsdf(mi: Any) -> None:
    """Teach Mitsuba ``gltf``, of a colour, a metalness and a roughness."""
    import drjit as dr

    class Gltf(mi.BSDF):
        def __init__(self, properties: Any) -> None:
            mi.BSDF.__init__(self, properties)
            colour = mi.Color3f(properties["colour"])
            metalness = properties["metalness"]
            self.alpha = properties["roughness"] ** 2
            self.f0 = 0.04 * (1 - metalness) + colour * metalness
            self.diffuse = colour * (1 - metalness)
            flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
            self.m_components = [flags]
            self.m_flags = flags

        def sample(
            self, ctx: Any, si: Any, _: Any, point: Any, active: Any
        ) -> Any:
            wo = mi.warp.square_to_cosine_hemisphere(point)
            record = mi.BSDFSample3f()
            record.wo = wo
            record.pdf = self.pdf(ctx, si, wo, active)
            record.eta = 1.0
            record.sampled_type = mi.UInt32(+self.m_flags)
            record.sampled_component = mi.UInt32(0)
            if record.pdf == 0.0:
                return record, mi.Color3f(0.0)
            return record, self.eval(ctx, si, wo, active) / record.pdf

        def pdf(self, _: Any, si: Any, wo: Any, active: Any) -> Any:
            above = (mi.Frame3f.cos_theta(si.wi) > 0) & (wo.z > 0)
            density = mi.warp.square_to_cosine_hemisphere_pdf(wo)
            return dr.select(above & active, density, 0.0)

        def eval(self, _: Any, si: Any, wo: Any, active: Any) -> Any:
            wi, squared = si.wi, self.alpha**2
            h = dr.normalize(wi + wo)
            tangent = (1 - h.z**2) / h.z**2
            d = squared / (dr.pi * h.z**4 * (squared + tangent) ** 2)

            def smith(z: Any) -> Any:
                return (dr.sqrt(1 + squared * (1 - z**2) / z**2) - 1) / 2

            g = 1 / (1 + smith(wi.z) + smith(wo.z))
            fresnel = self.f0 + (1 - self.f0) * (1 - dr.dot(wi, h)) ** 5
            value = fresnel * (d * g / (4 * wi.z * wo.z))
            value += (1 - fresnel) * self.diffuse / dr.pi
            above = active & (wi.z > 0) & (wo.z > 0)
            return dr.select(above, value * wo.z, 0.0)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any) -> Any:
            return (
                self.eval(ctx, si, wo, active),
                self.pdf(ctx, si, wo, active),
            )

    mi.register_bsdf("gltf", Gltf)


def trace(mi: Any, ball: Ball) -> NDArray[np.float32]:
    """The picture (SIZE, SIZE, 3), the top row first."""
    # Its maps begin at -Z and end there, ours at -X; both turn the same way.
    pixels = environment_map()
    turned = np.roll(pixels, -pixels.shape[1] // 4, axis=1)
    bsdf = {
        "type": "gltf",
        "colour": mi.ScalarColor3f(ball.colour),
        "metalness": ball.metalness,
        "roughness": ball.roughness,
    }
    if ball.roughness == 0.0:
        bsdf = {"type": "conductor", "material": "none"}
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "direct"},
            "light": {
                "type": "envmap",
                "bitmap": mi.Bitmap(np.ascontiguousarray(turned)),
            },
            "ball": {"type": "sphere", "bsdf": bsdf},
            "camera": {
                "type": "orthographic",
                "to_world": mi.ScalarTransform4f().look_at(
                    origin=[0, 0, 5], target=[0, 0, 0], up=[0, 1, 0]
                ),
                "film": {
                    "type": "hdrfilm",
                    "width": SIZE,
                    "height": SIZE,
                    "rfilter": {"type": "box"},
                },
                "sampler": {"type": "multijitter", "sample_count": SAMPLES},
            },
        }
    )
    return np.asarray(mi.render(scene), np.float32)[:, :, :3]


def main(path: str) -> None:
    """Write the pictures of all balls by their names."""
    import drjit as dr
    import mitsuba as mi

    # A BSDF in Python holds the interpreter; threads would only wait for it.
    dr.set_thread_count(1)
    mi.set_variant("scalar_rgb")
    register_bsdf(mi)
    np.savez(path, **{name: trace(mi, ball) for name, ball in BALLS.items()})


if __name__ == "__main__":
    main(sys.argv[1])
