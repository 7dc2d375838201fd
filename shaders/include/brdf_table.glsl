// Where the table of the specular lobe's directional albedo keeps an entry.
//
// Both axes end at the centres of texels, so that filtering reaches n.v = 1
// and roughness 1 and 0: with a cell for each texel the last half of one
// would be cut off, and a rough metal seen face-on be 1.6 % too dark.

vec2 table_place(float n_dot_v, float roughness, float size) {
    return (vec2(n_dot_v, roughness) * (size - 1.0) + 0.5) / size;
}

// The n.v and roughness of the texel that is drawn at ``pixel``.
vec2 table_entry(vec2 pixel, float size) {
    return (pixel - 0.5) / (size - 1.0);
}
