// A point of a surface from the triangle that a pixel sees. What surface.vert
// does for vertices and the rasteriser between them is done here for the
// three corners of one triangle and the centre of the pixel.

#include "include/placement.glsl"
#include "include/surface_point.glsl"
#include "include/vertex_colour.glsl"

// Rows of moka.commands.draws.INSTANCE, four texels each.
uniform usamplerBuffer instances;
// What triangles are drawn from: MOKA_VERTEX_TEXELS texels a vertex, of
// MOKA_TEXEL_WIDTH numbers each. Position comes first, MOKA_..._AT says with
// which of the numbers the others begin.
uniform usamplerBuffer indices;
uniform samplerBuffer vertices;

vec4 corner_texels[3 * MOKA_VERTEX_TEXELS];

#define CORNER(c, k) \
    corner_texels[(c) * MOKA_VERTEX_TEXELS + (k) / MOKA_TEXEL_WIDTH] \
        [(k) % MOKA_TEXEL_WIDTH]
#define CORNER_2(c, k) vec2(CORNER(c, k), CORNER(c, (k) + 1))
#define CORNER_3(c, k) vec3(CORNER_2(c, k), CORNER(c, (k) + 2))
#define CORNER_4(c, k) vec4(CORNER_3(c, k), CORNER(c, (k) + 3))

// Of a number in the visibility buffer: see visibility.frag.
int instance_of(uint seen) {
    return int(seen >> triangle_bits);
}

// x material, y what is added to indices, z not for here, w where they begin,
// with the highest bit set if it is mirrored.
uvec4 instance_numbers(int instance) {
    return texelFetch(instances, 4 * instance + 3);
}

// The indices of a triangle of an instance with these numbers.
uvec3 corners_of(uint seen, uvec4 numbers) {
    int triangle = int(seen & ((1u << triangle_bits) - 1u)) - 1;
    int first = int(numbers.w & 0x7fffffffu) + 3 * max(triangle, 0);
    return uvec3(
        texelFetch(indices, first).x,
        texelFetch(indices, first + 1).x,
        texelFetch(indices, first + 2).x);
}

bool share_corner(uvec3 a, uvec3 b) {
    return any(equal(a.xxx, b)) || any(equal(a.yyy, b))
        || any(equal(a.zzz, b));
}

// Weights of three corners, and how they change a pixel across and up.
struct Barycentric {
    vec3 here;
    vec3 across;
    vec3 up;
    bool is_clockwise;
};

// Of the centre of this pixel, from x, y and w of positions in clip space:
// homogeneous edge functions (Olano and Greer 1997, "Triangle Scan Conversion
// using 2D Homogeneous Coordinates"), which are linear on the screen and,
// divided by their sum, right in perspective. They need no division by a w
// that can be negative.
Barycentric barycentric(vec3 a, vec3 b, vec3 c) {
    vec2 step = 2.0 / picture_size;
    // Seen from here, so that products of triangles smaller than a pixel are
    // small, not differences of large ones.
    vec2 centre = gl_FragCoord.xy * step - 1.0;
    a.xy -= centre * a.z;
    b.xy -= centre * b.z;
    c.xy -= centre * c.z;
    mat3 edges = transpose(mat3(cross(b, c), cross(c, a), cross(a, b)));
    Barycentric weights;
    weights.is_clockwise = dot(vec3(a.x, b.x, c.x), edges[0]) < 0.0;
    float sum = edges[2].x + edges[2].y + edges[2].z;
    // What vanishes in float32 has weights all the same.
    float scale = sum == 0.0 ? 0.0 : 1.0 / sum;
    vec3 here = edges[2] * scale;
    weights.across = (edges[0] - here * (edges[0].x + edges[0].y + edges[0].z))
        * (step.x * scale);
    weights.up = (edges[1] - here * (edges[1].x + edges[1].y + edges[1].z))
        * (step.y * scale);
    // The centre can lie beside a triangle that other samples show.
    here = max(here, 0.0);
    sum = here.x + here.y + here.z;
    weights.here = sum > 0.0 ? here / sum : vec3(1.0 / 3.0);
    return weights;
}

// As direction_of, at a third of the cost: for lengths from 1e-18 to 1e18.
// Others keep their direction, and lose their weight among corners.
vec3 scaled_to_one(vec3 v) {
    return v * inversesqrt(max(dot(v, v), 1e-37));
}

mat3x4 visible_rows(int row) {
    return mat3x4(
        uintBitsToFloat(texelFetch(instances, 4 * row)),
        uintBitsToFloat(texelFetch(instances, 4 * row + 1)),
        uintBitsToFloat(texelFetch(instances, 4 * row + 2)));
}

// Sets what include/surface_point.glsl declares.
void load_surface(int instance, uvec4 numbers, uvec3 corners) {
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < MOKA_VERTEX_TEXELS; ++k) {
            int vertex = int(corners[c] + numbers.y);
            corner_texels[c * MOKA_VERTEX_TEXELS + k] =
                texelFetch(vertices, vertex * MOKA_VERTEX_TEXELS + k);
        }
    }
    mat3x4 rows = visible_rows(instance);
    surface_material = numbers.x;
    float handedness = numbers.w > 0x7fffffffu ? -1.0 : 1.0;
    mat3 points;
    mat3 seen;
    for (int c = 0; c < 3; ++c) {
        points[c] = place_point(rows, CORNER_3(c, 0));
        seen[c] = (clip_from_world * vec4(points[c], 1.0)).xyw;
    }
    Barycentric at = barycentric(seen[0], seen[1], seen[2]);
    surface_position = points * at.here;
    surface_position_across = points * at.across;
    surface_position_up = points * at.up;
    surface_faces_viewer = at.is_clockwise == (handedness < 0.0);
#ifdef MOKA_VERTEX_NORMAL
    mat3 normals;
    for (int c = 0; c < 3; ++c) {
        normals[c] = scaled_to_one(
            place_normal(rows, CORNER_3(c, MOKA_NORMAL_AT), handedness));
    }
    surface_normal = normals * at.here;
#endif
#ifdef MOKA_VERTEX_TANGENT
    mat3x4 tangents;
    for (int c = 0; c < 3; ++c) {
        vec4 tangent = CORNER_4(c, MOKA_TANGENT_AT);
        tangents[c] = vec4(
            scaled_to_one(place_direction(rows, tangent.xyz)),
            tangent.w * handedness);
    }
    surface_tangent = tangents * at.here;
#endif
    mat3 weights = mat3(at.here, at.across, at.up);
#ifdef MOKA_UV_0
    surface_uv_0 = mat3x2(
        CORNER_2(0, MOKA_UV_0_AT),
        CORNER_2(1, MOKA_UV_0_AT),
        CORNER_2(2, MOKA_UV_0_AT)) * weights;
#endif
#ifdef MOKA_UV_1
    surface_uv_1 = mat3x2(
        CORNER_2(0, MOKA_UV_1_AT),
        CORNER_2(1, MOKA_UV_1_AT),
        CORNER_2(2, MOKA_UV_1_AT)) * weights;
#endif
#ifdef MOKA_VERTEX_COLOUR
    mat3x4 colours;
    for (int c = 0; c < 3; ++c) {
        colours[c] = part_of_light(CORNER_4(c, MOKA_COLOUR_0_AT));
    }
    surface_colour = colours * at.here;
#endif
}
