"""A physically based renderer for glTF scenes, in a window or headless.

``moka.render`` turns a model into an image, ``moka.App`` and ``moka.run``
are for programs with a loop, and the other names are the parts they use.
A name is imported when it is first used (PEP 562), so that ``import moka``
costs a few milliseconds and a headless render never loads a window.
"""

from importlib import import_module

from moka.version import __version__

# Type checkers take this name for true; `typing` itself would cost more
# than the rest of this module.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from moka.app.application import App as App
    from moka.app.application import GameTime as GameTime
    from moka.app.render import render as render
    from moka.app.render_frames import render_frames as render_frames
    from moka.app.run import run as run
    from moka.commands.command_list import CommandList as CommandList
    from moka.core.errors import CommandError as CommandError
    from moka.core.errors import ContextError as ContextError
    from moka.core.errors import DeviceError as DeviceError
    from moka.core.errors import EnvironmentMapError as EnvironmentMapError
    from moka.core.errors import ImageFileError as ImageFileError
    from moka.core.errors import ModelError as ModelError
    from moka.core.errors import MokaError as MokaError
    from moka.core.errors import OptionError as OptionError
    from moka.core.errors import ShaderError as ShaderError
    from moka.core.image import Image as Image
    from moka.graphics.device import GraphicsDevice as GraphicsDevice
    from moka.lighting.environment import Environment as Environment
    from moka.lighting.environment import Sun as Sun
    from moka.lighting.environment import load_environment as load_environment
    from moka.material.material import Material as Material
    from moka.model import Model as Model
    from moka.model import load_model as load_model
    from moka.model import save_model as save_model
    from moka.model.animation import Animation as Animation
    from moka.model.animation import AnimationChannel as AnimationChannel
    from moka.model.animation import AnimationTarget as AnimationTarget
    from moka.model.animation import Interpolation as Interpolation
    from moka.model.skins import Skin as Skin
    from moka.renderer.quality import settings_of_quality as settings_of_quality
    from moka.renderer.renderer import Renderer as Renderer
    from moka.renderer.settings import RenderSettings as RenderSettings
    from moka.scene.animation_player import AnimationPlayer as AnimationPlayer
    from moka.scene.animation_player import Playback as Playback
    from moka.scene.camera import Camera as Camera
    from moka.scene.morph_weights import MorphWeights as MorphWeights
    from moka.scene.scene import Scene as Scene
    from moka.scene.scene_model import SceneModel as SceneModel
    from moka.scene.transform import Transform as Transform

__all__ = [
    "Animation",
    "AnimationChannel",
    "AnimationPlayer",
    "AnimationTarget",
    "App",
    "Camera",
    "CommandError",
    "CommandList",
    "ContextError",
    "DeviceError",
    "Environment",
    "EnvironmentMapError",
    "GameTime",
    "GraphicsDevice",
    "Image",
    "ImageFileError",
    "Interpolation",
    "Material",
    "Model",
    "ModelError",
    "MokaError",
    "MorphWeights",
    "OptionError",
    "Playback",
    "RenderSettings",
    "Renderer",
    "Scene",
    "SceneModel",
    "ShaderError",
    "Skin",
    "Sun",
    "Transform",
    "__version__",
    "load_environment",
    "load_model",
    "render",
    "render_frames",
    "run",
    "save_model",
    "settings_of_quality",
]

_HOMES = {
    "Animation": "moka.model.animation",
    "AnimationChannel": "moka.model.animation",
    "AnimationPlayer": "moka.scene.animation_player",
    "AnimationTarget": "moka.model.animation",
    "App": "moka.app.application",
    "Camera": "moka.scene.camera",
    "CommandError": "moka.core.errors",
    "CommandList": "moka.commands.command_list",
    "ContextError": "moka.core.errors",
    "DeviceError": "moka.core.errors",
    "Environment": "moka.lighting.environment",
    "EnvironmentMapError": "moka.core.errors",
    "GameTime": "moka.app.application",
    "GraphicsDevice": "moka.graphics.device",
    "Image": "moka.core.image",
    "ImageFileError": "moka.core.errors",
    "Interpolation": "moka.model.animation",
    "Material": "moka.material.material",
    "Model": "moka.model",
    "ModelError": "moka.core.errors",
    "MokaError": "moka.core.errors",
    "MorphWeights": "moka.scene.morph_weights",
    "OptionError": "moka.core.errors",
    "Playback": "moka.scene.animation_player",
    "RenderSettings": "moka.renderer.settings",
    "Renderer": "moka.renderer.renderer",
    "Scene": "moka.scene.scene",
    "SceneModel": "moka.scene.scene_model",
    "ShaderError": "moka.core.errors",
    "Skin": "moka.model.skins",
    "Sun": "moka.lighting.environment",
    "Transform": "moka.scene.transform",
    "load_environment": "moka.lighting.environment",
    "load_model": "moka.model",
    "render": "moka.app.render",
    "render_frames": "moka.app.render_frames",
    "run": "moka.app.run",
    "save_model": "moka.model",
    "settings_of_quality": "moka.renderer.quality",
}


if not TYPE_CHECKING:  # or a checker would accept any name at all

    def __getattr__(name: str) -> object:
        home = _HOMES.get(name)
        if home is None:
            raise AttributeError(f"module 'moka' has no attribute {name!r}")
        value = getattr(import_module(home), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
