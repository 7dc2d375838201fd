// Adds a batch's mean to the sum over batches, and what its variance needs.
//
// Batches are randomised anew and so independent: the spread of their means
// is the error of the mean of all of them (Owen 1997, "Monte Carlo Variance
// of Scrambled Net Quadrature", section 1, for replicated nets).

layout(std140) uniform Accumulation {
    int frames;  // of the batch
    int tile;    // pixels along the edge of a tile
};

uniform sampler2D batch_map;

layout(location = 0) out vec4 sum;
layout(location = 1) out vec4 moments;  // of luminance: sum, squares; count

void main() {
    vec4 mean =
        texelFetch(batch_map, ivec2(gl_FragCoord.xy), 0) / float(frames);
    // Sums of squares of more are infinite; such light goes unjudged.
    float luminance = min(dot(mean.rgb, vec3(0.2126, 0.7152, 0.0722)), 1e15);
    sum = mean;
    moments = vec4(luminance, luminance * luminance, 1.0, 0.0);
}
