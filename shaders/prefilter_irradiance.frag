// Irradiance from a cube map, as E / pi: the mean radiance, weighted n.l.
//
// A Lambert surface reflects its colour times this value. Samples come from
// moka.lighting.samples.cosine_samples, distributed like n.l and therefore
// of equal weight, each with the level to read (Krivanek and Colbert 2008),
// so that a small sun makes no spots.

#include "include/cube_faces.glsl"
#include "include/sampling.glsl"

layout(std140) uniform PrefilterSamples {
    int sample_count;
    vec4 samples[MOKA_SAMPLE_COUNT];
};

uniform samplerCube environment_cube;

void main() {
    mat3 bases[FACE_COUNT];
    vec3 sums[FACE_COUNT];
    for (int i = 0; i < FACE_COUNT; ++i) {
        bases[i] = tangent_basis(normalize(direction_of_output(i, uv)));
        sums[i] = vec3(0.0);
    }
    int count = sample_count;
    for (int number = 0; number < count; ++number) {
        vec4 entry = samples[number];
        for (int i = 0; i < FACE_COUNT; ++i) {
            vec3 direction = bases[i] * entry.xyz;
            sums[i] += textureLod(environment_cube, direction, entry.w).rgb;
        }
    }
    for (int i = 0; i < FACE_COUNT; ++i)
        radiance[i] = vec4(sums[i] / float(count), 1.0);
}
