// The scene to display values: samples averaged, the sky behind them,
// exposure, tone map, encoding. One pass, since each more would write and read
// the whole picture once. Its triangle is that of screen.vert.
//
// Encodes as sRGB, or with a plain power where MOKA_ENCODE_GAMMA is defined.
// Alpha comes premultiplied and leaves straight, as PNG stores it.

#include "include/scene_radiance.glsl"
#include "include/srgb.glsl"
#include "include/tone_map.glsl"

flat in vec4 display;  // x factor of exposure (2^EV), y 1 / gamma
#ifdef MOKA_BACKGROUND_COLOUR
// Linear display colour that shows where coverage is below 1. It is not
// exposed or tone mapped: #336699 leaves as #336699.
flat in vec3 background;
#endif

out vec4 colour;

void main() {
    vec4 texel = scene_radiance();
#ifdef MOKA_SKY
    // Nothing shows through a sky.
    float alpha = 1.0;
    vec3 shown = tone_map(display.x * texel.rgb);
#else
    float alpha = clamp(texel.a, 0.0, 1.0);
    vec3 straight = alpha > 0.0 ? texel.rgb / alpha : vec3(0.0);
    vec3 shown = tone_map(display.x * straight);
#ifdef MOKA_BACKGROUND_COLOUR
    shown = mix(background, shown, alpha);
    alpha = 1.0;
#endif
#endif
#ifdef MOKA_ENCODE_GAMMA
    colour = vec4(pow(max(shown, 0.0), vec3(display.y)), alpha);
#else
    colour = vec4(srgb_encode(shown), alpha);
#endif
}
