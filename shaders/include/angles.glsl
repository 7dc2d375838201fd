// The cosines between normal, view and light that reflection terms read.

struct Angles {
    float n_dot_v;
    float n_dot_l;
    float n_dot_h;
    float v_dot_h;            // equals l_dot_h
    float n_cross_h_squared;  // |n x h|^2, the sine, exact near the peak
};

// Interpolated and mapped normals can face away from a viewer who sees the
// surface. Such a point is shaded as seen at a grazing angle; the bound also
// keeps every term finite, because no denominator loses both its cosines.
const float MINIMUM_N_DOT_V = 1e-4;

float clamp_n_dot_v(float n_dot_v) {
    return clamp(n_dot_v, MINIMUM_N_DOT_V, 1.0);
}

// n, v and l are unit vectors that point away from the surface. A light
// below the surface has n_dot_l 0, by which the caller multiplies.
Angles angles_between(vec3 n, vec3 v, vec3 l) {
    vec3 sum = v + l;
    float squared = dot(sum, sum);
    // Opposite directions have no half vector. One at a right angle to n
    // stands in for it, where no lobe is bright.
    bool opposite = squared < 1e-10;
    vec3 h = opposite ? vec3(0.0) : sum * inversesqrt(squared);
    vec3 n_cross_h = cross(n, h);

    Angles angles;
    angles.n_dot_v = clamp_n_dot_v(dot(n, v));
    angles.n_dot_l = clamp(dot(n, l), 0.0, 1.0);
    // Negative only for a view from below the surface; 0 in its place could
    // meet a sine of 0, which no direction has.
    angles.n_dot_h = min(abs(dot(n, h)), 1.0);
    angles.v_dot_h = clamp(dot(v, h), 0.0, 1.0);
    angles.n_cross_h_squared =
        opposite ? 1.0 : min(dot(n_cross_h, n_cross_h), 1.0);
    return angles;
}
