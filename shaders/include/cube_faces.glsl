// A full-screen pass into the six faces of one level of a cube map at once,
// +X -X +Y -Y +Z -Z, or with MOKA_FACE into that one alone.
//
// What depends on the place within a face alone is computed once for the six,
// and so is whatever is read from a uniform block: a software rasteriser
// reads that again for every pixel.

#include "include/environment.glsl"

#ifdef MOKA_FACE
const int FIRST_FACE = MOKA_FACE;
const int FACE_COUNT = 1;
#else
const int FIRST_FACE = 0;
const int FACE_COUNT = 6;
#endif

in vec2 uv;
layout(location = 0) out vec4 radiance[FACE_COUNT];

// The direction, not normalised, of output ``i`` at ``place`` in its face.
vec3 direction_of_output(int i, vec2 place) {
    return direction_from_cube_face(FIRST_FACE + i, place);
}
