// What a tile of pixels says of its own error: one texel a tile.
//
// x mean square of the pixels' relative standard errors, y mean number of
// batches, z pixels of the tile. The variance of a mean of N batches is
// estimated by (sum of squares / N - mean^2) / (N - 1). Relative to the pixel
// itself, so that one bright pixel does not speak for all of a tile.

layout(std140) uniform Accumulation {
    int frames;
    int tile;  // pixels along the edge of a tile
};

uniform sampler2D moment_map;

out vec4 error;

void main() {
    ivec2 first = ivec2(gl_FragCoord.xy) * tile;
    ivec2 end = min(first + tile, textureSize(moment_map, 0));
    vec2 sum = vec2(0.0);
    for (int y = first.y; y < end.y; ++y) {
        for (int x = first.x; x < end.x; ++x) {
            vec3 moments = texelFetch(moment_map, ivec2(x, y), 0).xyz;
            float count = max(moments.z, 1.0);
            float mean = moments.x / count;
            // Rounding can leave a constant pixel below zero.
            float variance = max(moments.y / count - mean * mean, 0.0);
            // Black is black without an error; squares of less underflow.
            float relative = variance / max(mean * mean, 1e-30);
            sum += vec2(relative / max(count - 1.0, 1.0), moments.z);
        }
    }
    ivec2 covered = end - first;
    float pixels = float(covered.x * covered.y);
    error = vec4(sum / pixels, pixels, 0.0);
}
