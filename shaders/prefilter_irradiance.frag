// Irradiance from a cube map, as E / pi: the mean radiance, weighted n.l.
//
// A Lambert surface reflects its colour times this value. Samples come from
// moka.lighting.samples.cosine_samples, distributed like n.l and therefore
// of equal weight, each with the level to read (Krivanek and Colbert 2008),
// so that a small sun makes no spots.

#include "include/cube_face.glsl"
#include "include/sampling.glsl"

layout(std140) uniform PrefilterSamples {
    int sample_count;
    vec4 samples[MOKA_SAMPLE_COUNT];
};

uniform samplerCube environment_cube;

in vec2 uv;
out vec4 radiance;

void main() {
    vec3 n = normalize(direction_from_cube_face(face, uv));
    mat3 basis = tangent_basis(n);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < sample_count; ++i) {
        vec4 entry = samples[i];
        vec3 direction = basis * entry.xyz;
        sum += textureLod(environment_cube, direction, entry.w).rgb;
    }
    radiance = vec4(sum / float(sample_count), 1.0);
}
