// What a full-screen pass into one face of a cube map is told.

#include "include/environment.glsl"

layout(std140) uniform CubeFace {
    int face;          // 0..5 = +X -X +Y -Y +Z -Z
    int size;          // texels along an edge of the level drawn to
    int subdivisions;  // of a texel along an edge, where a pass averages
    float source_lod;  // level of the source that is read
};
