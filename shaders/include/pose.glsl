// Poses of a frame: joint matrices, and which morph targets are active.
// moka.renderer.pose_texture writes them.

#if defined(MOKA_SKIN_SETS) || defined(MOKA_MORPH_TEXELS)
uniform sampler2D poses;

vec4 pose_texel(int number) {
    int row = number >> MOKA_POSE_ROW_BITS;
    int column = number & ((1 << MOKA_POSE_ROW_BITS) - 1);
    return texelFetch(poses, ivec2(column, row), 0);
}
#endif
