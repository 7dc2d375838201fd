// The environment behind the scene, read from the equirectangular map.

#include "include/environment.glsl"

layout(std140) uniform Background {
    // Takes (x, y, 0, 1) of clip space to a direction of the environment's
    // own space; any rotation of the environment is part of it.
    mat4 direction_from_clip;
    vec4 parameters;  // x intensity, y level of the map to read
};

// Linear filtering, repeating in u and clamped in v.
uniform sampler2D environment_map;

in vec2 uv;
out vec4 colour;

void main() {
    vec4 clip = vec4(2.0 * uv - 1.0, 0.0, 1.0);
    vec2 place = equirectangular_from_direction(
        (direction_from_clip * clip).xyz);
    // An explicit level: derivatives jump where u wraps around.
    vec3 radiance = textureLod(environment_map, place, parameters.y).rgb;
    radiance *= parameters.x;
#ifndef MOKA_FLOAT_TARGET
    radiance = min(radiance, HALF_MAXIMUM);
#endif
    colour = vec4(radiance, 1.0);
}
