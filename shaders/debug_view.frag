// Values of surfaces as colours: MOKA_VIEW_* says which and how.

#include "include/srgb.glsl"

uniform sampler2D values;   // the target that holds what is shown
uniform sampler2D objects;  // the target whose w is the object's number

layout(std140) uniform DebugView {
    vec4 view;  // x a distance in metres that is shown in middle grey
};

out vec4 colour;

const vec3 NOTHING = vec3(0.08);

// A colour for each object, of as good as any hue (Jarzynski and Olano 2020,
// "Hash Functions for GPU Rendering": pcg).
vec3 colour_of_object(uint number) {
    uint state = number * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    word = (word >> 22u) ^ word;
    float hue = float(word & 0xFFFFu) / 65536.0;
    vec3 pure = abs(fract(hue + vec3(0.0, 2.0, 1.0) / 3.0) * 6.0 - 3.0) - 1.0;
    return mix(vec3(0.25), vec3(0.95), clamp(pure, 0.0, 1.0));
}

// Blue for 0, then a step of the rainbow for each.
vec3 colour_of_level(float level) {
    float part = clamp(level / 8.0, 0.0, 1.0);
    return clamp(
        vec3(2.0 * part - 0.5, 1.0 - abs(2.0 * part - 1.0), 1.0 - 2.0 * part),
        0.0, 1.0) * 0.9 + 0.1;
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 value = texelFetch(values, pixel, 0);
    float number = texelFetch(objects, pixel, 0).w;
    vec3 shown = NOTHING;
    if (number > 0.0) {
#if defined(MOKA_VIEW_BASE_COLOUR)
        shown = srgb_encode(clamp(value.rgb, 0.0, 1.0));
#elif defined(MOKA_VIEW_EMISSION)
        shown = srgb_encode(value.rgb / (1.0 + value.rgb));
#elif defined(MOKA_VIEW_DIRECTION)
        shown = 0.5 * value.rgb + 0.5;
#elif defined(MOKA_VIEW_UV)
        vec2 cell = floor(8.0 * value.xy);
        float light = mod(cell.x + cell.y, 2.0) < 1.0 ? 1.0 : 0.8;
        shown = light * vec3(fract(value.xy), 0.2);
#elif defined(MOKA_VIEW_OBJECT)
        shown = colour_of_object(uint(number));
#elif defined(MOKA_VIEW_DEPTH)
        shown = vec3(view.x / (view.x + value.w));
#elif defined(MOKA_VIEW_LEVEL)
        shown = colour_of_level(value.w);
#elif defined(MOKA_VIEW_COUNT)
        shown = colour_of_level(value.x - 1.0);
#elif defined(MOKA_VIEW_W)
        shown = vec3(value.w);
#elif defined(MOKA_VIEW_Z)
        shown = vec3(value.z);
#endif
    }
    colour = vec4(shown, 1.0);
}
