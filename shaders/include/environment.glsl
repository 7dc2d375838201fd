// Directions, and where maps of the whole sphere keep them.

#include "include/constants.glsl"

// The texture coordinates of a direction in an equirectangular map whose top
// row is at v = 0: u = 0.5 + atan2(z, x) / 2 pi, v = acos(y) / pi. atan in
// place of acos, which loses half its digits towards the poles. u is
// arbitrary at a pole, but atan(0, 0) would be undefined.
vec2 equirectangular_from_direction(vec3 direction) {
    float radius = length(direction.xz);
    float x = radius > 0.0 ? direction.x : 1.0;
    return vec2(
        0.5 + 0.5 * INVERSE_PI * atan(direction.z, x),
        INVERSE_PI * atan(radius, direction.y));
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
