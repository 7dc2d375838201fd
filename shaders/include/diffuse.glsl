// Diffuse reflection of a surface of a given colour.
//
// MOKA_DIFFUSE_LAMBERT          the same in every direction (the default)
// MOKA_DIFFUSE_OREN_NAYAR       Portsmouth, Kutz and Hill 2024, "EON: A
//                               practical energy-preserving rough diffuse
//                               BRDF"; its roughness is the material's
// MOKA_DIFFUSE_BURLEY           Burley 2012 as renormalised by Lagarde and
//                               de Rousiers 2014, "Moving Frostbite to PBR";
//                               it reflects up to 1.03 of the light
// MOKA_DIFFUSE_BURLEY_ORIGINAL  Burley 2012; it reflects up to 1.56 of the
//                               light, and is here for comparison
//
// diffuse_brdf is for a light, diffuse_albedo what the same BRDF reflects of
// light that is equal from everywhere: an environment's share of it.

#include "include/angles.glsl"
#include "include/constants.glsl"

#if defined(MOKA_DIFFUSE_OREN_NAYAR)

const float FUJII_A = 0.287793409210806;  // 1/2 - 2/(3 pi)
const float FUJII_AVERAGE = 0.0724882124569231;  // 2/3 - 28/(15 pi)

// EON, listing 2: the albedo of Fujii's single-scattering lobe, fitted; the
// fit exceeds 1, the exact value at grazing angles, by 4e-4.
float fujii_albedo(float cosine, float roughness) {
    float x = 1.0 - cosine;
    float g = x * (0.0571085289 + x * (0.491881867
        + x * (-0.332181442 + x * 0.0714429953)));
    return min((1.0 + roughness * g) / (1.0 + FUJII_A * roughness), 1.0);
}

// EON, equation 15: the colour of light that was reflected more than once.
vec3 fujii_multiple_colour(vec3 colour, float average) {
    return colour * colour * average / (1.0 - colour * (1.0 - average));
}

float fujii_average_albedo(float roughness) {
    return (1.0 + FUJII_AVERAGE * roughness) / (1.0 + FUJII_A * roughness);
}

vec3 diffuse_brdf(Angles angles, vec3 colour, float roughness) {
    float v_dot_l = 2.0 * angles.v_dot_h * angles.v_dot_h - 1.0;
    // Below -1 only where n.v was raised for a view from behind.
    float s = max(v_dot_l - angles.n_dot_l * angles.n_dot_v, -1.0);
    float s_over_t = s > 0.0 ? s / max(angles.n_dot_l, angles.n_dot_v) : s;
    float single =
        (1.0 + roughness * s_over_t) / (1.0 + FUJII_A * roughness);
    float average = fujii_average_albedo(roughness);
    // At roughness 0 nothing is lost; 1e-7 keeps 0 / 0 away.
    float multiple = (1.0 - fujii_albedo(angles.n_dot_v, roughness))
        * (1.0 - fujii_albedo(angles.n_dot_l, roughness))
        / max(1.0 - average, 1e-7);
    return INVERSE_PI * (colour * single
        + fujii_multiple_colour(colour, average) * multiple);
}

vec3 diffuse_albedo(float n_dot_v, vec3 colour, float roughness) {
    float single = fujii_albedo(n_dot_v, roughness);
    vec3 multiple =
        fujii_multiple_colour(colour, fujii_average_albedo(roughness));
    return colour * single + multiple * (1.0 - single);
}

#elif defined(MOKA_DIFFUSE_BURLEY) || defined(MOKA_DIFFUSE_BURLEY_ORIGINAL)

#if defined(MOKA_DIFFUSE_BURLEY_ORIGINAL)
float burley_bias(float roughness) { return 0.5; }
float burley_scale(float roughness) { return 1.0; }
#else
float burley_bias(float roughness) { return 0.5 * roughness; }
float burley_scale(float roughness) {
    return mix(1.0, 1.0 / 1.51, roughness);
}
#endif

float fifth_power(float x) {
    float squared = x * x;
    return squared * squared * x;
}

// Burley 2012, section 5.3: f90 - 1 is bias - 1 + 2 roughness (l.h)^2.
vec3 diffuse_brdf(Angles angles, vec3 colour, float roughness) {
    float rise = burley_bias(roughness) - 1.0
        + 2.0 * roughness * angles.v_dot_h * angles.v_dot_h;
    float light = 1.0 + rise * fifth_power(1.0 - angles.n_dot_l);
    float view = 1.0 + rise * fifth_power(1.0 - angles.n_dot_v);
    return colour * (INVERSE_PI * burley_scale(roughness) * light * view);
}

// The integral of the above over the hemisphere, exactly: with (l.h)^2 =
// (1 + l.v) / 2 it is a polynomial in n.l after the azimuth is done. The
// fractions are moments of (1 - n.l)^5.
vec3 diffuse_albedo(float n_dot_v, vec3 colour, float roughness) {
    float r = roughness;
    float q = burley_bias(r) - 1.0;
    float view = fifth_power(1.0 - n_dot_v);
    float squared = n_dot_v * n_dot_v;
    float of_view = q + r * (1.0 + n_dot_v * (2.0 / 3.0));
    float moment = (1.0 + n_dot_v / 4.0) / 21.0;
    float of_light = q / 21.0 + r * moment;
    float of_both = q * q / 21.0 + 2.0 * q * r * moment
        + r * r * ((1.0 + n_dot_v / 2.0) / 21.0
        + (squared + 5.5 * (1.0 - squared)) / 252.0);
    float albedo = 1.0 + of_light + view * (of_view + of_both);
    return colour * (burley_scale(r) * albedo);
}

#else

vec3 diffuse_brdf(Angles angles, vec3 colour, float roughness) {
    return colour * INVERSE_PI;
}

vec3 diffuse_albedo(float n_dot_v, vec3 colour, float roughness) {
    return colour;
}

#endif
