// Prefilters radiance for the GGX lobe of one roughness: Karis 2013.
//
// The lobe is taken at n = v = r, which makes it isotropic: the stretch of
// highlights at grazing angles is lost. In tangent space its samples are the
// same for every texel, so they come as a list
// (moka.lighting.samples.ggx_prefilter_samples): directions scaled so that z
// is the sample's weight, and the level to read, after Krivanek and Colbert
// 2008, "Real-time Shading with Filtered Importance Sampling".

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
            sums[i] += entry.z
                * textureLod(environment_cube, direction, entry.w).rgb;
        }
    }
    for (int i = 0; i < FACE_COUNT; ++i)
        radiance[i] = vec4(sums[i], 1.0);
}
