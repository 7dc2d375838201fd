// The transfer functions of sRGB: IEC 61966-2-1, piecewise.

// Linear light to encoded values, to 1.5e-6; negative light has no code and
// becomes 0, light above 1 some code above 1.
//
// 1.055 x^(1 / 2.4) - 0.055 as the polynomial of its degree in the fourth root
// of x whose largest error is smallest (tests/support/oracles/minimax.py),
// in less time than a power takes.
vec3 srgb_encode(vec3 linear) {
    vec3 light = max(linear, 0.0);
    vec3 root = sqrt(sqrt(light));
    vec3 curve = 0.0682079800 * root - 0.318415996;
    curve = curve * root + 0.657188295;
    curve = curve * root - 0.852957457;
    curve = curve * root + 1.36592105;
    curve = curve * root + 0.139604135;
    curve = curve * root - 0.0595466087;
    return mix(curve, 12.92 * light, lessThanEqual(light, vec3(0.0031308)));
}

// Encoded values to linear light.
vec3 srgb_decode(vec3 encoded) {
    vec3 code = max(encoded, 0.0);
    vec3 curve = pow((code + 0.055) / 1.055, vec3(2.4));
    return mix(curve, code / 12.92, lessThanEqual(code, vec3(0.04045)));
}
