// The radiance of a pixel: the mean of its MOKA_SAMPLES samples of the scene,
// in linear light, and with MOKA_SKY the environment behind what they cover.
//
// The sky has no edges, so one sample a pixel is enough for it; coverage
// composites in any order (Porter and Duff 1984). A shader of our own, because
// drivers may compile one for a resolving blit in every process anew.

#include "include/background.glsl"

#ifdef MOKA_SAMPLES
uniform sampler2DMS radiance_map;
#else
uniform sampler2D radiance_map;
#endif

// Premultiplied by coverage. ``uv`` is the place in the picture, (0, 0) at
// the lower left, ``pixel`` the same in pixels.
vec4 scene_radiance(ivec2 pixel, vec2 uv) {
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
    if (mean.a < 1.0) {
        mean += (1.0 - mean.a) * vec4(background_radiance(uv), 1.0);
    }
#endif
    return mean;
}
