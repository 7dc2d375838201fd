// The scene to display values: samples averaged, the sky behind them,
// exposure, tone map, encoding. One pass, since each more would write and read
// the whole picture once.
//
// Encodes as sRGB, or with a plain power where MOKA_ENCODE_GAMMA is defined.
// Alpha comes premultiplied and leaves straight, as PNG stores it.

#include "include/scene_radiance.glsl"
#include "include/srgb.glsl"
#include "include/tone_map.glsl"

layout(std140) uniform ToneMap {
    vec4 display;  // x factor of exposure (2^EV), y 1 / gamma
    // Linear display colour that shows where coverage is below 1, if w is 1.
    // It is not exposed or tone mapped: #336699 leaves as #336699.
    vec4 background;
};

in vec2 uv;
out vec4 colour;

void main() {
    vec4 texel = scene_radiance(ivec2(gl_FragCoord.xy), uv);
    float alpha = clamp(texel.a, 0.0, 1.0);
    vec3 straight = alpha > 0.0 ? texel.rgb / alpha : vec3(0.0);
    vec3 shown = tone_map(display.x * straight);
    if (background.w > 0.0) {
        shown = mix(background.rgb, shown, alpha);
        alpha = 1.0;
    }
#ifdef MOKA_ENCODE_GAMMA
    colour = vec4(pow(max(shown, 0.0), vec3(display.y)), alpha);
#else
    colour = vec4(srgb_encode(shown), alpha);
#endif
}
