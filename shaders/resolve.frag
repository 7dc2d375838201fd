// One radiance a pixel, for those who want numbers and not a display.

#include "include/scene_radiance.glsl"

in vec2 uv;
out vec4 radiance;

void main() {
    radiance = scene_radiance(ivec2(gl_FragCoord.xy), uv);
}
