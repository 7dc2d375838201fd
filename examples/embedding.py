"""moka inside another ModernGL program, in its context and on its thread.

    python examples/embedding.py

The program draws a striped wall, shows a scene of moka in front of it, and
draws a frame over both. It binds nothing anew after moka has drawn: state
that it has set once holds for all of its own draws.
"""

import moderngl
import numpy as np

import moka
from moka.model import demo_model

VERTEX = """#version 330 core
in vec2 corner;
out vec2 position;

void main() {
    position = corner;
    gl_Position = vec4(corner, 0.0, 1.0);
}
"""

WALL = """#version 330 core
in vec2 position;
out vec4 colour;

void main() {
    float stripe = step(0.5, fract(6.0 * (position.x + position.y)));
    colour = vec4(mix(vec3(0.1, 0.2, 0.4), vec3(0.9, 0.6, 0.2), stripe), 1.0);
}
"""

# Shows a texture where it covers, and a frame around the picture.
FRONT = """#version 330 core
uniform sampler2D scene;
in vec2 position;
out vec4 colour;

void main() {
    bool frame = max(abs(position.x), abs(position.y)) > 0.95;
    vec4 texel = texture(scene, 0.5 * position + 0.5);
    colour = frame ? vec4(0.0, 0.0, 0.0, 1.0) : texel;
}
"""

CORNERS = np.array([[-1, -1], [1, -1], [-1, 1], [1, 1]], np.float32)


class Host:
    """A small program in ModernGL that knows nothing of moka."""

    def __init__(self, size: tuple[int, int]) -> None:
        self.context = moderngl.create_standalone_context(backend="egl")
        corners = self.context.buffer(CORNERS)
        self.wall, self.front = (
            self.context.vertex_array(
                self.context.program(
                    vertex_shader=VERTEX, fragment_shader=fragment
                ),
                [(corners, "2f", "corner")],
                mode=moderngl.TRIANGLE_STRIP,
            )
            for fragment in (WALL, FRONT)
        )
        self.screen = self.context.simple_framebuffer(size)
        # What somebody else may draw into.
        self.scene = self.context.texture(size, 4)
        self.scene_target = self.context.framebuffer([self.scene])
        # Set once, for all frames.
        self.context.enable(moderngl.BLEND)
        over = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        self.context.blend_func = *over, moderngl.ONE, over[1]
        self.scene.use(0)

    def draw(self) -> None:
        """The wall, and before it what the texture holds."""
        self.screen.use()
        self.wall.render()
        self.front.render()


def render(size: tuple[int, int] = (640, 360)) -> moka.Image:
    """A frame of the program, with moka's scene in it."""
    width, height = size
    host = Host(size)
    scene, camera = moka.Scene(), moka.Camera()
    scene.add(demo_model())
    scene.environment = moka.load_environment("studio")
    scene.background = "transparent"
    camera.frame(scene.bounds(), width / height)

    with moka.GraphicsDevice.embed(host.context) as device:
        # "To window" is into the framebuffer that the program has bound.
        renderer = moka.Renderer(device, size, to_window=True)
        host.scene_target.use()
        commands = moka.CommandList()
        renderer.draw(scene, camera, commands)
        device.submit(commands)
        renderer.close()
        host.draw()

    rows = np.frombuffer(host.screen.read(components=4), np.uint8)
    host.context.release()
    display = rows.reshape(height, width, 4)[::-1]  # the bottom row is first
    return moka.Image(None, display=display)


if __name__ == "__main__":
    render().save("embedding.png")
