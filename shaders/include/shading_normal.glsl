// The normal that light meets: interpolated or flat, then normal mapped.

#include "include/direction.glsl"
#include "include/surface_point.glsl"

// Towards the viewer.
vec3 surface_view() {
    return direction_of(eye.xyz - surface_position * eye.w);
}

// The plane of the triangle itself, towards the viewer: for right-handed
// window coordinates this is the order of the product.
vec3 facing_normal() {
    vec3 n = direction_of(cross(
        direction_of(position_across()),
        direction_of(position_up())));
    // A triangle seen exactly edge on, or a point, has no plane.
    return n == vec3(0.0) ? surface_view() : n;
}

// The geometric normal on the front side of the surface.
vec3 front_normal() {
#ifdef MOKA_VERTEX_NORMAL
    float squared = dot(surface_normal, surface_normal);
    if (squared > 0.0) return surface_normal * inversesqrt(squared);
#endif
    return FRONT_FACING ? facing_normal() : -facing_normal();
}

#ifdef MOKA_NORMAL_TEXTURE

// The frame that MikkTSpace gives to a triangle by itself, from screen-space
// derivatives of position and texture coordinate: how the place moves with u,
// across the normal, and at right angles to both. Mikkelsen 2008, "Simulation
// of Wrinkled Surfaces Revisited". glTF's y points up in the image and v
// down, hence the minus. For what moves its vertices or its coordinates, and
// for triangles that have no normals.
mat3 tangent_frame(vec3 n, TEXTURE_PLACE uv) {
    vec3 dp1 = position_across();
    vec3 dp2 = position_up();
    vec2 duv1 = place_across(uv);
    vec2 duv2 = place_up(uv);
    // Only ratios matter, while products of what is as small or as large as
    // it gets would vanish or be infinite.
    float size = max(largest_component(dp1), largest_component(dp2));
    dp1 /= max(size, 1e-37);
    dp2 /= max(size, 1e-37);
    size = largest_component(vec3(max(abs(duv1), abs(duv2)), 1e-37));
    duv1 /= size;
    duv2 /= size;
    // Both are times the area that the coordinates cover, with its sign.
    vec3 t = dp1 * duv2.y - dp2 * duv1.y;
    vec3 b = dp1 * duv2.x - dp2 * duv1.x;
    float side = duv1.x * duv2.y < duv1.y * duv2.x ? -1.0 : 1.0;
    t = direction_of(side * (t - n * dot(n, t)));
    // Degenerate coordinates: no direction to bend the normal in.
    vec3 up = cross(n, t);
    return mat3(t, side * dot(up, b) < 0.0 ? -up : up, n);
}

TEXTURE_PLACE normal_uv(MaterialsRow row) {
    TEXTURE_PLACE uv = UV_OF_SET(MOKA_NORMAL_UV);
#ifdef MOKA_NORMAL_TRANSFORM
    uv = transformed(uv, row.normal_transform);
#endif
    return uv;
}

vec3 mapped_normal(vec3 n, MaterialsRow row) {
    TEXTURE_PLACE uv = normal_uv(row);
    vec3 texel = read_texture(normal_texture, uv).xyz * 2.0 - 1.0;
    texel.xy *= row.normal_scale;
#ifdef MOKA_VERTEX_TANGENT
    // As MikkTSpace bakes it: the frame is interpolated, not made
    // orthogonal again.
    vec3 t = surface_tangent.xyz;
    vec3 b = cross(n, t) * surface_tangent.w;
    vec3 mapped = mat3(t, b, n) * texel;
#else
    vec3 mapped = tangent_frame(n, uv) * texel;
#endif
    float squared = dot(mapped, mapped);
    return squared > 0.0 ? mapped * inversesqrt(squared) : n;
}

#endif

// Unit length; on the side of the surface that is seen.
vec3 shading_normal(MaterialsRow row) {
    vec3 n = front_normal();
#ifdef MOKA_NORMAL_TEXTURE
    n = mapped_normal(n, row);
#endif
    // glTF 2.0, 3.9.7: back faces of a double-sided material are lit with
    // the normal reversed.
    return FRONT_FACING ? n : -n;
}
