// Where the light goes that one reflection does not account for, and what an
// interface lets through.
//
// A table entry is (scale, bias) of brdf_table.frag for the view direction:
// the specular lobe reflects f0 scale + f90 bias of uniform light, and
// scale + bias if nothing is absorbed. Both functions depend on the view
// alone, so lights and environments share them: a sun has the same effect
// in the map and as a light, a white metal under uniform light returns
// exactly 1, and a dielectric never more than 1 if its base does not.

// The part of uniform light that the specular lobe reflects.
vec3 specular_albedo(vec3 f0, vec3 f90, vec2 table) {
    return f0 * table.x + f90 * table.y;
}

// Turquin 2019, "Practical multiple scattering compensation for microfacet
// models", equation 16: a factor for the specular lobe. Blinn-Phong has no
// microfacets between which light could bounce.
vec3 multiscatter_scale(vec3 f0, vec2 table) {
#if defined(MOKA_MULTISCATTER) && !defined(MOKA_BRDF_BLINN_PHONG)
    return 1.0 + f0 * (1.0 / (table.x + table.y) - 1.0);
#else
    return vec3(1.0);
#endif
}

// What a dielectric's interface, which reflects ``specular`` of uniform
// light, lets through to the diffuse base: albedo scaling after Kulla and
// Conty 2017. The 1 - F(v.h) of glTF 2.0 appendix B would return up to 1.9
// of the light at grazing angles. One channel decides for all, so that a
// coloured interface does not tint the base with its complement.
float diffuse_share(vec3 specular) {
    return 1.0 - max(max(specular.r, specular.g), specular.b);
}

// The mean over uniform light, weighted n.l / pi, of Schlick's (1 - v.h)^5:
// what the 1 - F(v.h) of glTF 2.0 appendix B takes from a Lambertian base.
// Fitted to the integral, within 1.1e-5.
float mean_fresnel_power(float n_dot_v) {
    float x = 1.0 - n_dot_v;
    return 8.3e-5 + x * (0.00200778455 + x * (0.00938194628
        + x * (0.00767217648 + x * 0.00902114488)));
}
