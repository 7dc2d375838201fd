// Unit vectors from vectors of any length.

float largest_component(vec3 v) {
    return max(max(abs(v.x), abs(v.y)), abs(v.z));
}

// ``v`` with a length of 1; 0 where it has no direction, as with NaN in it.
// In float32 the square of a length below 1e-19 vanishes and that of one
// above 1e19 is infinite, so the length is made about 1 first.
vec3 direction_of(vec3 v) {
    float size = largest_component(v);
    if (!(size > 0.0)) return vec3(0.0);
    vec3 u = v / size;
    float squared = dot(u, u);
    return squared > 0.0 ? u * inversesqrt(squared) : vec3(0.0);
}
