// Light that a surface sends towards the viewer. Blocks Frame and Lights are
// injected.

#include "include/brdf.glsl"
#include "include/brdf_table.glsl"
#include "include/diffuse.glsl"
#include "include/direction.glsl"
#include "include/environment.glsl"
#include "include/multiscatter.glsl"
#include "include/sun_disc.glsl"

const vec3 DIELECTRIC_F0 = vec3(0.04);

// What the terms need to know of a point: glTF 2.0, appendix B.2.
struct Surface {
    vec3 diffuse_colour;
    vec3 f0;             // of dielectric and metal, mixed
    vec3 f90;
    float roughness;
    float occlusion;
    vec3 normal;
    vec3 view;   // towards the viewer
    vec2 table;  // of the BRDF table for this view and roughness
    float spread;  // of mirrored views over the pixel, see mirrored_spread
#ifdef MOKA_SPECULAR
    vec4 dielectric;  // its f0, and its f90 in a
    vec3 covering_f0;  // f0, the dielectric's grey: see cover_with
#endif
};

#ifdef MOKA_BRDF_TABLE
uniform sampler2D brdf_table;
#endif

Surface make_surface(
    vec3 base_colour, float metalness, float roughness, float occlusion,
    vec3 normal, vec3 view
) {
    Surface surface;
    surface.diffuse_colour = base_colour * (1.0 - metalness);
    surface.f0 = mix(DIELECTRIC_F0, base_colour, metalness);
    surface.f90 = vec3(1.0);
    surface.roughness = roughness;
    surface.occlusion = occlusion;
    surface.normal = normal;
    surface.view = view;
    surface.spread = 0.0;
#ifdef MOKA_BRDF_TABLE
    vec2 place = table_place(
        clamp_n_dot_v(dot(normal, view)), roughness,
        float(textureSize(brdf_table, 0).x));
    surface.table = textureLod(brdf_table, place, 0.0).rg;
#else
    surface.table = vec2(1.0, 0.0);
#endif
    return surface;
}

#ifdef MOKA_SPECULAR
// Give the dielectric, which is mixed with a metal, another interface than
// that of DIELECTRIC_F0: f0, and f90 in a. KHR_materials_specular lets the
// greatest channel of it decide what reaches the base in all of them, so that
// a coloured interface does not tint the base with its complement.
void cover_with(
    vec4 dielectric, vec3 base_colour, float metalness, inout Surface surface
) {
    float most = max(max(dielectric.r, dielectric.g), dielectric.b);
    surface.dielectric = dielectric;
    surface.f0 = mix(dielectric.rgb, base_colour, metalness);
    surface.covering_f0 = mix(vec3(most), base_colour, metalness);
    surface.f90 = vec3(mix(dielectric.a, 1.0, metalness));
}
#endif

// The part of an environment's light that reaches the diffuse base. With
// compensation it is what a dielectric's interface lets through: glTF 2.0,
// B.2.4, mixes a dielectric and a metal by metalness. Without, it is the mean
// of the 1 - F(v.h), of the mixed F0, that B.3.5 has and lights get.
vec3 base_share(Surface surface, float n_dot_v) {
#if defined(MOKA_MULTISCATTER) && defined(MOKA_SPECULAR)
    vec3 f0 = surface.dielectric.rgb;
    return vec3(diffuse_share(
        specular_albedo(f0, vec3(surface.dielectric.a), surface.table)
        * multiscatter_scale(f0, surface.table)));
#elif defined(MOKA_MULTISCATTER)
    return vec3(diffuse_share(
        specular_albedo(DIELECTRIC_F0, surface.f90, surface.table)
        * multiscatter_scale(DIELECTRIC_F0, surface.table)));
#elif defined(MOKA_SPECULAR)
    return 1.0
        - mix(surface.covering_f0, surface.f90, mean_fresnel_power(n_dot_v));
#else
    return 1.0
        - mix(surface.f0, surface.f90, mean_fresnel_power(n_dot_v));
#endif
}

// The level of the prefiltered cube for a roughness: quadratic, so that the
// narrow lobes, which differ most, get their share of levels. Below level 1,
// where levels 0 and 1 are mixed, it begins like roughness^4, as the variance
// of a lobe does: one much narrower than that of level 1 is a mirror's.
float specular_level(float roughness) {
    float level = specular_levels * roughness * (2.0 - roughness);
    return level < 1.0 ? smoothstep(0.0, 1.0, level * level) : level;
}

