// One row of the instance array, as vertex attributes with divisor 1.

#include "include/placement.glsl"

in vec4 instance_row_0;   // upper three rows of the affine matrix from
in vec4 instance_row_1;   // object space to world space, whose origin is
in vec4 instance_row_2;   // moved to the camera
in uvec4 instance_data;   // x row of the material, y object number

// Its rows as a matrix whose columns they are: vec4(p, 1) * rows places p.
mat3x4 instance_rows() {
    return mat3x4(instance_row_0, instance_row_1, instance_row_2);
}
