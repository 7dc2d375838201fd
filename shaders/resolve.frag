// Averages the samples of each pixel, in linear radiance, and with MOKA_SKY
// puts the environment behind what they cover.
//
// The sky has no edges, so one sample a pixel is enough for it; coverage
// composites in any order (Porter and Duff 1984). A draw of our own, because
// drivers may compile a shader for a resolving blit in every process anew.

#include "include/background.glsl"

uniform sampler2DMS scene_map;

in vec2 uv;
out vec4 radiance;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < MOKA_SAMPLES; ++i) {
        sum += texelFetch(scene_map, pixel, i);
    }
    sum /= float(MOKA_SAMPLES);
#ifdef MOKA_SKY
    if (sum.a < 1.0) {
        sum += (1.0 - sum.a) * vec4(background_radiance(uv), 1.0);
    }
#endif
    radiance = sum;
}
