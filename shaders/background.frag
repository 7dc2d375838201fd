// The environment behind the scene.

#include "include/background.glsl"

in vec2 uv;
out vec4 colour;

void main() {
    colour = vec4(background_radiance(uv), 1.0);
}
