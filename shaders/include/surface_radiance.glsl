// The radiance of a model's surface: glTF 2.0's metallic-roughness material.
//
// A permutation has only what its material uses; moka.material.description
// makes the defines. Radiance leaves premultiplied by coverage.

#include "include/material.glsl"
#include "include/shading_normal.glsl"
#include "include/bumps.glsl"
#include "include/lighting.glsl"

#ifndef MOKA_UNLIT
// All that comes from elsewhere.
vec3 received_light(Surface surface) {
    vec3 light = vec3(0.0);
#ifdef MOKA_ENVIRONMENT
    light += environment_light(surface);
#endif
#ifdef MOKA_PUNCTUAL_LIGHTS
    float spread = mirrored_spread(surface);
    surface.spread = has_neighbours() ? spread : 0.0;
    light += punctual_light(surface);
#endif
    return light;
}
#endif

vec4 surface_radiance() {
    MaterialsRow row = material_row();
    vec4 base = base_colour(row);
    float coverage = 1.0;
#if defined(MOKA_ALPHA_MASK)
    if (base.a < row.alpha_cutoff) discard;
#elif defined(MOKA_ALPHA_BLEND)
    coverage = clamp(base.a, 0.0, 1.0);
#endif
#ifdef MOKA_UNLIT
    vec3 light = base.rgb;
#ifdef MOKA_EMISSIVE
    light += emission(row);
#endif
#else
    vec3 packed_values = occlusion_roughness_metalness(row);
#ifdef MOKA_NORMAL_VARIANCE
    packed_values.y = roughness_with_bumps(packed_values.y, row);
#endif
    vec3 view = surface_view();
    Surface surface = make_surface(
        base.rgb, packed_values.z, packed_values.y, packed_values.x,
        shading_normal(row), view);
#ifdef MOKA_SPECULAR
    cover_with(
        dielectric_reflectance(row), base.rgb, packed_values.z, surface);
#endif
#ifdef MOKA_PART_IRRADIANCE
    // Of a white base without an interface: E / pi.
    surface.diffuse_colour = vec3(1.0);
    surface.f0 = surface.f90 = vec3(0.0);
#ifdef MOKA_SPECULAR
    surface.dielectric = vec4(0.0);
    surface.covering_f0 = vec3(0.0);
#endif
#endif
    vec3 light = received_light(surface);
#if defined(MOKA_PART_DIFFUSE) || defined(MOKA_PART_SPECULAR)
    // What is left without a diffuse base is what the interface reflects.
    surface.diffuse_colour = vec3(0.0);
    vec3 specular = received_light(surface);
#ifdef MOKA_PART_SPECULAR
    light = specular;
#else
    light = max(light - specular, 0.0);
#endif
#elif defined(MOKA_EMISSIVE) && !defined(MOKA_PART_IRRADIANCE)
    light += emission(row);
#endif
#endif
    light = min(light, RADIANCE_MAXIMUM);
    return vec4(light * coverage, coverage);
}
