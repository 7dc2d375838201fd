// The surfaces of models, pixel by pixel: what visibility.frag has found is
// shaded once for all samples that show it, however many triangles it has.

#include "include/surface_radiance.glsl"
#include "include/visible_triangle.glsl"

#if MOKA_VISIBILITY > 1
uniform usampler2DMS visible_triangles;
#else
uniform usampler2D visible_triangles;
#endif

out vec4 radiance;

#if MOKA_VISIBILITY > 1

// Samples whose triangles have a vertex in common, and with it the normals
// and the coordinates there, show one surface. It is shaded where the first
// of these triangles is nearest to the centre of the pixel. Multisampling
// would shade each triangle by itself, and mostly find the same.
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint seen[MOKA_VISIBILITY];
    uvec3 corners[MOKA_VISIBILITY];
    for (int i = 0; i < MOKA_VISIBILITY; ++i) {
        seen[i] = texelFetch(visible_triangles, pixel, i).x;
        corners[i] =
            corners_of(seen[i], instance_numbers(instance_of(seen[i])));
    }
    radiance = vec4(0.0);
    uint left;
    // Not `while`: drivers in software run the body once more for it.
    do {
        int instance = 0;
        uvec3 chosen = corners[0];
        for (int i = MOKA_VISIBILITY - 1; i >= 0; --i) {
            chosen = seen[i] != 0u ? corners[i] : chosen;
            instance = seen[i] != 0u ? instance_of(seen[i]) : instance;
        }
        float samples = 0.0;
        left = 0u;
        for (int i = 0; i < MOKA_VISIBILITY; ++i) {
            bool joins = seen[i] != 0u && instance_of(seen[i]) == instance
                && share_corner(chosen, corners[i]);
            samples += joins ? 1.0 : 0.0;
            seen[i] = joins ? 0u : seen[i];
            left |= seen[i];
        }
        load_surface(instance, instance_numbers(instance), chosen);
        radiance += samples * surface_radiance();
    } while (left != 0u);
    radiance /= float(MOKA_VISIBILITY);
}

#else

void main() {
    uint seen = texelFetch(visible_triangles, ivec2(gl_FragCoord.xy), 0).x;
    int instance = instance_of(seen);
    uvec4 numbers = instance_numbers(instance);
    load_surface(instance, numbers, corners_of(seen, numbers));
    radiance = surface_radiance();
}

#endif
