// Drawing directions like the light of an environment map; the table comes
// from moka.lighting.importance.

#include "include/environment.glsl"

// Per cell of the map: x probability to stay, yz the cell to go to
// otherwise, w density over texture coordinates at its centre. Linear
// filtering, repeating in u and clamped in v: the density in between is
// interpolated like the map.
uniform sampler2D importance_table;

// Density over texture coordinates to density per steradian. The sine is
// that of the polar angle; at a pole the density has no bound.
float density_per_steradian(vec2 place, float sine) {
    float density = textureLod(importance_table, place, 0.0).w;
    return density / (2.0 * PI * PI * max(sine, 1e-6));
}

// The density, per steradian, with which sample_environment draws the unit
// vector ``direction`` of the environment's own space.
float environment_density(vec3 direction) {
    return density_per_steradian(
        equirectangular_from_direction(direction), length(direction.xz));
}

// Distributed like a tent from -1 to 1 over a uniform number: the inverse
// of its cumulative distribution.
vec2 sample_tent(vec2 point) {
    vec2 twice = 2.0 * point;
    return mix(
        1.0 - sqrt(max(2.0 - twice, 0.0)), sqrt(twice) - 1.0,
        lessThan(twice, vec2(1.0)));
}

// A direction of the environment's own space, w its density. The alias
// method (Walker 1977): ``point`` picks a cell, ``choice`` whether to stay;
// what is left of ``point`` places the direction around the cell's centre.
vec4 sample_environment(vec2 point, float choice) {
    vec2 cells = vec2(textureSize(importance_table, 0));
    vec2 place = point * cells;
    vec2 cell = min(floor(place), cells - 1.0);
    vec2 within = place - cell;
    vec4 entry = texelFetch(importance_table, ivec2(cell), 0);
    if (choice >= entry.x) cell = entry.yz;
    vec2 uv = (cell + 0.5 + sample_tent(within)) / cells;
    // Beyond a pole the tent comes back, as clamped texels have it.
    uv.y = abs(uv.y);
    uv.y = min(uv.y, 2.0 - uv.y);
    vec3 direction = direction_from_equirectangular(uv);
    return vec4(
        direction, density_per_steradian(uv, length(direction.xz)));
}
