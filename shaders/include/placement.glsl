// From object space to the world. ``rows`` are the upper three rows of an
// affine matrix as the columns of another: vec4(p, 1) * rows places p.

#include "include/direction.glsl"

vec3 place_point(mat3x4 rows, vec3 point) {
    return vec4(point, 1.0) * rows;
}

vec3 place_direction(mat3x4 rows, vec3 direction) {
    return direction * mat3(rows);
}

// Normals go by the inverse transpose, up to a positive factor: the matrix
// of cofactors, whose rows are the cross products of the matrix's rows,
// times the sign of the determinant. It needs no inverse, so a flattened
// object keeps its normals. They are products of two entries, which have to
// be of about 1.
vec3 place_normal(mat3x4 rows, vec3 normal, float handedness) {
    vec3 x = rows[0].xyz;
    vec3 y = rows[1].xyz;
    vec3 z = rows[2].xyz;
    float size = max(
        max(largest_component(x), largest_component(y)),
        max(largest_component(z), 1e-37));
    x /= size;
    y /= size;
    z /= size;
    return handedness * vec3(
        dot(cross(y, z), normal),
        dot(cross(z, x), normal),
        dot(cross(x, y), normal));
}

// -1 where the transform mirrors. Directions have the determinant's sign.
float handedness_of(mat3x4 rows) {
    vec3 x = direction_of(rows[0].xyz);
    vec3 y = direction_of(rows[1].xyz);
    vec3 z = direction_of(rows[2].xyz);
    float determinant = dot(x, cross(y, z));
    return determinant < 0.0 ? -1.0 : 1.0;
}
