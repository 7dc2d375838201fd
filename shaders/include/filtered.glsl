// Filtered lighting: what split-sum loses of the specular lobe's shape.
//
// Split-sum takes the lobe of n = v = r, which is round, and puts it around
// another direction; at grazing angles the true one is long. A few samples of both,
// drawn from the same points, tell the difference: split-sum is the control
// variate (Owen 2013, "Monte Carlo theory, methods and examples", section
// 8.9) of an estimate that would be noisy or blurred by itself. Each sample
// reads the level of the map whose texels are as large as its share of the
// lobe (Krivanek and Colbert 2008), mixed from two: the nearest one would
// cost a third less and jump by up to 6 % along a sphere. The points are the
// same for all pixels, so that pictures have no noise.

#include "include/environment.glsl"
#include "include/sampling.glsl"
#include "include/visible_reflection.glsl"

#if defined(MOKA_ENVIRONMENT) && defined(MOKA_IBL_FILTERED)

// The environment without its suns, box-filtered levels.
uniform samplerCube radiance_cube;

// The level whose texels have the solid angle 1 / (count density).
float level_of_share(float density, float count) {
    float size = float(textureSize(radiance_cube, 0).x);
    float texels = 6.0 * size * size / (4.0 * PI * count * density);
    return max(0.5 * log2(texels), 0.0);
}

// How much of the difference is added: nothing, and no sample is taken, up to
// a roughness of 0.05, where a lobe is as narrow as a texel, and from n.v =
// 0.85 on, where it is nearly round. Measured with 16 samples under beach,
// studio, sky and soft boxes, errors at n.v = 0.9 are 0.02, 0.14, 0.02, 0.04
// with and without; at 0.5 they go from 0.08, 0.09, 0.05, 0.05 to 0.03, 0.10,
// 0.02, 0.05, and at 0.1 from 0.31, 0.20, 0.10, 0.18 to 0.06, 0.08, 0.03,
// 0.10.
float difference_weight(float n_dot_v, float roughness) {
    return smoothstep(0.05, 0.15, roughness)
        * (1.0 - smoothstep(0.7, 0.85, n_dot_v));
}

// The mean radiance over the true lobe minus that over the round one around
// ``axis``. Both are normalised by their weights, so uniform light has no
// difference.
vec3 lobe_difference(Surface surface, float n_dot_v, vec3 axis) {
    float alpha = surface.roughness * surface.roughness;
    float k = schlick_k_environment(surface.roughness);
    // The frame of n, with v in the x-z plane, and in it that of the axis.
    float sine = sqrt(max(1.0 - n_dot_v * n_dot_v, 0.0));
    vec3 v = vec3(sine, 0.0, n_dot_v);
    vec3 x =
        surface.view - dot(surface.view, surface.normal) * surface.normal;
    // Zero only for a view from straight behind.
    x *= inversesqrt(max(dot(x, x), 1e-20));
    mat3 basis = mat3(
        turn_into_environment(x, environment_turn),
        turn_into_environment(cross(surface.normal, x), environment_turn),
        turn_into_environment(surface.normal, environment_turn));
    vec2 tilt = vec2(dot(axis, x), dot(axis, surface.normal));
    tilt *= inversesqrt(max(dot(tilt, tilt), 1e-20));
    mat3 round_basis = basis * mat3(
        tilt.y, 0.0, -tilt.x, 0.0, 1.0, 0.0, tilt.x, 0.0, tilt.y);
    int count = sample_range.y;
    vec3 sum = vec3(0.0);
    vec3 weights = vec3(0.0);
    vec3 round_sum = vec3(0.0);
    float round_weights = 0.0;
    const vec3 up = vec3(0.0, 0.0, 1.0);
    for (int i = 0; i < count; ++i) {
        vec2 point = hammersley(uint(i), uint(count));
        vec3 h = sample_reflecting_normal(point, v, alpha);
        float v_dot_h = dot(v, h);
        vec3 l = 2.0 * v_dot_h * h - v;
        if (l.z > 0.0) {
            Angles angles =
                Angles(n_dot_v, l.z, h.z, v_dot_h, dot(h.xy, h.xy));
            float d = distribution_ggx(h.z, angles.n_cross_h_squared, alpha);
            float density = visible_reflection_density(d, v, alpha);
            vec3 weight =
                fresnel_schlick(v_dot_h, surface.f0, surface.f90)
                * (specular_lobe(angles, alpha, k) * l.z / density);
            sum += weight * textureLod(
                radiance_cube, basis * l,
                level_of_share(density, float(count))).rgb;
            weights += weight;
        }
        h = sample_reflecting_normal(point, up, alpha);
        l = 2.0 * h.z * h - up;
        if (l.z > 0.0) {
            float d = distribution_ggx(h.z, dot(h.xy, h.xy), alpha);
            float density = visible_reflection_density(d, up, alpha);
            round_sum += l.z * textureLod(
                radiance_cube, round_basis * l,
                level_of_share(density, float(count))).rgb;
            round_weights += l.z;
        }
    }
    // A black surface at f0 = 0 reflects nothing but has f90 = 1.
    return sum / max(weights, 1e-20) - round_sum / max(round_weights, 1e-20);
}

#endif
