// What a material says at one point: its row's factors times its textures
// (glTF 2.0, 3.9). The block Materials is injected.

#include "include/surface_point.glsl"

// SURFACE_UV(slot, SLOT) is the texture coordinate of a slot: its set, moved
// by its KHR_texture_transform if it has one.
#define UV_OF_SET(set) UV_OF_SET_(set)
#define UV_OF_SET_(set) surface_uv_##set

#ifdef MOKA_BASE_COLOUR_TEXTURE
uniform sampler2D base_colour_texture;
#endif
#ifdef MOKA_METALLIC_ROUGHNESS_TEXTURE
uniform sampler2D metallic_roughness_texture;
#endif
#ifdef MOKA_NORMAL_TEXTURE
uniform sampler2D normal_texture;
#endif
#ifdef MOKA_OCCLUSION_TEXTURE
uniform sampler2D occlusion_texture;
#endif
#ifdef MOKA_EMISSIVE_TEXTURE
uniform sampler2D emissive_texture;
#endif
#ifdef MOKA_SPECULAR_TEXTURE
uniform sampler2D specular_texture;
#endif
#ifdef MOKA_SPECULAR_COLOUR_TEXTURE
uniform sampler2D specular_colour_texture;
#endif

MaterialsRow material_row() {
    return materials[surface_material];
}

vec4 base_colour(MaterialsRow row) {
    vec4 colour = row.base_colour_factor;
#ifdef MOKA_VERTEX_COLOUR
    colour *= surface_colour;
#endif
#ifdef MOKA_BASE_COLOUR_TEXTURE
    TEXTURE_PLACE uv = UV_OF_SET(MOKA_BASE_COLOUR_UV);
#ifdef MOKA_BASE_COLOUR_TRANSFORM
    uv = transformed(uv, row.base_colour_transform);
#endif
    colour *= read_texture(base_colour_texture, uv);
#endif
    return colour;
}

// x occlusion, y roughness, z metalness: the channels of glTF's packing.
vec3 occlusion_roughness_metalness(MaterialsRow row) {
    vec3 packed_values = vec3(1.0, row.roughness_factor, row.metallic_factor);
#ifdef MOKA_METALLIC_ROUGHNESS_TEXTURE
    TEXTURE_PLACE uv = UV_OF_SET(MOKA_METALLIC_ROUGHNESS_UV);
#ifdef MOKA_METALLIC_ROUGHNESS_TRANSFORM
    uv = transformed(uv, row.metallic_roughness_transform);
#endif
    vec3 texel = read_texture(metallic_roughness_texture, uv).rgb;
    packed_values.yz *= texel.gb;
#ifdef MOKA_PACKED_OCCLUSION
    packed_values.x = 1.0 + row.occlusion_strength * (texel.r - 1.0);
#endif
#endif
#ifdef MOKA_OCCLUSION_TEXTURE
    TEXTURE_PLACE occlusion_uv = UV_OF_SET(MOKA_OCCLUSION_UV);
#ifdef MOKA_OCCLUSION_TRANSFORM
    occlusion_uv = transformed(occlusion_uv, row.occlusion_transform);
#endif
    float occlusion = read_texture(occlusion_texture, occlusion_uv).r;
    packed_values.x = 1.0 + row.occlusion_strength * (occlusion - 1.0);
#endif
#ifdef MOKA_ROUGHNESS_CARRIER
    // In alphas of other textures: the same samples as theirs, once compiled.
    TEXTURE_PLACE carried_uv = UV_OF_SET(MOKA_CARRIED_UV);
    packed_values.y *= read_texture(MOKA_ROUGHNESS_CARRIER, carried_uv).a;
    packed_values.z *= read_texture(MOKA_METALNESS_CARRIER, carried_uv).a;
#ifdef MOKA_OCCLUSION_CARRIER
    packed_values.x = 1.0 + row.occlusion_strength
        * (read_texture(MOKA_OCCLUSION_CARRIER, carried_uv).a - 1.0);
#endif
#endif
    return clamp(packed_values, 0.0, 1.0);
}

vec3 emission(MaterialsRow row) {
    vec3 radiance = row.emissive_factor;
#ifdef MOKA_EMISSIVE_TEXTURE
    TEXTURE_PLACE uv = UV_OF_SET(MOKA_EMISSIVE_UV);
#ifdef MOKA_EMISSIVE_TRANSFORM
    uv = transformed(uv, row.emissive_transform);
#endif
    radiance *= read_texture(emissive_texture, uv).rgb;
#endif
    return radiance;
}

#ifdef MOKA_SPECULAR
// What a dielectric reflects head-on, rgb, and at grazing, a:
// KHR_materials_specular, with the F0 of KHR_materials_ior in the row.
vec4 dielectric_reflectance(MaterialsRow row) {
    vec4 reflectance = vec4(row.dielectric_f0, row.specular_factor);
#ifdef MOKA_SPECULAR_COLOUR_TEXTURE
    TEXTURE_PLACE colour_uv = UV_OF_SET(MOKA_SPECULAR_COLOUR_UV);
#ifdef MOKA_SPECULAR_COLOUR_TRANSFORM
    colour_uv = transformed(colour_uv, row.specular_colour_transform);
#endif
    reflectance.rgb *= read_texture(specular_colour_texture, colour_uv).rgb;
#endif
#ifdef MOKA_SPECULAR_TEXTURE
    TEXTURE_PLACE uv = UV_OF_SET(MOKA_SPECULAR_UV);
#ifdef MOKA_SPECULAR_TRANSFORM
    uv = transformed(uv, row.specular_transform);
#endif
    reflectance.a *= read_texture(specular_texture, uv).a;
#endif
    reflectance.rgb = min(reflectance.rgb, 1.0) * reflectance.a;
    return reflectance;
}
#endif
