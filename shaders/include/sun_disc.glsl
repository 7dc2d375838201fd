// Suns: lights that are discs. Their lobe, and directions from them.

#include "include/brdf.glsl"
#include "include/sampling.glsl"

// GGX averaged over the disc, of angular radius R around l, of a sun.
// ``offset_squared`` is |l - r|^2 for the mirrored view r.
//
// In the plane of slopes GGX is alpha^2 / (pi (alpha^2 + s^2)^2): an even
// distribution over a sphere, seen by stereographic projection. That takes
// circles to circles, so the integral over a disc is the area of a cap, in
// closed form. It is exact, for small angles, where the view meets the disc
// face-on: from a mirror, in which the disc has its edge, to a lobe in which
// it is a point.
//
// At an angle the half vectors that see the disc fill an ellipse, of R / 2
// in the plane of incidence and R / (2 v.h) across. ``reach`` is its squared
// radius in the direction of this h, and the edge of a mirror's image is
// where it belongs. What is divided by is the ellipse's own area for a
// mirror and that of the circle of this radius for a wide lobe; the integral
// over all directions is 1 with any of both.
float distribution_ggx_of_disc(
    Angles angles, float offset_squared, float alpha, float radius
) {
    float v_dot_h = max(angles.v_dot_h, 1e-3);
    float sine = angles.n_cross_h_squared;
    float cosine = angles.n_dot_h * angles.n_dot_h;
    float squared = alpha * alpha;
    // In the middle of the disc no direction is named, and any will do.
    float ratio = (sine + 1e-9) / (offset_squared + 4e-9 * v_dot_h);
    ratio = clamp(ratio, 0.25, 0.25 / (v_dot_h * v_dot_h));
    float reach = radius * radius * ratio;
    float x = sine + cosine * (squared - reach);
    float y = 2.0 * cosine * alpha * sqrt(reach);
    float size = sqrt(x * x + y * y);
    float d = x > 0.0
        ? 2.0 * squared / (size * (size + x))
        : 0.5 * (size - x) / (reach * max(size, 1e-30));
    float mean_reach = 0.25 * radius * radius / v_dot_h;
    float shape =
        mix(4.0 * v_dot_h * ratio, 1.0, squared / (squared + mean_reach));
    return INVERSE_PI * shape * d;
}

// The specular BRDF, without its Fresnel term, averaged over a sun's disc;
// Schlick-GGX and Blinn-Phong for the models that have them. As a punctual
// light has no lobe below MINIMUM_ALPHA, so no disc is smaller than what such
// a lobe sees: half vectors of a disc lie in one half as wide.
float specular_lobe_of_disc(
    Angles angles, float offset_squared, float roughness, float radius
) {
    float alpha = roughness * roughness;
    radius = max(radius, 2.0 * MINIMUM_ALPHA);
#if defined(MOKA_BRDF_BLINN_PHONG)
    return blinn_phong(
        angles.n_cross_h_squared,
        sqrt(alpha * alpha + 0.25 * radius * radius));
#else
    float d =
        distribution_ggx_of_disc(angles, offset_squared, alpha, radius);
#if defined(MOKA_BRDF_KARIS)
    return d * visibility_schlick_ggx(
        angles.n_dot_l, angles.n_dot_v, schlick_k_direct(roughness));
#else
    return d * visibility_smith_ggx_correlated(
        angles.n_dot_l, angles.n_dot_v, alpha);
#endif
#endif
}

// The chord of half an angle, squared: 1 - cos(angle), without cancelling.
float versine(float angle) {
    float sine = sin(0.5 * angle);
    return 2.0 * sine * sine;
}

// Per steradian, of directions that are even over a disc.
float disc_density(float radius) {
    return 0.5 * INVERSE_PI / versine(radius);
}

bool is_in_disc(vec3 direction, vec3 centre, float radius) {
    vec3 chord = direction - centre;
    return dot(chord, chord) < 2.0 * versine(radius);
}

// A direction of that density, for a point of the unit square.
vec3 sample_disc(vec2 point, vec3 centre, float radius) {
    float lowered = point.y * versine(radius);
    float sine = sqrt(lowered * (2.0 - lowered));
    float angle = 2.0 * PI * point.x;
    return tangent_basis(centre)
        * vec3(sine * cos(angle), sine * sin(angle), 1.0 - lowered);
}
