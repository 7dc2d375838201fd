// Prefilters radiance for the GGX lobe of one roughness: Karis 2013.
//
// The lobe is taken at n = v = r, which makes it isotropic: the stretch of
// highlights at grazing angles is lost. In tangent space its samples are the
// same for every texel, so they come as a list
// (moka.lighting.samples.ggx_prefilter_samples): directions scaled so that z
// is the sample's weight, and the level to read, after Krivanek and Colbert
// 2008, "Real-time Shading with Filtered Importance Sampling".

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
        sum += entry.z * textureLod(environment_cube, direction, entry.w).rgb;
    }
    radiance = vec4(sum, 1.0);
}
