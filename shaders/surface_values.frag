// What a surface is, instead of how it looks: one target for each four
// values that are wanted (moka.renderer.surface_values names them).

#include "include/fresnel.glsl"
#include "include/material.glsl"
#include "include/logarithmic_depth.glsl"
#include "include/shading_normal.glsl"

flat in uint surface_object;

#ifdef MOKA_VALUES_NORMAL_DEPTH
layout(location = MOKA_VALUES_NORMAL_DEPTH) out vec4 normal_depth;
#endif
#ifdef MOKA_VALUES_ALBEDO_ROUGHNESS
layout(location = MOKA_VALUES_ALBEDO_ROUGHNESS) out vec4 albedo_roughness;
#endif
#ifdef MOKA_VALUES_EMISSION_METALNESS
layout(location = MOKA_VALUES_EMISSION_METALNESS) out vec4 emission_metalness;
#endif
#ifdef MOKA_VALUES_TANGENT_LEVEL
layout(location = MOKA_VALUES_TANGENT_LEVEL) out vec4 tangent_level;
#endif
#ifdef MOKA_VALUES_FRESNEL
layout(location = MOKA_VALUES_FRESNEL) out vec4 fresnel;
#endif
#ifdef MOKA_VALUES_OVERDRAW
layout(location = MOKA_VALUES_OVERDRAW) out vec4 overdraw;
#endif
#ifdef MOKA_VALUES_UV_OCCLUSION_OBJECT
layout(location = MOKA_VALUES_UV_OCCLUSION_OBJECT) out vec4 uv_occlusion_object;
#endif

// Along the view axis, positive in front of the camera. A perspective's
// fourth row is that axis; parallel rays go along `eye`.
float view_distance(vec3 point) {
    vec4 axis = vec4(
        clip_from_world[0].w, clip_from_world[1].w, clip_from_world[2].w,
        clip_from_world[3].w);
    return eye.w > 0.0
        ? dot(axis, vec4(point, 1.0)) : -dot(eye.xyz, point);
}

#ifdef MOKA_VALUES_TANGENT_LEVEL
// Where the first texture coordinate grows, as normal mapping has it.
vec3 value_of_tangent() {
#if defined(MOKA_VERTEX_TANGENT)
    return direction_of(surface_tangent.xyz);
#elif defined(MOKA_NORMAL_TEXTURE)
    return direction_of(tangent_frame(
        front_normal(), UV_OF_SET(MOKA_NORMAL_UV))[0]);
#else
    return vec3(0.0);
#endif
}

// The level that is sampled, after OpenGL 4.6, 8.14: of the longer of the
// two steps from pixel to pixel, in texels.
float base_colour_level(MaterialsRow row) {
#ifdef MOKA_BASE_COLOUR_TEXTURE
    vec2 uv = UV_OF_SET(MOKA_BASE_COLOUR_UV);
#ifdef MOKA_BASE_COLOUR_TRANSFORM
    uv = transformed(uv, row.base_colour_transform);
#endif
    uv *= vec2(textureSize(base_colour_texture, 0));
    vec2 across = dFdx(uv);
    vec2 up = dFdy(uv);
    float squared = max(dot(across, across), dot(up, up));
    return 0.5 * log2(max(squared, 1.0));
#else
    return 0.0;
#endif
}
#endif

void main() {
#ifdef MOKA_LOGARITHMIC_DEPTH
    write_depth();
#endif
    MaterialsRow row = material_row();
    vec4 base = base_colour(row);
#ifdef MOKA_ALPHA_MASK
    if (base.a < row.alpha_cutoff) discard;
#endif
    vec3 packed_values = occlusion_roughness_metalness(row);
#ifdef MOKA_VALUES_NORMAL_DEPTH
    normal_depth = vec4(shading_normal(row), view_distance(surface_position));
#endif
#ifdef MOKA_VALUES_ALBEDO_ROUGHNESS
    albedo_roughness = vec4(base.rgb, packed_values.y);
#endif
#ifdef MOKA_VALUES_EMISSION_METALNESS
    emission_metalness = vec4(emission(row), packed_values.z);
#endif
#ifdef MOKA_VALUES_FRESNEL
    // As lighting.glsl mixes a dielectric and a metal.
    vec3 f0 = mix(vec3(0.04), base.rgb, packed_values.z);
    float cosine = clamp(dot(shading_normal(row), surface_view()), 0.0, 1.0);
    fresnel = vec4(fresnel_schlick(cosine, f0, vec3(1.0)), 0.0);
#ifdef MOKA_SPECULAR
    vec4 dielectric = dielectric_reflectance(row);
    f0 = mix(dielectric.rgb, base.rgb, packed_values.z);
    vec3 f90 = vec3(mix(dielectric.a, 1.0, packed_values.z));
    fresnel = vec4(fresnel_schlick(cosine, f0, f90), 0.0);
#endif
#endif
#ifdef MOKA_VALUES_OVERDRAW
    // Added up by the blending.
    overdraw = vec4(1.0);
#endif
#ifdef MOKA_VALUES_TANGENT_LEVEL
    tangent_level = vec4(value_of_tangent(), base_colour_level(row));
#endif
#ifdef MOKA_VALUES_UV_OCCLUSION_OBJECT
#if defined(MOKA_UV_0)
    vec2 uv = surface_uv_0;
#elif defined(MOKA_UV_1)
    vec2 uv = surface_uv_1;
#else
    vec2 uv = vec2(0.0);
#endif
    uv_occlusion_object = vec4(uv, packed_values.x, float(surface_object));
#endif
}
