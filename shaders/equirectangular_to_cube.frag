// Resamples an equirectangular map into the faces of a cube map.
//
// Each texel is the mean of MOKA_SUBDIVISIONS^2 bilinear samples, weighted by
// solid angle, so that a small sun keeps its flux.

#include "include/cube_faces.glsl"

// One level with linear filtering, repeating in u and clamped in v.
uniform sampler2D environment_map;

void main() {
    const float cell = 1.0 / float(MOKA_SIZE * MOKA_SUBDIVISIONS);
    vec3 sums[FACE_COUNT];
    for (int i = 0; i < FACE_COUNT; ++i) sums[i] = vec3(0.0);
    float weights = 0.0;
    for (int y = 0; y < MOKA_SUBDIVISIONS; ++y) {
        for (int x = 0; x < MOKA_SUBDIVISIONS; ++x) {
            vec2 place = uv - 0.5 / float(MOKA_SIZE) + 0.5 * cell
                + vec2(x, y) * cell;
            float weight = relative_solid_angle(direction_of_output(0, place));
            for (int i = 0; i < FACE_COUNT; ++i) {
                vec2 texel = equirectangular_from_direction(
                    direction_of_output(i, place));
                sums[i] += weight * textureLod(environment_map, texel, 0.0).rgb;
            }
            weights += weight;
        }
    }
    for (int i = 0; i < FACE_COUNT; ++i)
        radiance[i] = vec4(sums[i] / weights, 1.0);
}
