// Makes a mip level of a cube map from the level above.
//
// The mean of the four texels it covers, weighted by solid angle: the mean
// over the sphere stays the same from level to level.

#include "include/cube_faces.glsl"

// The level above alone, without filtering.
uniform samplerCube environment_cube;

void main() {
    float quarter = 0.5 / float(textureSize(environment_cube, 0).x);
    vec3 sums[FACE_COUNT];
    for (int i = 0; i < FACE_COUNT; ++i) sums[i] = vec3(0.0);
    float weights = 0.0;
    for (int part = 0; part < 4; ++part) {
        vec2 offset = vec2(part & 1, part >> 1) * 2.0 - 1.0;
        vec2 place = uv + quarter * offset;
        float weight = relative_solid_angle(direction_of_output(0, place));
        for (int i = 0; i < FACE_COUNT; ++i) {
            vec3 direction = direction_of_output(i, place);
            sums[i] += weight
                * textureLod(environment_cube, direction, 0.0).rgb;
        }
        weights += weight;
    }
    for (int i = 0; i < FACE_COUNT; ++i)
        radiance[i] = vec4(sums[i] / weights, 1.0);
}
