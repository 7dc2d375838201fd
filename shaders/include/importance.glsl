// Drawing directions like the light of an environment map; the table comes
// from moka.lighting.importance.

#include "include/environment.glsl"

// Per cell of the map: x probability of the cells up to it in its row, y of
// the rows up to its own, z density over texture coordinates at its centre,
// w guides, see guide_to_cell and guide_to_row. Linear filtering, repeating
// in u and clamped in v: the density in between is interpolated like the map.
uniform sampler2D importance_table;

const int GUIDE_BASE = 4096;

// Density over texture coordinates to density per steradian. The sine is
// that of the polar angle; at a pole the density has no bound.
float density_per_steradian(vec2 place, float sine) {
    float density = textureLod(importance_table, place, 0.0).z;
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

// The first cell of a row that is above cell / cells; the last past the end.
int guide_to_cell(int cell, int cells, int row) {
    if (cell >= cells) return cells - 1;
    return int(texelFetch(importance_table, ivec2(cell, row), 0).w)
        % GUIDE_BASE;
}

int guide_to_row(int row, int rows) {
    if (row >= rows) return rows - 1;
    return int(texelFetch(importance_table, ivec2(0, row), 0).w)
        / GUIDE_BASE;
}

// The first row up to which the probability is above ``u``, and how far
// between the sums ``u`` is, 0 to 1.
float find_row(float u, int rows, out int row) {
    int guide = int(u * float(rows));
    row = guide_to_row(guide, rows);
    for (int end = guide_to_row(guide + 1, rows); row < end;) {
        int middle = (row + end) / 2;
        if (texelFetch(importance_table, ivec2(0, middle), 0).y > u)
            end = middle;
        else
            row = middle + 1;
    }
    float before = row > 0
        ? texelFetch(importance_table, ivec2(0, row - 1), 0).y : 0.0;
    float after = texelFetch(importance_table, ivec2(0, row), 0).y;
    return clamp((u - before) / max(after - before, 1e-30), 0.0, 1.0);
}

// The same for the cells of a row.
float find_cell(float u, int cells, int row, out int cell) {
    int guide = int(u * float(cells));
    cell = guide_to_cell(guide, cells, row);
    for (int end = guide_to_cell(guide + 1, cells, row); cell < end;) {
        int middle = (cell + end) / 2;
        if (texelFetch(importance_table, ivec2(middle, row), 0).x > u)
            end = middle;
        else
            cell = middle + 1;
    }
    float before = cell > 0
        ? texelFetch(importance_table, ivec2(cell - 1, row), 0).x : 0.0;
    float after = texelFetch(importance_table, ivec2(cell, row), 0).x;
    return clamp((u - before) / max(after - before, 1e-30), 0.0, 1.0);
}

// A direction of the environment's own space, w its density, for a point of
// the unit square.
vec4 sample_environment(vec2 point) {
    ivec2 cells = textureSize(importance_table, 0);
    ivec2 cell;
    vec2 within;
    within.y = find_row(point.y, cells.y, cell.y);
    within.x = find_cell(point.x, cells.x, cell.y, cell.x);
    vec2 uv = (vec2(cell) + 0.5 + sample_tent(within)) / vec2(cells);
    // Beyond a pole the tent comes back, as clamped texels have it.
    uv.y = abs(uv.y);
    uv.y = min(uv.y, 2.0 - uv.y);
    vec3 direction = direction_from_equirectangular(uv);
    return vec4(
        direction, density_per_steradian(uv, length(direction.xz)));
}
