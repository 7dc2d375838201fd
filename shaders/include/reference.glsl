// Reference lighting: the environment integrated against the whole BRDF.
//
// Each sample draws one direction like the specular lobe, one like n.l for
// the base, and one like the light of the map; the balance heuristic (Veach
// and Guibas 1995, "Optimally Combining Sampling Techniques for Monte Carlo
// Rendering", equation 9) weighs what they bring. Nothing is prefiltered or
// taken out of the map: a sun in it is found by the third. The discs of suns
// that are not in the map are integrals of their own, of directions from the
// lobe and from the disc.

#include "include/importance.glsl"
#include "include/sampling.glsl"
#include "include/sequence.glsl"
#include "include/sun_disc.glsl"
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
    vec3 base;  // the part of light that reaches the diffuse base
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
    s.base = base_share(surface, s.view.z);
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

// What is reflected of a radiance of 1 from ``l``, in the surface's frame and
// per steradian, and the density with which samples of the lobe go there.
vec3 reflect_light(
    Surface surface, Scatterer s, vec3 l, out float of_lobe
) {
    of_lobe = 0.0;
    if (l.z <= 0.0) return vec3(0.0);
    vec3 h = normalize(s.view + l);
    float sine_squared = dot(h.xy, h.xy);
    Angles angles = Angles(
        s.view.z, l.z, h.z, clamp(dot(s.view, h), 0.0, 1.0), sine_squared);
    vec3 fresnel = fresnel_schlick(angles.v_dot_h, surface.f0, surface.f90);
    vec3 reflected = vec3(0.0);
    if (!s.is_mirror) {
        float d = distribution_ggx(h.z, sine_squared, s.alpha);
        of_lobe = visible_reflection_density(d, s.view, s.alpha);
        reflected =
            fresnel * s.scale * specular_lobe(angles, s.alpha, s.k);
    }
    if (s.has_base) {
#ifdef MOKA_MULTISCATTER
        vec3 share = s.base;
#elif defined(MOKA_SPECULAR)
        vec3 share = 1.0 - fresnel_schlick(
            angles.v_dot_h, surface.covering_f0, surface.f90);
#else
        vec3 share = 1.0 - fresnel;
#endif
        reflected += share
            * diffuse_brdf(angles, surface.diffuse_colour, surface.roughness);
    }
    return reflected * l.z;
}

// What light of the map from ``l`` adds, whichever technique drew it:
// reflected radiance over the sum of the densities. ``direction`` is ``l`` in
// the environment's frame, where the map has density ``of_light``.
vec3 sample_light(
    Surface surface, Scatterer s, vec3 l, vec3 direction, float of_light
) {
    if (l.z <= 0.0) return vec3(0.0);
    float of_lobe;
    vec3 reflected = reflect_light(surface, s, l, of_lobe);
    float density = of_light + of_lobe;
    if (s.has_base) density += l.z * INVERSE_PI;
    return reflected * radiance_from(direction) / density;
}

vec3 sample_light(Surface surface, Scatterer s, vec3 l) {
    vec3 direction = s.environment_axes * l;
    return sample_light(
        surface, s, l, direction, environment_density(direction));
}

#ifdef MOKA_PUNCTUAL_LIGHTS
// The radiance of a sun's disc; its irradiance, over pi sin^2.
vec3 sun_radiance(LightsRow sun) {
    float sine = sin(sun.angular_radius);
    return min(
        sun.intensity * (INVERSE_PI / (sine * sine)), LIGHT_MAXIMUM);
}

// What the suns add that a sample of the lobe, ``l``, and one of their discs,
// for a point of the unit square, find. Mirrors have none of the first.
vec3 sample_suns(Surface surface, Scatterer s, vec3 l, vec2 point) {
    vec3 light = vec3(0.0);
    float ignored;
    vec3 reflected = s.is_mirror
        ? vec3(0.0) : reflect_light(surface, s, l, ignored);
    float of_l = ignored;
    for (int i = 0; i < light_count; ++i) {
        LightsRow sun = lights[i];
        if (sun.angular_radius <= 0.0) continue;
        vec3 centre = turn_into_environment(-sun.direction, environment_turn)
            * s.environment_axes;
        float density = disc_density(sun.angular_radius);
        vec3 found = vec3(0.0);
        if (!s.is_mirror && is_in_disc(l, centre, sun.angular_radius))
            found += reflected / (of_l + density);
        float of_lobe;
        vec3 drawn = reflect_light(
            surface, s, sample_disc(point, centre, sun.angular_radius),
            of_lobe);
        found += drawn / (of_lobe + density);
        light += found * sun_radiance(sun);
    }
    return light;
}

// The suns whose disc ``direction`` of the environment's space meets.
vec3 suns_in(vec3 direction) {
    vec3 light = vec3(0.0);
    for (int i = 0; i < light_count; ++i) {
        LightsRow sun = lights[i];
        if (sun.angular_radius <= 0.0) continue;
        vec3 centre =
            turn_into_environment(-sun.direction, environment_turn);
        if (is_in_disc(direction, centre, sun.angular_radius))
            light += sun_radiance(sun);
    }
    return light;
}
#endif

// The mean of the frame's share of samples.
vec3 environment_light(Surface surface) {
    Scatterer s = make_scatterer(surface);
    vec3 light = vec3(0.0);
    vec3 of_suns = vec3(0.0);  // already as bright as the scene has them
    if (!s.is_mirror || s.has_base) {
        uvec4 pixel = uvec4(gl_FragCoord.xy, uint(sample_range.z), 0u);
        uvec4 start = hash(pixel);
        uvec4 start_of_light = hash(pixel + uvec4(0u, 0u, 0u, 1u));
        for (int i = 0; i < sample_range.y; ++i) {
            uint index = uint(sample_range.x + i);
            vec3 l = vec3(0.0, 0.0, 1.0);
            if (!s.is_mirror) {
                l = sample_visible_reflection(
                    sequence(index, start.xy), s.view, s.alpha);
                light += sample_light(surface, s, l);
            }
            if (s.has_base) {
                light += sample_light(surface, s, sample_cosine_hemisphere(
                    sequence(index, start.zw)));
            }
            vec4 direction =
                sample_environment(sequence(index, start_of_light.xy));
            light += sample_light(
                surface, s, direction.xyz * s.environment_axes,
                direction.xyz, direction.w);
#ifdef MOKA_PUNCTUAL_LIGHTS
            of_suns += sample_suns(
                surface, s, l, sequence(index, start_of_light.zw));
#endif
        }
        light /= float(sample_range.y);
        of_suns /= float(sample_range.y);
    }
    if (s.is_mirror) {
        vec3 r = turn_into_environment(
            reflect(-surface.view, surface.normal), environment_turn);
        vec3 fresnel =
            s.scale * fresnel_schlick(s.view.z, surface.f0, surface.f90);
        light += fresnel * radiance_from(r);
#ifdef MOKA_PUNCTUAL_LIGHTS
        of_suns += fresnel * suns_in(r);
#endif
    }
    return surface.occlusion * (light * environment_intensity + of_suns);
}

#endif
