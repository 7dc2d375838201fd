// The transfer functions of sRGB: IEC 61966-2-1, exact and piecewise.

// Linear light to encoded values; negative light has no code and becomes 0.
vec3 srgb_encode(vec3 linear) {
    vec3 light = max(linear, 0.0);
    vec3 curve = 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055;
    return mix(curve, 12.92 * light, lessThanEqual(light, vec3(0.0031308)));
}

// Encoded values to linear light.
vec3 srgb_decode(vec3 encoded) {
    vec3 code = max(encoded, 0.0);
    vec3 curve = pow((code + 0.055) / 1.055, vec3(2.4));
    return mix(curve, code / 12.92, lessThanEqual(code, vec3(0.04045)));
}