// How much of a sun that was found in the map is a light. Level 0 of the
// specular cube is the mirror image of the whole map; the levels from 1 lack
// its suns. What a texture lookup between the two takes of the first is the
// sun's part in the map, and the rest is this: energy is exact at every
// roughness, and no step is to be seen. On the way the sun's image fades and
// its highlight grows.
float sun_weight(float roughness) {
    return min(specular_level(roughness), 1.0);
}

// MOKA_IBL_REFERENCE has another environment_light.
#include "include/filtered.glsl"
#include "include/reference.glsl"

#if defined(MOKA_ENVIRONMENT) && !defined(MOKA_IBL_REFERENCE)

uniform samplerCube specular_cube;

#ifdef MOKA_IRRADIANCE
#ifndef MOKA_IRRADIANCE_SH
uniform samplerCube irradiance_cube;
#endif

// E / pi of the environment on a surface that faces n, in its own space.
// With MOKA_IRRADIANCE_SH after Ramamoorthi and Hanrahan 2001, equation 13,
// all constants being in moka.lighting.spherical_harmonics' coefficients.
vec3 environment_irradiance(vec3 n) {
#ifdef MOKA_IRRADIANCE_SH
    vec3 sum = irradiance_harmonics[0]
        + irradiance_harmonics[1] * n.x
        + irradiance_harmonics[2] * n.y
        + irradiance_harmonics[3] * n.z
        + irradiance_harmonics[4] * (n.x * n.y)
        + irradiance_harmonics[5] * (n.y * n.z)
        + irradiance_harmonics[6] * (3.0 * n.z * n.z - 1.0)
        + irradiance_harmonics[7] * (n.x * n.z)
        + irradiance_harmonics[8] * (n.x * n.x - n.y * n.y);
    // A lamp in the dark would shine negatively behind.
    return max(sum, 0.0);
#else
    return textureLod(irradiance_cube, n, 0.0).rgb;
#endif
}
#endif

// Where a lobe looks, not normalised: a rough surface sees the environment
// above its normal rather than in the mirror direction r, because shadowing
// and n.l take the far side of the lobe away (Lagarde and de Rousiers 2014,
// "Moving Frostbite to PBR", section 4.9.3). The power is fitted to exact
// integration. Under sky, studio, beach and soft boxes, suns taken out, it
// takes the relative RMSE at roughness 0.2 to 1 from 0.06, 0.22, 0.04, 0.08
// to 0.02, 0.10, 0.02, 0.07; theirs has 0.02, 0.10, 0.02, 0.08, and with the
// lobe's true mean direction it is no better.
vec3 dominant_direction(vec3 n, vec3 r, float roughness) {
    return mix(r, n, roughness * roughness * roughness);
}

// Most environments are not turned, and that is then left out.
vec3 into_environment(vec3 direction) {
#ifdef MOKA_TURNED_ENVIRONMENT
    return turn_into_environment(direction, environment_turn);
#else
    return direction;
#endif
}

// Split sum (Karis 2013): prefiltered radiance times the directional albedo
// of the lobe; the diffuse base gets what the interface lets through.
vec3 environment_light(Surface surface) {
    vec3 specular =
        specular_albedo(surface.f0, surface.f90, surface.table)
        * multiscatter_scale(surface.f0, surface.table);
    vec3 r = reflect(-surface.view, surface.normal);
    vec3 seen = dominant_direction(surface.normal, r, surface.roughness);
    vec3 light = specular * textureLod(
        specular_cube,
        into_environment(seen),
        specular_level(surface.roughness)).rgb;
    float n_dot_v = clamp_n_dot_v(dot(surface.normal, surface.view));
#ifdef MOKA_IBL_FILTERED
    float weight = difference_weight(n_dot_v, surface.roughness);
    if (weight > 0.0) {
        light += specular * weight * lobe_difference(surface, n_dot_v, seen);
        // It is an estimate, and light cannot be less than none.
        light = max(light, 0.0);
    }
#endif
#ifdef MOKA_IRRADIANCE
    vec3 diffuse = base_share(surface, n_dot_v)
        * diffuse_albedo(n_dot_v, surface.diffuse_colour, surface.roughness);
    light += diffuse * environment_irradiance(
        into_environment(surface.normal));
#endif
    return light * (surface.occlusion * environment_intensity);
}

#endif

#ifdef MOKA_PUNCTUAL_LIGHTS

// Twice the solid angle that a pixel sees in a mirror of this shape, as the
// square of a disc's radius: such a disc always has a pixel's centre in it.
// In a small sphere the sun is smaller than a pixel, and
// mostly between the points that are shaded; a disc that is wider by the
// pixel gives them their share of its light. After Tokuyoshi and Kaplanyan
// 2019, "Improved Geometric Specular Antialiasing", of a disc in place of a
// lobe. Only for fragment shaders: it needs derivatives.
const float MOST_SPREAD = 0.04;

