// One radiance a pixel, for those who want numbers and not a display.

#include "include/scene_radiance.glsl"

out vec4 radiance;

void main() {
    radiance = scene_radiance();
}
