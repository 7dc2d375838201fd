// What is seen of an environment by one camera.

layout(std140) uniform Background {
    // Takes (x, y, 0, 1) of clip space to a direction of the environment's
    // own space; any rotation of the environment is part of it.
    mat4 direction_from_clip;
    // x intensity, y level of the map to read, z size of a pixel in clip
    // space, w the angle over which suns are blurred
    vec4 parameters;
#ifdef MOKA_SUN_DISCS
    vec4 sun_discs[MOKA_SUN_DISCS];      // direction, angular radius
    vec4 sun_radiances[MOKA_SUN_DISCS];
#endif
};

// Suns that a vertex shader hands on: with 16 components of others 48 of the
// 60 that OpenGL 3.3 promises. More are read from the block.
#if defined(MOKA_SUN_DISCS) && MOKA_SUN_DISCS <= 4
#define MOKA_FLAT_SUNS
#endif
