// Makes a mip level of a cube map from the level above.
//
// The mean of the four texels it covers, weighted by solid angle: the mean
// over the sphere stays the same from level to level.

#include "include/cube_face.glsl"

uniform samplerCube environment_cube;

in vec2 uv;
out vec4 radiance;

void main() {
    float quarter = 0.25 / float(size);
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int i = 0; i < 4; ++i) {
        vec2 offset = vec2(i & 1, i >> 1) * 2.0 - 1.0;
        vec3 direction =
            direction_from_cube_face(face, uv + quarter * offset);
        float weight = relative_solid_angle(direction);
        sum += weight
            * textureLod(environment_cube, direction, source_lod).rgb;
        weights += weight;
    }
    radiance = vec4(sum / weights, 1.0);
}
