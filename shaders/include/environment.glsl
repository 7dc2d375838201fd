// Directions, and where maps of the whole sphere keep them.

#include "include/constants.glsl"

// atan(x) / pi for x from -1 to 1: the polynomial of this degree whose
// largest error, 8e-8, is smallest (tests/support/oracles/minimax.py).
vec2 arctangent_over_pi(vec2 x) {
    vec2 square = x * x;
    vec2 sum = 0.00216826106 * square - 0.0106965554;
    sum = sum * square + 0.0253450018;
    sum = sum * square - 0.0421230360;
    sum = sum * square + 0.0630502350;
    sum = sum * square - 0.106052476;
    return x * (sum * square + 0.318308648);
}

// The texture coordinates of a direction in an equirectangular map that
// repeats in u and whose top row is at v = 0: v = acos(y) / pi, and u = 0.5 +
// atan2(z, x) / 2 pi, less 1 where x < 0 < z: from -0.25 to 0.75. The
// length of a direction is between 1e-9 and 1e9.
//
// Without cases: half an azimuth, mirrored to x >= 0, and half a latitude are
// at most an eighth of a turn, so their tangents are at most 1. u is
// arbitrary at a pole, but 0 / 0 would be undefined.
vec2 equirectangular_from_direction(vec3 direction) {
    float radius = length(direction.xz);
    vec2 adjacent = vec2(
        max(radius + abs(direction.x), 1e-20), length(direction) + radius);
    // One division for both.
    vec2 tangents = direction.zy * adjacent.yx / (adjacent.x * adjacent.y);
    vec2 halves = arctangent_over_pi(tangents);
    return vec2(
        direction.x < 0.0 ? -halves.x : 0.5 + halves.x, 0.5 - 2.0 * halves.y);
}

// The unit direction at texture coordinates ``uv`` of such a map.
vec3 direction_from_equirectangular(vec2 uv) {
    float azimuth = (uv.x - 0.5) * 2.0 * PI;
    float polar = uv.y * PI;
    float radius = sin(polar);
    return vec3(
        radius * cos(azimuth), cos(polar), radius * sin(azimuth));
}

// The direction, not normalised, at ``uv`` of face 0..5 = +X -X +Y -Y +Z -Z
// of a cube map: OpenGL 3.3, table 3.19, solved for the direction. A face is
// rendered with the same uv, (0, 0) where gl_FragCoord is, so texture() in
// that direction reads what was drawn there. Its largest component is 1.
vec3 direction_from_cube_face(int face, vec2 uv) {
    const mat3 faces[6] = mat3[6](
        mat3(0, 0, -1, 0, -1, 0, 1, 0, 0),
        mat3(0, 0, 1, 0, -1, 0, -1, 0, 0),
        mat3(1, 0, 0, 0, 0, 1, 0, 1, 0),
        mat3(1, 0, 0, 0, 0, -1, 0, -1, 0),
        mat3(1, 0, 0, 0, -1, 0, 0, 0, 1),
        mat3(-1, 0, 0, 0, -1, 0, 0, 0, -1));
    return faces[face] * vec3(2.0 * uv - 1.0, 1.0);
}

// The solid angle of a small texel, relative to one in the middle of its
// face, from the direction that direction_from_cube_face gives.
float relative_solid_angle(vec3 direction) {
    float squared = dot(direction, direction);
    return inversesqrt(squared) / squared;
}

// The direction in an environment's own space that is seen in ``direction``
// of the world, when the environment is turned counter-clockwise about +Y by
// an angle whose (cosine, sine) is ``turn``.
vec3 turn_into_environment(vec3 direction, vec2 turn) {
    return vec3(
        direction.x * turn.x - direction.z * turn.y,
        direction.y,
        direction.x * turn.y + direction.z * turn.x);
}
