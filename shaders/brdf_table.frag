// The directional albedo of the specular lobe, split for any Fresnel term.
//
// x is n.v, y is roughness, both at texel centres. Red is the scale of f0
// and green that of f90 (Karis 2013, equation 8): the lobe reflects
// f0 * red + f90 * green of uniform light.

#include "include/brdf.glsl"
#include "include/sampling.glsl"

in vec2 uv;
out vec4 table;

void main() {
    float n_dot_v = uv.x;
    float roughness = uv.y;
    float alpha = roughness * roughness;
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
    sum /= float(MOKA_SAMPLE_COUNT);
    table = vec4(sum.x - sum.y, sum.y, 0.0, 1.0);
}
