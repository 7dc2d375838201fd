// The environment behind the scene.

#include "include/background.glsl"

out vec4 colour;

void main() {
    colour = vec4(background_radiance(), 1.0);
}
