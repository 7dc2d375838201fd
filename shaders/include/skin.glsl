// Skins: a vertex goes to the mean of where its joints put it, whatever the
// node that places its mesh says (glTF 2.0, 3.7.3.3).

#include "include/instance.glsl"
#include "include/pose.glsl"

#ifdef MOKA_SKIN_SETS
in vec4 joints_0;
in vec4 weights_0;
#if MOKA_SKIN_SETS > 1
in vec4 joints_1;
in vec4 weights_1;
#endif
#if MOKA_SKIN_SETS > 2
in vec4 joints_2;
in vec4 weights_2;
#endif

mat3x4 joint_rows(float joint) {
    int texel = int(instance_data.z) + 3 * int(joint);
    return mat3x4(
        texelFetch(poses, texel), texelFetch(poses, texel + 1),
        texelFetch(poses, texel + 2));
}

mat3x4 mean_of_joints(vec4 joints, vec4 weights) {
    return weights.x * joint_rows(joints.x) + weights.y * joint_rows(joints.y)
        + weights.z * joint_rows(joints.z) + weights.w * joint_rows(joints.w);
}

// What takes the place of instance_rows(). The joints are relative to an
// anchor among them, which the instance moves to where it is.
mat3x4 skin_rows() {
    mat3x4 rows = mean_of_joints(joints_0, weights_0);
#if MOKA_SKIN_SETS > 1
    rows += mean_of_joints(joints_1, weights_1);
#endif
#if MOKA_SKIN_SETS > 2
    rows += mean_of_joints(joints_2, weights_2);
#endif
    rows[0].w += instance_row_0.w;
    rows[1].w += instance_row_1.w;
    rows[2].w += instance_row_2.w;
    return rows;
}
#endif
