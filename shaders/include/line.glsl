// Lines as quads as wide as the picture's lines: drivers need not have any
// but thin ones, and multisampling smooths the edges of a quad anywhere.

#ifdef MOKA_LINES
in vec4 line_other;  // the other end of the segment, and the side of this one

// An end of a segment that lies behind the camera, moved to just before it,
// where it has a place in the picture. Where w is a distance the part that is
// cut off is a millionth of the segment's reach.
vec4 in_front(vec4 end, vec4 other) {
    float nearest = 1e-6 * max(end.w, other.w);
    if (end.w >= nearest || other.w <= nearest) return end;
    return mix(end, other, (nearest - end.w) / (other.w - end.w));
}

// The corner of the quad at the end `here`, in clip space.
vec4 line_corner(vec4 here, vec4 there) {
    vec4 end = in_front(here, there);
    vec4 other = in_front(there, here);
    vec2 along = picture_size * (other.xy / other.w - end.xy / end.w);
    // A segment without length is as wide as it is long.
    vec2 direction = along / max(length(along), 1e-30);
    vec2 across = line_other.w * vec2(-direction.y, direction.x);
    // Half a width to each side, in a picture of 2 by 2.
    end.xy += across * line_width / picture_size * end.w;
    return end;
}
#endif
