// The mean of all batches of a pixel, however many it got; until one is
// complete, the mean of the frames there are.

layout(std140) uniform Accumulation {
    int frames;  // of the first batch if it is what there is, else 0
    int tile;    // pixels along the edge of a tile
};

uniform sampler2D batch_map;
uniform sampler2D sum_map;
uniform sampler2D moment_map;

out vec4 radiance;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    radiance = frames > 0
        ? texelFetch(batch_map, pixel, 0) / float(frames)
        : texelFetch(sum_map, pixel, 0)
            / max(texelFetch(moment_map, pixel, 0).z, 1.0);
}
