// Vertices of a model's surface. The block Frame is injected.

#include "include/instance.glsl"
#include "include/vertex_colour.glsl"
#include "include/morph.glsl"
#include "include/skin.glsl"
#include "include/line.glsl"

in vec3 position;
out vec3 surface_position;  // world space, relative to the camera
flat out uint surface_material;
#ifdef MOKA_OBJECT
flat out uint surface_object;
#endif

#ifdef MOKA_VERTEX_NORMAL
in vec3 normal;
// Where a triangle covers only samples beside the centre of a pixel, plain
// interpolation would extrapolate the normal away from the viewer, and the
// silhouette would sparkle.
centroid out vec3 surface_normal;
#endif
#ifdef MOKA_VERTEX_TANGENT
in vec4 tangent;
centroid out vec4 surface_tangent;
#endif
#ifdef MOKA_UV_0
in vec2 uv_0;
out vec2 surface_uv_0;
#endif
#ifdef MOKA_UV_1
in vec2 uv_1;
out vec2 surface_uv_1;
#endif
#ifdef MOKA_VERTEX_COLOUR
in vec4 colour_0;
centroid out vec4 surface_colour;  // as the normal
#endif

void main() {
    vec3 point = position;
#ifdef MOKA_MORPH_TEXELS
    add_morph_targets();
#endif
#ifdef MOKA_MORPH_POSITION
    point += morphed[MOKA_MORPH_POSITION].xyz;
#endif
#ifdef MOKA_SKIN_SETS
    mat3x4 rows = skin_rows();
#else
    mat3x4 rows = instance_rows();
#endif
    surface_position = place_point(rows, point);
    surface_material = instance_data.x;
#ifdef MOKA_OBJECT
    surface_object = instance_data.y;
#endif
#ifdef MOKA_VERTEX_NORMAL
    vec3 across = normal;
#ifdef MOKA_MORPH_NORMAL
    across += morphed[MOKA_MORPH_NORMAL].xyz;
#endif
    float handedness = handedness_of(rows);
    // Normalised here, so that a scaled object interpolates as it would
    // unscaled. A zero normal stays zero; the fragment shader replaces it.
    surface_normal =
        direction_of(place_normal(rows, direction_of(across), handedness));
#endif
#ifdef MOKA_VERTEX_TANGENT
    vec3 along = tangent.xyz;
#ifdef MOKA_MORPH_TANGENT
    along += morphed[MOKA_MORPH_TANGENT].xyz;
#endif
    surface_tangent = vec4(
        direction_of(place_direction(rows, direction_of(along))),
        tangent.w * handedness);
#endif
#ifdef MOKA_UV_0
    surface_uv_0 = uv_0;
#ifdef MOKA_MORPH_UV
    surface_uv_0 += morphed[MOKA_MORPH_UV].xy;
#endif
#endif
#ifdef MOKA_UV_1
    surface_uv_1 = uv_1;
#ifdef MOKA_MORPH_UV
    surface_uv_1 += morphed[MOKA_MORPH_UV].zw;
#endif
#endif
#ifdef MOKA_VERTEX_COLOUR
    vec4 colour = colour_0;
#ifdef MOKA_MORPH_COLOUR
    colour += morphed[MOKA_MORPH_COLOUR];
#endif
    surface_colour = part_of_light(colour);
#endif
    gl_Position = clip_from_world * vec4(surface_position, 1.0);
#ifdef MOKA_LINES
    gl_Position = line_corner(
        gl_Position,
        clip_from_world * vec4(place_point(rows, line_other.xyz), 1.0));
#endif
#ifdef MOKA_POINTS
    gl_PointSize = point_size;
#endif
}
