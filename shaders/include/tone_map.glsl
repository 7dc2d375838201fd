// Display rendering: linear Rec.709 radiance to linear display light, 0..1.
//
// MOKA_TONE_MAP_NEUTRAL, _ACES, _AGX, _REINHARD, _EXPONENTIAL; without one
// of them the light is only cut off. The twin for arrays is
// moka.core.tone_map, which a test compares with this file. MOKA_TONE_MAP_STOPS
// is for a person who measures, and has no twin.

#if defined(MOKA_TONE_MAP_NEUTRAL)

// Khronos PBR Neutral Tone Mapper, 2024, version 1.
vec3 tone_curve(vec3 colour) {
    const float start = 0.8 - 0.04;
    const float desaturation = 0.15;
    float x = min(colour.r, min(colour.g, colour.b));
    colour -= x < 0.08 ? x - 6.25 * x * x : 0.04;
    float peak = max(colour.r, max(colour.g, colour.b));
    if (peak < start) return colour;
    const float d = 1.0 - start;
    float compressed = 1.0 - d * d / (peak + d - start);
    float g = 1.0 - 1.0 / (desaturation * (peak - compressed) + 1.0);
    return mix(colour * (compressed / peak), vec3(compressed), g);
}

#elif defined(MOKA_TONE_MAP_ACES)

// Hill 2017, a fit of the reference rendering and output transforms of ACES
// (BakingLab, ACES.hlsl). GLSL matrices are written by columns.
vec3 tone_curve(vec3 colour) {
    const mat3 into_fit = mat3(
        0.59719, 0.07600, 0.02840,
        0.35458, 0.90834, 0.13383,
        0.04823, 0.01566, 0.83777);
    const mat3 from_fit = mat3(
        1.60475, -0.10208, -0.00327,
        -0.53108, 1.10813, -0.07276,
        -0.07367, -0.00605, 1.07602);
    vec3 v = into_fit * colour;
    vec3 a = v * (v + 0.0245786) - 0.000090537;
    vec3 b = v * (0.983729 * v + 0.4329510) + 0.238081;
    return from_fit * (a / b);
}

#elif defined(MOKA_TONE_MAP_AGX)

// Sobotka's AgX as fitted by Wrensch 2023, "Minimal AgX Implementation": a
// polynomial of degree 6 for the default contrast, no look.
vec3 tone_curve(vec3 colour) {
    const mat3 inset = mat3(
        0.842479062253094, 0.0423282422610123, 0.0423756549057051,
        0.0784335999999992, 0.878468636469772, 0.0784336,
        0.0792237451477643, 0.0791661274605434, 0.879142973793104);
    const mat3 outset = mat3(
        1.19687900512017, -0.0528968517574562, -0.0529716355144438,
        -0.0980208811401368, 1.15190312990417, -0.0980434501171241,
        -0.0990297440797205, -0.0989611768448433, 1.15107367264116);
    const float darkest = -12.47393;
    const float brightest = 4.026069;
    // 1e-10 lies below the darkest stop and keeps log2(0) away.
    vec3 v = clamp(log2(max(inset * colour, 1e-10)), darkest, brightest);
    v = (v - darkest) / (brightest - darkest);
    vec3 v2 = v * v;
    vec3 v4 = v2 * v2;
    v = 15.5 * v4 * v2 - 40.14 * v4 * v + 31.96 * v4 - 6.868 * v2 * v
        + 0.4298 * v2 + 0.1191 * v - 0.00232;
    // The curve ends in values encoded with a power of 2.2.
    return pow(max(outset * v, 0.0), vec3(2.2));
}

#elif defined(MOKA_TONE_MAP_REINHARD)

// Reinhard et al. 2002, equation 3, on each channel.
vec3 tone_curve(vec3 colour) {
    return colour / (1.0 + colour);
}

#elif defined(MOKA_TONE_MAP_EXPONENTIAL)

// The response of film: exposure to density, saturating exponentially.
vec3 tone_curve(vec3 colour) {
    return 1.0 - exp(-colour);
}

#elif defined(MOKA_TONE_MAP_STOPS)

// Luminance in steps of a stop, from blue (1/64) over green (1, of which
// white is 4.5 stops up) to red (16): one colour a stop, edges where it
// doubles. Not encoded: what a display gets is the square here.
vec3 tone_curve(vec3 colour) {
    float luminance = dot(colour, vec3(0.2126, 0.7152, 0.0722));
    float stops = floor(log2(max(luminance, 1e-10)));
    float part = clamp((stops + 6.0) / 10.0, 0.0, 1.0);
    vec3 shade = clamp(
        vec3(2.0 * part - 1.0, 1.0 - abs(2.0 * part - 1.0), 1.0 - 2.0 * part),
        0.0, 1.0);
    shade = 0.15 + 0.85 * shade;
    return shade * shade;
}

#else

vec3 tone_curve(vec3 colour) {
    return colour;
}

#endif

// Every curve has long reached white at 1e9; beyond, some of them would
// divide one infinity by another.
vec3 tone_map(vec3 radiance) {
    return clamp(tone_curve(clamp(radiance, 0.0, 1e9)), 0.0, 1.0);
}
