// The radiance of a pixel: the mean of its MOKA_SAMPLES samples of the scene,
// in linear light, and with MOKA_SKY the environment behind what they cover.
// With MOKA_SKY_ALONE none covers anything.
//
// The sky has no edges, so one sample a pixel is enough for it; coverage
// composites in any order (Porter and Duff 1984). A shader of our own, because
// drivers may compile one for a resolving blit in every process anew.

#include "include/background.glsl"

#ifdef MOKA_SKY_ALONE

vec4 scene_radiance() {
    return vec4(background_radiance(), 1.0);
}

#else

#ifdef MOKA_SAMPLES
uniform sampler2DMS radiance_map;
#else
uniform sampler2D radiance_map;
#endif

// Premultiplied by coverage, which is 1 with a sky.
vec4 scene_radiance() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
#ifdef MOKA_SAMPLES
    vec4 mean = vec4(0.0);
    for (int i = 0; i < MOKA_SAMPLES; ++i) {
        mean += texelFetch(radiance_map, pixel, i);
    }
    mean /= float(MOKA_SAMPLES);
#else
    vec4 mean = texelFetch(radiance_map, pixel, 0);
#endif
#ifdef MOKA_SKY
    mean.rgb += max(1.0 - mean.a, 0.0) * background_radiance();
    mean.a = 1.0;
#endif
    return mean;
}

#endif
