// The full-screen triangle of passes with a sky, MOKA_SKY, or for a display,
// MOKA_DISPLAY.
//
// Hands on what all pixels share. On llvmpipe a pixel pays 0.3 ns for each
// number that it reads from a block, and nothing for one that is flat.

#include "include/background_block.glsl"
#include "include/fullscreen.glsl"

#ifdef MOKA_SKY
// Linear over the picture, where w is 1 in every corner.
noperspective out vec3 sky_direction;
flat out vec4 sky;
#ifdef MOKA_FLAT_SUNS
flat out vec4 flat_sun_discs[MOKA_SUN_DISCS];
flat out vec4 flat_sun_radiances[MOKA_SUN_DISCS];
#endif
#endif

#ifdef MOKA_DISPLAY
layout(std140) uniform ToneMap {
    vec4 display_parameters;
    vec4 background_colour;
};
flat out vec4 display;
flat out vec3 background;
#endif

void main() {
    gl_Position = fullscreen_position();
#ifdef MOKA_SKY
    vec4 clip = vec4(gl_Position.xy, 0.0, 1.0);
    sky_direction = (direction_from_clip * clip).xyz;
    sky = parameters;
    sky.z *= length(direction_from_clip[1].xyz);
#ifdef MOKA_FLAT_SUNS
    flat_sun_discs = sun_discs;
    flat_sun_radiances = sun_radiances;
#endif
#endif
#ifdef MOKA_DISPLAY
    display = display_parameters;
    background = background_colour.rgb;
#endif
}
