// The full-screen triangle of passes that need their place alone.

#include "include/fullscreen.glsl"

out vec2 uv;  // 0..1 over the viewport, (0, 0) at the lower left

void main() {
    gl_Position = fullscreen_position();
    uv = 0.5 * gl_Position.xy + 0.5;
}
