// A pixel of a panel: sRGB-encoded, as the display behind it.

uniform sampler2D glyphs;

in vec2 place;
in vec2 texel;
in vec4 tint;
flat in vec4 bounds;

out vec4 display;

void main() {
    if (any(lessThan(place, bounds.xy))
        || any(greaterThanEqual(place, bounds.zw))) discard;
    display = tint * texture(glyphs, texel);
}
