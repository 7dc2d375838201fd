// Depth whose steps are the same part of the distance everywhere, for want of
// reversed depth: Kemen 2009, "Logarithmic Depth Buffer". From the fragment
// and not from the vertices, between which it is not linear.
#ifdef MOKA_LOGARITHMIC_DEPTH
void write_depth() {
    // At the edge of a triangle w can be extrapolated beyond infinity.
    float distance = 1.0 / max(gl_FragCoord.w, 1e-37);
    if (distance > depth_range.y) discard;
    gl_FragDepth = clamp(
        log2(distance / depth_range.x) * depth_range.z, 0.0, 1.0);
}
#endif
