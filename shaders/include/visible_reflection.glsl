// Directions that a GGX surface reflects towards a viewer, around (0, 0, 1).
//
// Eto and Tokuyoshi 2023, "Bounded VNDF Sampling for Smith-GGX Reflections":
// Dupuy and Benyoub's spherical caps, cut where every reflection is below
// the surface. At roughness 1 half of the unbounded samples were lost.

#include "include/brdf.glsl"

// The paper's k for v.z >= 0: how much of the cap below the equator is kept.
float cap_bound(vec3 v, float alpha) {
    float squared = alpha * alpha;
    float s = 1.0 + sqrt(max(1.0 - v.z * v.z, 0.0));
    float s_squared = s * s;
    return (1.0 - squared) * s_squared
        / (s_squared + squared * v.z * v.z);
}

// Half vectors; the reflection of v about one is sample_visible_reflection's.
vec3 sample_reflecting_normal(vec2 point, vec3 v, float alpha) {
    vec3 stretched = normalize(vec3(v.xy * alpha, v.z));
    float angle = 2.0 * PI * point.x;
    float lowest = cap_bound(v, alpha) * stretched.z;
    float z = 1.0 - point.y * (1.0 + lowest);
    float radius = sqrt(max(1.0 - z * z, 0.0));
    vec3 h = vec3(radius * cos(angle), radius * sin(angle), z) + stretched;
    return normalize(vec3(h.xy * alpha, h.z));
}

vec3 sample_visible_reflection(vec2 point, vec3 v, float alpha) {
    vec3 h = sample_reflecting_normal(point, v, alpha);
    return 2.0 * dot(v, h) * h - v;
}

// Its density per steradian; ``d`` is the distribution at the half vector.
float visible_reflection_density(float d, vec3 v, float alpha) {
    float stretch = length(vec3(v.xy * alpha, v.z));
    return d / (2.0 * (cap_bound(v, alpha) * v.z + stretch));
}
