// The environment as it is seen, read from the equirectangular map; of a
// pass whose triangle is that of screen.vert.

#include "include/background_block.glsl"
#include "include/constants.glsl"
#include "include/environment.glsl"

noperspective in vec3 sky_direction;
// As ``parameters`` of the block, but z the size of a pixel in
// ``sky_direction``.
flat in vec4 sky;

#ifdef MOKA_BLURRED_SKY
// As rough surfaces reflect it, rougher from level to level.
uniform samplerCube specular_cube;
#else
// Linear filtering, repeating in u and clamped in v.
uniform sampler2D environment_map;
#endif

#ifdef MOKA_SUN_DISCS
#ifdef MOKA_FLAT_SUNS
flat in vec4 flat_sun_discs[MOKA_SUN_DISCS];
flat in vec4 flat_sun_radiances[MOKA_SUN_DISCS];
#define MOKA_SUN_DISC(i) flat_sun_discs[i]
#define MOKA_SUN_RADIANCE(i) flat_sun_radiances[i]
#else
#define MOKA_SUN_DISC(i) sun_discs[i]
#define MOKA_SUN_RADIANCE(i) sun_radiances[i]
#endif

// Suns that are not in the map: even discs, with edges as soft as a pixel.
// Their flux is right at any size, also below a pixel.
vec3 sun_light() {
    float size = length(sky_direction);
    vec3 direction = sky_direction / size;
    float pixel = max(sky.z / size, sky.w);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < MOKA_SUN_DISCS; ++i) {
        vec4 disc = MOKA_SUN_DISC(i);
        float radius = max(disc.w, 0.5 * pixel);
        // A chord, which is the angle for one so small.
        float angle = distance(direction, disc.xyz);
        float coverage =
            clamp((radius - angle) / max(pixel, 1e-7) + 0.5, 0.0, 1.0);
        // The integral of the coverage, over pi.
        float area = radius * radius + pixel * pixel / 12.0;
        sum += coverage * (disc.w * disc.w / area) * MOKA_SUN_RADIANCE(i).rgb;
    }
    return sum;
}
#endif

vec3 background_radiance() {
#ifdef MOKA_BLURRED_SKY
    vec3 radiance = textureLod(specular_cube, sky_direction, sky.y).rgb;
#else
    vec2 place = equirectangular_from_direction(sky_direction);
    // An explicit level: derivatives jump where u wraps around.
    vec3 radiance = textureLod(environment_map, place, 0.0).rgb;
#endif
#ifdef MOKA_SUN_DISCS
    radiance += sun_light();
#endif
    return min(sky.x * radiance, RADIANCE_MAXIMUM);
}
