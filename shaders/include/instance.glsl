// One row of the instance array, as vertex attributes with divisor 1.

#include "include/direction.glsl"

in vec4 instance_row_0;   // upper three rows of the affine matrix from
in vec4 instance_row_1;   // object space to world space, whose origin is
in vec4 instance_row_2;   // moved to the camera
in uvec4 instance_data;   // x row of the material, y object number

vec3 place_point(vec3 point) {
    vec4 p = vec4(point, 1.0);
    return vec3(
        dot(instance_row_0, p), dot(instance_row_1, p), dot(instance_row_2, p));
}

vec3 place_direction(vec3 direction) {
    return vec3(
        dot(instance_row_0.xyz, direction),
        dot(instance_row_1.xyz, direction),
        dot(instance_row_2.xyz, direction));
}

// Normals go by the inverse transpose, up to a positive factor: the matrix
// of cofactors, whose rows are the cross products of the matrix's rows,
// times the sign of the determinant. It needs no inverse, so a flattened
// object keeps its normals. They are products of two entries, which have to
// be of about 1.
vec3 place_normal(vec3 normal, float handedness) {
    vec3 x = instance_row_0.xyz;
    vec3 y = instance_row_1.xyz;
    vec3 z = instance_row_2.xyz;
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
float instance_handedness() {
    vec3 x = direction_of(instance_row_0.xyz);
    vec3 y = direction_of(instance_row_1.xyz);
    vec3 z = direction_of(instance_row_2.xyz);
    float determinant = dot(x, cross(y, z));
    return determinant < 0.0 ? -1.0 : 1.0;
}
