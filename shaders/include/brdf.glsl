// Specular reflection: glTF 2.0 appendix B, and two models to compare with.
//
// MOKA_BRDF_GLTF         GGX, height-correlated Smith, Schlick (the default)
// MOKA_BRDF_KARIS        GGX, Schlick-GGX, Schlick: Karis 2013, "Real
//                        Shading in Unreal Engine 4"
// MOKA_BRDF_BLINN_PHONG  normalised Blinn-Phong, Schlick
//
// A BRDF here is D V F with V = G / (4 n.l n.v), so that no denominator
// needs an epsilon.

#include "include/angles.glsl"
#include "include/constants.glsl"
#include "include/fresnel.glsl"

// A punctual light has no extent, and its mirror image in a perfectly smooth
// surface would have no area. Its lobe is never narrower than the half
// vectors that see the disc of the sun (0.53 degrees wide: 0.0023 rad either
// side), which also bounds D by 8e4. The lobe keeps its energy.
const float MINIMUM_ALPHA = 0.002;

float alpha_from_roughness(float roughness) {
    return max(roughness * roughness, MINIMUM_ALPHA);
}

// Trowbridge and Reitz 1975; Walter et al. 2007, equation 33. The form with
// |n x h|^2 in place of 1 - (n.h)^2 (Lagrange's identity) does not cancel
// near the peak, where the latter is rounding error for a small alpha.
float distribution_ggx(
    float n_dot_h, float n_cross_h_squared, float alpha
) {
    float scaled = n_dot_h * alpha;
    float k = alpha / (n_cross_h_squared + scaled * scaled);
    return k * k * INVERSE_PI;
}

// Heitz 2014, "Understanding the Masking-Shadowing Function", equation 99,
// divided by 4 n.l n.v. Finite unless both cosines are 0.
float visibility_smith_ggx_correlated(
    float n_dot_l, float n_dot_v, float alpha
) {
    float squared = alpha * alpha;
    float view =
        n_dot_l * sqrt(n_dot_v * n_dot_v * (1.0 - squared) + squared);
    float light =
        n_dot_v * sqrt(n_dot_l * n_dot_l * (1.0 - squared) + squared);
    return 0.5 / (view + light);
}

// Schlick 1994, equation 19, for both directions, divided by 4 n.l n.v.
// Infinite for k = 0 at a cosine of 0, which only MINIMUM_N_DOT_V and
// n.l > 0 keep out.
float visibility_schlick_ggx(float n_dot_l, float n_dot_v, float k) {
    float light = n_dot_l * (1.0 - k) + k;
    float view = n_dot_v * (1.0 - k) + k;
    return 0.25 / (light * view);
}

// Karis 2013, equation 4: k for punctual lights, with roughness remapped.
float schlick_k_direct(float roughness) {
    float remapped = roughness + 1.0;
    return remapped * remapped / 8.0;
}

// Karis 2013: k = alpha / 2, for light from an environment.
float schlick_k_environment(float roughness) {
    return 0.5 * roughness * roughness;
}

// Lagarde 2011, "Adopting a physically based shading model": the grazing
// reflectance that a rough surface has on average.
vec3 f90_of_rough_surface(vec3 f0, float roughness) {
    return max(vec3(1.0 - roughness), f0);
}

// Blinn 1977, normalised to reflect all light at normal incidence (Giesen
// 2009), with the exponent that gives its lobe the width of GGX's (Walter et
// al. 2007, section 5.1). (n.h)^n is exp(n/2 log(1 - |n x h|^2)), and the
// logarithm a series near the peak, where n is too large for n.h.
float blinn_phong(float n_cross_h_squared, float alpha) {
    float n = 2.0 / (alpha * alpha) - 2.0;
    float s = n_cross_h_squared;
    float logarithm = s < 0.01
        ? -s * (1.0 + s * (0.5 + s / 3.0))
        : log(max(1.0 - s, 1e-12));
    float scale = (n + 2.0) * (n + 4.0) / (8.0 * PI * (exp2(-0.5 * n) + n));
    return scale * exp(0.5 * n * logarithm);
}

// The specular BRDF without its Fresnel term. k is that of Schlick-GGX and
// read by MOKA_BRDF_KARIS alone.
float specular_lobe(Angles angles, float alpha, float k) {
#if defined(MOKA_BRDF_BLINN_PHONG)
    return blinn_phong(angles.n_cross_h_squared, alpha);
#else
    float d = distribution_ggx(
        angles.n_dot_h, angles.n_cross_h_squared, alpha);
#if defined(MOKA_BRDF_KARIS)
    return d * visibility_schlick_ggx(angles.n_dot_l, angles.n_dot_v, k);
#else
    return d * visibility_smith_ggx_correlated(
        angles.n_dot_l, angles.n_dot_v, alpha);
#endif
#endif
}

// The specular BRDF for a punctual light.
vec3 specular_brdf(Angles angles, float roughness, vec3 f0, vec3 f90) {
    float lobe = specular_lobe(
        angles, alpha_from_roughness(roughness), schlick_k_direct(roughness));
    return lobe * fresnel_schlick(angles.v_dot_h, f0, f90);
}
