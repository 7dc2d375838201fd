// Morph targets: what those with a weight add to a vertex (glTF 2.0,
// 3.7.2.2). moka.renderer.morph_deltas writes the texels that are added.

#include "include/instance.glsl"
#include "include/pose.glsl"

#ifdef MOKA_MORPH_TEXELS
uniform samplerBuffer morph_deltas;

// The sums, by MOKA_MORPH_POSITION and so on.
vec4 morphed[MOKA_MORPH_TEXELS];

// A list of poses begins with the number of active targets and where the
// vertices of the mesh begin; for each target it has the weight, the first
// vertex that it moves, how many from there on, and where their texels are.
void add_morph_targets() {
    for (int i = 0; i < MOKA_MORPH_TEXELS; ++i) morphed[i] = vec4(0.0);
    int list = int(instance_data.w);
    vec4 head = texelFetch(poses, list);
    int vertex = gl_VertexID - (int(head.y) * 4096 + int(head.z));
    for (int last = list + int(head.x); list < last;) {
        vec4 target = texelFetch(poses, ++list);
        int moved = vertex - int(target.y);
        if (moved < 0 || moved >= int(target.z)) continue;
        int texel = 16 * int(target.w) + MOKA_MORPH_TEXELS * moved;
        for (int i = 0; i < MOKA_MORPH_TEXELS; ++i)
            morphed[i] += target.x * texelFetch(morph_deltas, texel + i);
    }
}
#endif
