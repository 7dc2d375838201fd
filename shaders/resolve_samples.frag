// The mean of all batches of a pixel, however many it got; until one is
// complete, the mean of the frames there are of it.

layout(std140) uniform Accumulation {
    int frames;  // of the batch that has begun
    int tile;    // pixels along the edge of a tile
};

uniform sampler2D batch_map;
uniform sampler2D sum_map;
uniform sampler2D moment_map;

out vec4 radiance;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float batches = texelFetch(moment_map, pixel, 0).z;
    radiance = batches > 0.0
        ? texelFetch(sum_map, pixel, 0) / batches
        : texelFetch(batch_map, pixel, 0) / float(frames);
}
