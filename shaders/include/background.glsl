// The environment as it is seen, read from the equirectangular map.

#include "include/constants.glsl"
#include "include/environment.glsl"

layout(std140) uniform Background {
    // Takes (x, y, 0, 1) of clip space to a direction of the environment's
    // own space; any rotation of the environment is part of it.
    mat4 direction_from_clip;
    // x intensity, y level of the map to read, z size of a pixel in clip
    // space, w the angle over which suns are blurred
    vec4 parameters;
#ifdef MOKA_SUN_DISCS
    vec4 sun_discs[MOKA_SUN_DISCS];      // direction, angular radius
    vec4 sun_radiances[MOKA_SUN_DISCS];
#endif
};

#ifdef MOKA_BLURRED_SKY
// As rough surfaces reflect it, rougher from level to level.
uniform samplerCube specular_cube;
#else
// Linear filtering, repeating in u and clamped in v.
uniform sampler2D environment_map;
#endif

#ifdef MOKA_SUN_DISCS
// Suns that are not in the map: even discs, with edges as soft as a pixel.
// Their flux is right at any size, also below a pixel. There may be no
// derivatives here, since the sky is not read where a model hides it.
vec3 sun_light(vec3 direction) {
    float size = length(direction);
    float pixel = length(direction_from_clip[1].xyz) * parameters.z / size;
    pixel = max(pixel, parameters.w);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < MOKA_SUN_DISCS; ++i) {
        vec4 disc = sun_discs[i];
        float radius = max(disc.w, 0.5 * pixel);
        // A chord, which is the angle for one so small.
        float angle = distance(direction / size, disc.xyz);
        float coverage =
            clamp((radius - angle) / max(pixel, 1e-7) + 0.5, 0.0, 1.0);
        // The integral of the coverage, over pi.
        float area = radius * radius + pixel * pixel / 12.0;
        sum += coverage * (disc.w * disc.w / area) * sun_radiances[i].rgb;
    }
    return sum;
}
#endif

// ``uv`` is the place in the picture, (0, 0) at the lower left.
vec3 background_radiance(vec2 uv) {
    vec4 clip = vec4(2.0 * uv - 1.0, 0.0, 1.0);
    vec3 direction = (direction_from_clip * clip).xyz;
#ifdef MOKA_BLURRED_SKY
    vec3 radiance = textureLod(specular_cube, direction, parameters.y).rgb;
#else
    vec2 place = equirectangular_from_direction(direction);
    // An explicit level: derivatives jump where u wraps around.
    vec3 radiance = textureLod(environment_map, place, parameters.y).rgb;
#endif
#ifdef MOKA_SUN_DISCS
    radiance += sun_light(direction);
#endif
    radiance *= parameters.x;
    return min(radiance, RADIANCE_MAXIMUM);
}
