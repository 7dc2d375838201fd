// One triangle that covers the viewport, in the plane that is farthest where
// depth is reversed. What all pixels share goes along as
// flat outputs: drivers in software read them once for many pixels and a
// block once for each. Frame and its copies are injected.

void main() {
    copy_frame();
    vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
    gl_Position = vec4(4.0 * corner - 1.0, 0.0, 1.0);
}
