// One triangle that covers the viewport, made from gl_VertexID (no buffer).

#ifndef MOKA_FAR_DEPTH
#define MOKA_FAR_DEPTH 0.0  // for passes that are not tested against depth
#endif

vec4 fullscreen_position() {
    vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
    return vec4(4.0 * corner - 1.0, MOKA_FAR_DEPTH, 1.0);
}
