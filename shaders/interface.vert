// Triangles of the panels, in the window's coordinates: the origin is the
// upper left corner, y points down.

in vec2 position;
in vec2 uv;
in vec4 colour;
in vec4 clip;        // left, top, right, bottom of what may be seen

out vec2 place;
out vec2 texel;
out vec4 tint;
flat out vec4 bounds;

layout(std140) uniform Interface {
    vec4 window;     // xy its upper left corner, zw its size
};

void main() {
    place = position;
    texel = uv;
    tint = colour;
    bounds = clip;
    vec2 unit = (position - window.xy) / window.zw;
    gl_Position = vec4(2.0 * unit.x - 1.0, 1.0 - 2.0 * unit.y, 0.0, 1.0);
}