float mirrored_spread(Surface surface) {
    vec3 mirrored = reflect(-surface.view, surface.normal);
    vec3 seen = cross(dFdx(mirrored), dFdy(mirrored));
    return min(2.0 * INVERSE_PI * length(seen), MOST_SPREAD);
}

// KHR_lights_punctual: the window that takes a light to nothing at its
// range, times the inverse square. inverse_range is 0 without a range.
float distance_attenuation(float squared_distance, float inverse_range) {
    float ratio = squared_distance * inverse_range * inverse_range;
    float window = clamp(1.0 - ratio * ratio, 0.0, 1.0);
    // A point light on the surface itself would be infinite; the nearest a
    // light can be is a tenth of a millimetre.
    return window / max(squared_distance, 1e-8);
}

// One light. With energy compensation, where ``base`` is base_share, it is
// reflected as the same light in an environment map would be, and never more
// than all of it. Without, it is glTF 2.0's appendix B to the letter, whose
// diffuse term (1 - F(v.h)) lets base and interface together return up to
// 1.9 at grazing angles. ``scale`` is multiscatter_scale.
vec3 reflected_light(
    LightsRow light, Surface surface, vec3 base, vec3 scale
) {
    bool is_sun = light.angular_radius > 0.0;
#ifdef MOKA_IBL_REFERENCE
    // Sampled with the environment that it is part of.
    if (is_sun) return vec3(0.0);
#endif
    vec3 towards = -light.direction;
    float attenuation = 1.0;
#ifdef MOKA_POSITIONAL_LIGHTS
    if (light.positional != 0.0) {
        towards = light.position - surface_position;
        // The square of a distance beyond 1e19 m is infinite.
        float squared = min(dot(towards, towards), 1e38);
        towards = direction_of(towards);
        float cone = dot(-towards, light.direction);
        float spot = clamp(
            cone * light.angle_scale + light.angle_offset, 0.0, 1.0);
        attenuation =
            spot * spot * distance_attenuation(squared, light.inverse_range);
    }
#endif
    Angles angles = angles_between(surface.normal, surface.view, towards);
    if (angles.n_dot_l <= 0.0 || attenuation <= 0.0) return vec3(0.0);
    vec3 fresnel = fresnel_schlick(angles.v_dot_h, surface.f0, surface.f90);
#ifdef MOKA_MULTISCATTER
    vec3 share = base;
#elif defined(MOKA_SPECULAR)
    vec3 share = 1.0 - fresnel_schlick(
        angles.v_dot_h, surface.covering_f0, surface.f90);
#else
    vec3 share = 1.0 - fresnel;
#endif
    float lobe;
    if (is_sun) {
        vec3 offset = towards - reflect(-surface.view, surface.normal);
        lobe = specular_lobe_of_disc(
            angles, dot(offset, offset), surface.roughness,
            sqrt(light.angular_radius * light.angular_radius
                + surface.spread));
        if (light.in_map != 0.0) lobe *= sun_weight(surface.roughness);
        // Occluded like the rest of the environment that it is part of.
        attenuation *= surface.occlusion;
    } else {
        lobe = specular_lobe(
            angles, alpha_from_roughness(surface.roughness),
            schlick_k_direct(surface.roughness));
    }
    vec3 reflected = fresnel * scale * lobe
        + share * diffuse_brdf(
            angles, surface.diffuse_colour, surface.roughness);
    vec3 arriving = min(
        light.intensity * (angles.n_dot_l * attenuation), LIGHT_MAXIMUM);
    return reflected * arriving;
}

// All lights: MOKA_PUNCTUAL_LIGHTS is how many there can be. The one sun that
// most environments have needs no loop, and no reads that depend on one.
vec3 punctual_light(Surface surface) {
#ifdef MOKA_MULTISCATTER
    vec3 base = base_share(
        surface, clamp_n_dot_v(dot(surface.normal, surface.view)));
#else
    vec3 base = vec3(0.0);
#endif
    vec3 scale = multiscatter_scale(surface.f0, surface.table);
#if MOKA_PUNCTUAL_LIGHTS == 1
    return reflected_light(lights[0], surface, base, scale);
#else
    vec3 sum = vec3(0.0);
    for (int i = 0; i < light_count; ++i) {
        sum += reflected_light(lights[i], surface, base, scale);
    }
    return sum;
#endif
}

#endif
