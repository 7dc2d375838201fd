// Resamples an equirectangular map into a face of a cube map.
//
// Each texel is the mean of subdivisions^2 bilinear samples, weighted by
// solid angle, so that a small sun keeps its flux.

#include "include/cube_face.glsl"

// Level 0 with linear filtering, repeating in u and clamped in v.
uniform sampler2D environment_map;

in vec2 uv;
out vec4 radiance;

void main() {
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    float cell = 1.0 / float(size * subdivisions);
    vec2 corner = uv - 0.5 / float(size) + 0.5 * cell;
    for (int y = 0; y < subdivisions; ++y) {
        for (int x = 0; x < subdivisions; ++x) {
            vec3 direction =
                direction_from_cube_face(face, corner + vec2(x, y) * cell);
            float weight = relative_solid_angle(direction);
            vec2 place = equirectangular_from_direction(direction);
            sum += weight
                * textureLod(environment_map, place, source_lod).rgb;
            weights += weight;
        }
    }
    radiance = vec4(sum / weights, 1.0);
}
