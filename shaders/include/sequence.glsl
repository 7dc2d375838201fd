// Low-discrepancy sequences that are randomised per pixel.
//
// Kronecker sequences with the powers of a generalised golden ratio as
// steps: Roberts 2018, "The Unreasonable Effectiveness of Quasirandom
// Sequences". In fixed point they cost a multiplication a dimension and
// lose nothing however long they run. Each pixel starts elsewhere: Cranley
// and Patterson 1976, "Randomization of Number Theoretic Methods for
// Multiple Integration", which keeps estimates unbiased and independent.

// Jarzynski and Olano 2020, "Hash Functions for GPU Rendering": pcg4d.
uvec4 hash(uvec4 v) {
    v = v * 1664525u + 1013904223u;
    for (int i = 0; i < 2; ++i) {
        v.x += v.y * v.w;
        v.y += v.z * v.x;
        v.z += v.x * v.y;
        v.w += v.y * v.z;
        if (i == 0) v ^= v >> 16u;
    }
    return v;
}

// Points of the unit square, without 1: a float holds 24 bits.
vec2 sequence(uint index, uvec2 start) {
    uvec2 bits = index * uvec2(0xC13FA9A9u, 0x91E10DA6u) + start;
    return vec2(bits >> 8u) / 16777216.0;
}
