// The point of a surface that a fragment shows, as the rasteriser has
// interpolated it, and how it changes from pixel to pixel. With
// MOKA_VISIBILITY it is computed from the triangle that is seen, which
// include/visible_triangle.glsl does, for shaders that loop over triangles.

#ifdef MOKA_VISIBILITY

// A place in a texture: coordinates, and what is added to them for the next
// pixel across and up.
#define TEXTURE_PLACE mat3x2

vec3 surface_position;
vec3 surface_position_across;
vec3 surface_position_up;
uint surface_material;
bool surface_faces_viewer;
#ifdef MOKA_VERTEX_NORMAL
vec3 surface_normal;
#endif
#ifdef MOKA_VERTEX_TANGENT
vec4 surface_tangent;
#endif
#ifdef MOKA_UV_0
mat3x2 surface_uv_0;
#endif
#ifdef MOKA_UV_1
mat3x2 surface_uv_1;
#endif
#ifdef MOKA_VERTEX_COLOUR
vec4 surface_colour;
#endif

vec4 read_texture(sampler2D map, mat3x2 place) {
    return textureGrad(map, place[0], place[1], place[2]);
}

mat3x2 transformed(mat3x2 place, vec4 rows[2]) {
    mat3 columns = mat3(
        vec3(place[0], 1.0), vec3(place[1], 0.0), vec3(place[2], 0.0));
    return transpose(mat2x3(rows[0].xyz * columns, rows[1].xyz * columns));
}

vec3 position_across() { return surface_position_across; }
vec3 position_up() { return surface_position_up; }
vec2 place_across(mat3x2 place) { return place[1]; }
vec2 place_up(mat3x2 place) { return place[2]; }

// Whether the neighbours of this pixel that derivatives are taken from show
// what goes on from here, and not something behind or before it.
bool has_neighbours() {
    vec3 across = dFdx(surface_position) - surface_position_across;
    vec3 up = dFdy(surface_position) - surface_position_up;
    return dot(across, across) + dot(up, up)
        < dot(surface_position_across, surface_position_across)
            + dot(surface_position_up, surface_position_up);
}

// Back faces of a single-sided material are culled.
#ifdef MOKA_DOUBLE_SIDED
#define FRONT_FACING surface_faces_viewer
#else
#define FRONT_FACING true
#endif

#else

#define TEXTURE_PLACE vec2

in vec3 surface_position;
flat in uint surface_material;
#ifdef MOKA_VERTEX_NORMAL
centroid in vec3 surface_normal;
#endif
#ifdef MOKA_VERTEX_TANGENT
centroid in vec4 surface_tangent;
#endif
#ifdef MOKA_UV_0
in vec2 surface_uv_0;
#endif
#ifdef MOKA_UV_1
in vec2 surface_uv_1;
#endif
#ifdef MOKA_VERTEX_COLOUR
centroid in vec4 surface_colour;
#endif

vec4 read_texture(sampler2D map, vec2 place) {
    return texture(map, place);
}

vec2 transformed(vec2 place, vec4 rows[2]) {
    return vec2(
        dot(rows[0].xyz, vec3(place, 1.0)),
        dot(rows[1].xyz, vec3(place, 1.0)));
}

vec3 position_across() { return dFdx(surface_position); }
vec3 position_up() { return dFdy(surface_position); }
vec2 place_across(vec2 place) { return dFdx(place); }
vec2 place_up(vec2 place) { return dFdy(place); }
bool has_neighbours() { return true; }

#ifdef MOKA_DOUBLE_SIDED
#define FRONT_FACING gl_FrontFacing
#else
#define FRONT_FACING true
#endif

#endif
