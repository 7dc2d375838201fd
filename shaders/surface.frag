// The surface of a model, triangle by triangle as it is drawn.

#include "include/surface_radiance.glsl"
#include "include/logarithmic_depth.glsl"

out vec4 radiance;

void main() {
#ifdef MOKA_LOGARITHMIC_DEPTH
    write_depth();
#endif
    radiance = surface_radiance();
}
