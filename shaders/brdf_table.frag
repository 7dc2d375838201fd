// The directional albedo of the specular lobe, split for any Fresnel term.
//
// x is n.v, y is roughness, see include/brdf_table.glsl. Red is the scale of
// f0 and green that of f90 (Karis 2013, equation 8): the lobe reflects
// f0 * red + f90 * green of uniform light.

#include "include/brdf.glsl"
#include "include/brdf_table.glsl"
#include "include/sampling.glsl"

// A mirror's lobe has no width and 0/0 for a density. This one is narrow
// against n.v wherever that is at least its own least value.
const float NARROWEST_ALPHA = 1e-6;

out vec4 table;

void main() {
    vec2 entry = table_entry(gl_FragCoord.xy, float(MOKA_TABLE_SIZE));
    float n_dot_v = clamp_n_dot_v(entry.x);
    float roughness = entry.y;
    float alpha = max(roughness * roughness, NARROWEST_ALPHA);
    vec3 v = vec3(sqrt(1.0 - n_dot_v * n_dot_v), 0.0, n_dot_v);
    // D / pdf for visible normals, apart from D itself, is G1's denominator.
    float squared = alpha * alpha;
    float view = 2.0
        * (n_dot_v + sqrt(n_dot_v * n_dot_v * (1.0 - squared) + squared));
    vec2 sum = vec2(0.0);
    for (uint i = 0u; i < uint(MOKA_SAMPLE_COUNT); ++i) {
        vec2 point = hammersley(i, uint(MOKA_SAMPLE_COUNT));
        // The integrand is even in the azimuth: half of it is enough.
        point.x *= 0.5;
        vec3 h = sample_ggx_visible(point, v, alpha);
        float v_dot_h = dot(v, h);
        float n_dot_l = 2.0 * v_dot_h * h.z - n_dot_v;
        if (n_dot_l <= 0.0) continue;
        Angles angles =
            Angles(n_dot_v, n_dot_l, h.z, v_dot_h, dot(h.xy, h.xy));
        float d = distribution_ggx(h.z, angles.n_cross_h_squared, alpha);
        float lobe =
            specular_lobe(angles, alpha, schlick_k_environment(roughness));
        float weight = lobe / d * n_dot_l * view;
        sum += weight * vec2(1.0, fresnel_schlick(v_dot_h, 0.0, 1.0));
    }
    // Rounding may not make light: no lobe reflects more than it gets.
    sum /= max(float(MOKA_SAMPLE_COUNT), sum.x);
    table = vec4(sum.x - sum.y, sum.y, 0.0, 1.0);
}
