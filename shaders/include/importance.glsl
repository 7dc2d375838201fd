// Drawing directions like the light of an environment map; the table comes
// from moka.lighting.importance.

#include "include/environment.glsl"

// Per cell of the map: x probability to stay, yz the cell to go to
// otherwise, w density per steradian. Read texel by texel.
uniform sampler2D importance_table;

// The density, per steradian, with which sample_environment draws a
// direction of the environment's own space.
float environment_density(vec3 direction) {
    ivec2 cells = textureSize(importance_table, 0);
    vec2 place = equirectangular_from_direction(direction) * vec2(cells);
    ivec2 cell = clamp(ivec2(place), ivec2(0), cells - 1);
    return texelFetch(importance_table, cell, 0).w;
}

// A direction of the environment's own space, w its density. The alias
// method (Walker 1977): ``point`` picks a cell, ``choice`` whether to stay.
// What is left of ``point`` places the direction in the cell, uniform in
// azimuth and cosine and so in solid angle. The cosine goes by sin^2 of half
// the polar angle, which keeps its digits at the pole.
vec4 sample_environment(vec2 point, float choice) {
    vec2 cells = vec2(textureSize(importance_table, 0));
    vec2 place = point * cells;
    vec2 cell = min(floor(place), cells - 1.0);
    vec2 within = place - cell;
    vec4 entry = texelFetch(importance_table, ivec2(cell), 0);
    if (choice >= entry.x) {
        cell = entry.yz;
        entry.w = texelFetch(importance_table, ivec2(cell), 0).w;
    }
    float azimuth = ((cell.x + within.x) / cells.x - 0.5) * 2.0 * PI;
    vec2 half_sine =
        sin(vec2(cell.y, cell.y + 1.0) * (0.5 * PI / cells.y));
    half_sine *= half_sine;
    float s = mix(half_sine.x, half_sine.y, within.y);
    float radius = 2.0 * sqrt(max(s * (1.0 - s), 0.0));
    return vec4(
        radius * cos(azimuth), 1.0 - 2.0 * s, radius * sin(azimuth),
        entry.w);
}
