// Reference lighting: the environment integrated against the whole BRDF.
//
// Each sample draws one direction like the specular lobe, one like n.l for
// the base, and one like the light of the map; the balance heuristic (Veach
// and Guibas 1995, "Optimally Combining Sampling Techniques for Monte Carlo
// Rendering", equation 9) weighs what they bring. Nothing is prefiltered or
// taken out of the map: a sun is found by the third.

#include "include/importance.glsl"
#include "include/sampling.glsl"
#include "include/sequence.glsl"
#include "include/visible_reflection.glsl"

#if defined(MOKA_ENVIRONMENT) && defined(MOKA_IBL_REFERENCE)

// Linear filtering, repeating in u and clamped in v.
uniform sampler2D environment_map;

// A narrower lobe is a mirror's: it is a hundredth of a texel of an 8k map
// wide, and float32 could no longer tell its half vectors apart.
const float MIRROR_ALPHA = 1e-4;

// A surface in its own frame, with n = (0, 0, 1).
struct Scatterer {
    mat3 environment_axes;  // takes a direction to the environment's space
    vec3 view;
    vec3 scale;  // of the lobe, for light that is reflected more than once
    float base;  // the part of light that reaches the diffuse base
    float alpha;
    float k;     // of Schlick-GGX
    bool is_mirror;
    bool has_base;
};

vec3 radiance_from(vec3 direction) {
    return textureLod(
        environment_map, equirectangular_from_direction(direction), 0.0).rgb;
}

Scatterer make_scatterer(Surface surface) {
    mat3 basis = tangent_basis(surface.normal);
    Scatterer s;
    s.environment_axes = mat3(
        turn_into_environment(basis[0], environment_turn),
        turn_into_environment(basis[1], environment_turn),
        turn_into_environment(basis[2], environment_turn));
    s.view = surface.view * basis;
    // A view from below is one at a grazing angle, as for every light.
    float squared = dot(s.view.xy, s.view.xy);
    s.view.z = clamp_n_dot_v(s.view.z);
    s.view.xy = squared > 0.0
        ? s.view.xy * sqrt((1.0 - s.view.z * s.view.z) / squared)
        : vec2(sqrt(1.0 - s.view.z * s.view.z), 0.0);
    s.scale = multiscatter_scale(surface.f0, surface.table);
    s.base = base_share(surface);
    s.alpha = surface.roughness * surface.roughness;
    s.k = schlick_k_environment(surface.roughness);
    s.is_mirror = s.alpha < MIRROR_ALPHA;
#ifdef MOKA_IRRADIANCE
    vec3 colour = surface.diffuse_colour;
    s.has_base = max(max(colour.r, colour.g), colour.b) > 0.0;
#else
    s.has_base = false;
#endif
    return s;
}

// What light from ``l`` adds, whichever technique drew it: reflected
// radiance over the sum of the densities. ``l`` is in the surface's frame,
// ``direction`` in the environment's, where the map has density
// ``of_light``.
vec3 sample_light(
    Surface surface, Scatterer s, vec3 l, vec3 direction, float of_light
) {
    if (l.z <= 0.0) return vec3(0.0);
    vec3 h = normalize(s.view + l);
    float sine_squared = dot(h.xy, h.xy);
    Angles angles = Angles(
        s.view.z, l.z, h.z, clamp(dot(s.view, h), 0.0, 1.0), sine_squared);
    vec3 fresnel = fresnel_schlick(angles.v_dot_h, surface.f0, surface.f90);
    vec3 reflected = vec3(0.0);
    float density = of_light;
    if (!s.is_mirror) {
        float d = distribution_ggx(h.z, sine_squared, s.alpha);
        density += visible_reflection_density(d, s.view, s.alpha);
        reflected =
            fresnel * s.scale * specular_lobe(angles, s.alpha, s.k);
    }
    if (s.has_base) {
        density += l.z * INVERSE_PI;
#ifdef MOKA_MULTISCATTER
        vec3 share = vec3(s.base);
#else
        vec3 share = 1.0 - fresnel;
#endif
        reflected += share
            * diffuse_brdf(angles, surface.diffuse_colour, surface.roughness);
    }
    return reflected * radiance_from(direction) * (l.z / density);
}

vec3 sample_light(Surface surface, Scatterer s, vec3 l) {
    vec3 direction = s.environment_axes * l;
    return sample_light(
        surface, s, l, direction, environment_density(direction));
}

// The mean of the frame's share of samples.
vec3 environment_light(Surface surface) {
    Scatterer s = make_scatterer(surface);
    vec3 light = vec3(0.0);
    if (!s.is_mirror || s.has_base) {
        uvec4 pixel = uvec4(gl_FragCoord.xy, uint(sample_range.z), 0u);
        uvec4 start = hash(pixel);
        uvec2 start_of_light = hash(pixel + uvec4(0u, 0u, 0u, 1u)).xy;
        for (int i = 0; i < sample_range.y; ++i) {
            uint index = uint(sample_range.x + i);
            if (!s.is_mirror) {
                light += sample_light(surface, s, sample_visible_reflection(
                    sequence(index, start.xy), s.view, s.alpha));
            }
            if (s.has_base) {
                light += sample_light(surface, s, sample_cosine_hemisphere(
                    sequence(index, start.zw)));
            }
            vec4 direction =
                sample_environment(sequence(index, start_of_light));
            light += sample_light(
                surface, s, direction.xyz * s.environment_axes,
                direction.xyz, direction.w);
        }
        light /= float(sample_range.y);
    }
    if (s.is_mirror) {
        vec3 r = reflect(-surface.view, surface.normal);
        light += s.scale
            * fresnel_schlick(s.view.z, surface.f0, surface.f90)
            * radiance_from(turn_into_environment(r, environment_turn));
    }
    return light * (surface.occlusion * environment_intensity);
}

#endif
