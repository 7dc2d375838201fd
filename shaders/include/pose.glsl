// Poses of a frame: joint matrices, and which morph targets are active.
// moka.renderer.pose_texture writes them.

#if defined(MOKA_SKIN_SETS) || defined(MOKA_MORPH_TEXELS)
uniform samplerBuffer poses;
#endif
