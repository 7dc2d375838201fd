// Point sets, and directions distributed like a lobe.

#include "include/constants.glsl"

// Van der Corput's radical inverse in base 2 (Warren 2001, Hacker's Delight,
// section 7-1). A float holds 24 bits, and rounding more of them could give
// 1, which lies outside the set.
float radical_inverse(uint bits) {
    bits = (bits << 16u) | (bits >> 16u);
    bits = ((bits & 0x55555555u) << 1u) | ((bits & 0xAAAAAAAAu) >> 1u);
    bits = ((bits & 0x33333333u) << 2u) | ((bits & 0xCCCCCCCCu) >> 2u);
    bits = ((bits & 0x0F0F0F0Fu) << 4u) | ((bits & 0xF0F0F0F0u) >> 4u);
    bits = ((bits & 0x00FF00FFu) << 8u) | ((bits & 0xFF00FF00u) >> 8u);
    return float(bits >> 8u) / 16777216.0;
}

// Hammersley's point set of ``count`` points, moved to the middle of its
// cells so that no point lies on a border.
vec2 hammersley(uint index, uint count) {
    float cell = 1.0 / float(count);
    return vec2(
        (float(index) + 0.5) * cell, radical_inverse(index) + 0.5 * cell);
}

// Duff et al. 2017, "Building an Orthonormal Basis, Revisited", listing 3:
// tangent, bitangent and n as columns, for any unit n.
mat3 tangent_basis(vec3 n) {
    float side = n.z < 0.0 ? -1.0 : 1.0;
    float a = -1.0 / (side + n.z);
    float b = n.x * n.y * a;
    return mat3(
        1.0 + side * n.x * n.x * a, side * b, -side * n.x,
        b, side + n.y * n.y * a, -n.y,
        n);
}

// Malley's method: density n.l / pi around (0, 0, 1).
vec3 sample_cosine_hemisphere(vec2 point) {
    float angle = 2.0 * PI * point.x;
    float radius = sqrt(point.y);
    return vec3(
        radius * cos(angle), radius * sin(angle), sqrt(1.0 - point.y));
}

// Walter et al. 2007, equations 35 and 36: half vectors around (0, 0, 1)
// with density D n.h; the sine keeps its precision for a small alpha.
vec3 sample_ggx(vec2 point, float alpha) {
    float angle = 2.0 * PI * point.x;
    float scale = 1.0 + (alpha * alpha - 1.0) * point.y;
    float sine = alpha * sqrt(point.y / scale);
    float cosine = sqrt((1.0 - point.y) / scale);
    return vec3(sine * cos(angle), sine * sin(angle), cosine);
}

// Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical
// Caps": half vectors with density G1(v) D v.h / n.v, v.z > 0.
vec3 sample_ggx_visible(vec2 point, vec3 v, float alpha) {
    vec3 stretched = normalize(vec3(v.xy * alpha, v.z));
    float angle = 2.0 * PI * point.x;
    float z = 1.0 - point.y * (1.0 + stretched.z);
    float radius = sqrt(max(1.0 - z * z, 0.0));
    vec3 cap = vec3(radius * cos(angle), radius * sin(angle), z);
    vec3 h = cap + stretched;
    return normalize(vec3(h.xy * alpha, h.z));
}
