// One triangle that covers the viewport, made from gl_VertexID (no buffer).

#ifndef MOKA_FAR_DEPTH
#define MOKA_FAR_DEPTH 0.0  // for passes that are not tested against depth
#endif

out vec2 uv;  // 0..1 over the viewport, (0, 0) at the lower left

void main() {
    vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
    uv = 2.0 * corner;
    gl_Position = vec4(4.0 * corner - 1.0, MOKA_FAR_DEPTH, 1.0);
}
