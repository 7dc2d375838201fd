"""The errors that a user can cause, all below :class:`MokaError`.

A message is one line that a person can act on: which file, which JSON path
or shader line, what is wrong there and, where it is known, what to do.
"""

__all__ = [
    "CommandError",
    "ContextError",
    "DeviceError",
    "EnvironmentMapError",
    "ImageFileError",
    "ModelError",
    "MokaError",
    "OptionError",
    "ShaderError",
]


class MokaError(Exception):
    """Base of every error that moka raises for a user's input."""


class OptionError(MokaError):
    """An argument or a command-line option has no meaning."""


class ModelError(MokaError):
    """A glTF file is missing, broken or asks for what moka cannot draw."""


class ImageFileError(MokaError):
    """An image file cannot be read or written."""


class EnvironmentMapError(MokaError):
    """An environment map is missing, broken or not equirectangular."""


class ShaderError(MokaError):
    """A shader does not compile or link."""


class CommandError(MokaError):
    """A command, a sort key or a handle is used against its contract."""


class DeviceError(MokaError):
    """The graphics device refuses work: closed, failed or misused."""


class ContextError(MokaError):
    """No OpenGL context can be made."""
