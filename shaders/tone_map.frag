// Radiance to display values: exposure, tone map, encoding.
//
// Encodes as sRGB, or with a plain power where MOKA_ENCODE_GAMMA is defined.
// Alpha comes premultiplied and leaves straight, as PNG stores it.

#include "include/srgb.glsl"
#include "include/tone_map.glsl"

layout(std140) uniform ToneMap {
    vec4 parameters;  // x factor of exposure (2^EV), y 1 / gamma
    // Linear display colour that shows where coverage is below 1, if w is 1.
    // It is not exposed or tone mapped: #336699 leaves as #336699.
    vec4 background;
};

uniform sampler2D radiance_map;  // read texel by texel at gl_FragCoord

out vec4 colour;

void main() {
    vec4 texel = texelFetch(radiance_map, ivec2(gl_FragCoord.xy), 0);
    float alpha = clamp(texel.a, 0.0, 1.0);
    vec3 straight = alpha > 0.0 ? texel.rgb / alpha : vec3(0.0);
    vec3 display = tone_map(parameters.x * straight);
    if (background.w > 0.0) {
        display = mix(background.rgb, display, alpha);
        alpha = 1.0;
    }
#ifdef MOKA_ENCODE_GAMMA
    colour = vec4(pow(max(display, 0.0), vec3(parameters.y)), alpha);
#else
    colour = vec4(srgb_encode(display), alpha);
#endif
}
