// Which triangle is seen: vertices of a model's surface, and nothing else of
// them but where they are. The block Frame is injected.

#include "include/instance.glsl"

in vec3 position;
// The row of the instance, shifted to the bits that it has.
flat out uint visible_instance;

void main() {
    visible_instance = instance_data.z;
    vec3 world = place_point(instance_rows(), position);
    gl_Position = clip_from_world * vec4(world, 1.0);
    // What lies in the far plane is nearer than nothing, which has depth 0.
    gl_Position.z += 1e-37 * gl_Position.w;
}
