// Adds a frame's radiance to that of its batch (the blend does the adding).

uniform sampler2D radiance_map;  // read texel by texel at gl_FragCoord

out vec4 sum;

void main() {
    sum = texelFetch(radiance_map, ivec2(gl_FragCoord.xy), 0);
}
