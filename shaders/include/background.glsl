// The environment as it is seen, read from the equirectangular map.

#include "include/constants.glsl"
#include "include/environment.glsl"

layout(std140) uniform Background {
    // Takes (x, y, 0, 1) of clip space to a direction of the environment's
    // own space; any rotation of the environment is part of it.
    mat4 direction_from_clip;
    vec4 parameters;  // x intensity, y level of the map to read
};

// Linear filtering, repeating in u and clamped in v.
uniform sampler2D environment_map;

// ``uv`` is the place in the picture, (0, 0) at the lower left.
vec3 background_radiance(vec2 uv) {
    vec4 clip = vec4(2.0 * uv - 1.0, 0.0, 1.0);
    vec2 place = equirectangular_from_direction(
        (direction_from_clip * clip).xyz);
    // An explicit level: derivatives jump where u wraps around.
    vec3 radiance =
        parameters.x * textureLod(environment_map, place, parameters.y).rgb;
#ifndef MOKA_FLOAT_TARGET
    radiance = min(radiance, HALF_MAXIMUM);
#endif
    return radiance;
}
