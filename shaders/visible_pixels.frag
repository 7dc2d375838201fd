// Marks, by its depth, each pixel of which any sample shows a triangle.

uniform usampler2DMS visible_triangles;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint seen = 0u;
    for (int i = 0; i < MOKA_VISIBILITY; ++i) {
        seen |= texelFetch(visible_triangles, pixel, i).x;
    }
    if (seen == 0u) discard;
}
