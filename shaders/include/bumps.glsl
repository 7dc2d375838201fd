// The roughness of bumps that are too small for a pixel.

#ifdef MOKA_NORMAL_VARIANCE

// Perceptual roughness with what the level of the normal map averages, as
// moka.core.normal_levels has stored it in the alpha. Where roughness has a
// texture that goes along with the normals, it is part of that already.
float roughness_with_bumps(float roughness, MaterialsRow row) {
    float spread = 1.0 - read_texture(normal_texture, normal_uv(row)).a;
    float alpha = roughness * roughness;
    return sqrt(sqrt(min(alpha * alpha + spread * spread, 1.0)));
}

#endif
