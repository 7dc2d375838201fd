"""The GL entry points that ModernGL has no words for, through ctypes.

ModernGL makes the context and the buffers. It cannot attach a cube face or a
mip level to a framebuffer, give a texture its levels one by one, mirror a
wrap, draw with a base instance or begin to link a program without waiting for
it, and it holds Python's lock in every call. A call through
``ctypes.CFUNCTYPE`` releases the lock, so that decoding threads run on while
the driver copies a texture or compiles. All such calls stand here.
"""

from collections.abc import Callable
from ctypes import (
    addressof,
    c_double,
    c_float,
    c_int,
    c_ssize_t,
    c_ubyte,
    c_uint,
    c_uint64,
    c_void_p,
    create_string_buffer,
)
from typing import Any

from moka.backend import gl_constants as c

__all__ = ["Functions"]

_INT = c_int
_UINT = c_uint
_SIZE = c_ssize_t
_POINTER = c_void_p
_FLOAT = c_float
_DOUBLE = c_double
_BOOL = c_ubyte

# Name without its gl prefix: result type, argument types.
_SIGNATURES: dict[str, tuple[Any, ...]] = {
    "ActiveTexture": (None, _UINT),
    "AttachShader": (None, _UINT, _UINT),
    "BindBuffer": (None, _UINT, _UINT),
    "BindBufferBase": (None, _UINT, _UINT, _UINT),
    "BindBufferRange": (None, _UINT, _UINT, _UINT, _SIZE, _SIZE),
    "BindFramebuffer": (None, _UINT, _UINT),
    "BindSampler": (None, _UINT, _UINT),
    "BindTexture": (None, _UINT, _UINT),
    "BindVertexArray": (None, _UINT),
    "BlendEquation": (None, _UINT),
    "BlendEquationSeparate": (None, _UINT, _UINT),
    "BlendEquationSeparatei": (None, _UINT, _UINT, _UINT),
    "BlendFuncSeparate": (None, _UINT, _UINT, _UINT, _UINT),
    "BlendFuncSeparatei": (None, *[_UINT] * 5),
    "BlitFramebuffer": (None, *[_INT] * 8, _UINT, _UINT),
    "BufferData": (None, _UINT, _SIZE, _POINTER, _UINT),
    "BufferSubData": (None, _UINT, _SIZE, _SIZE, _POINTER),
    "CheckFramebufferStatus": (_UINT, _UINT),
    "ClearBufferfv": (None, _UINT, _INT, _POINTER),
    "ClearBufferuiv": (None, _UINT, _INT, _POINTER),
    "ClipControl": (None, _UINT, _UINT),
    "ClientWaitSync": (_UINT, _POINTER, _UINT, c_uint64),
    "ColorMask": (None, _BOOL, _BOOL, _BOOL, _BOOL),
    "ColorMaski": (None, _UINT, _BOOL, _BOOL, _BOOL, _BOOL),
    "CompileShader": (None, _UINT),
    "CompressedTexImage2D": (
        None,
        _UINT,
        _INT,
        _UINT,
        _INT,
        _INT,
        _INT,
        _INT,
        _POINTER,
    ),
    "CreateProgram": (_UINT,),
    "CreateShader": (_UINT, _UINT),
    "CullFace": (None, _UINT),
    "DeleteBuffers": (None, _INT, _POINTER),
    "DeleteFramebuffers": (None, _INT, _POINTER),
    "DeleteProgram": (None, _UINT),
    "DeleteQueries": (None, _INT, _POINTER),
    "DeleteSamplers": (None, _INT, _POINTER),
    "DeleteShader": (None, _UINT),
    "DeleteSync": (None, _POINTER),
    "DeleteTextures": (None, _INT, _POINTER),
    "DeleteVertexArrays": (None, _INT, _POINTER),
    "DepthFunc": (None, _UINT),
    "DepthMask": (None, _BOOL),
    "DepthRange": (None, _DOUBLE, _DOUBLE),
    "DetachShader": (None, _UINT, _UINT),
    "Disable": (None, _UINT),
    "Disablei": (None, _UINT, _UINT),
    "DrawArraysInstanced": (None, _UINT, _INT, _INT, _INT),
    "DrawBuffers": (None, _INT, _POINTER),
    "DrawElementsInstancedBaseVertex": (
        None,
        _UINT,
        _INT,
        _UINT,
        _POINTER,
        _INT,
        _INT,
    ),
    "Enable": (None, _UINT),
    "Enablei": (None, _UINT, _UINT),
    "EnableVertexAttribArray": (None, _UINT),
    "FenceSync": (_POINTER, _UINT, _UINT),
    "Finish": (None,),
    "FramebufferTexture2D": (None, _UINT, _UINT, _UINT, _UINT, _INT),
    "FrontFace": (None, _UINT),
    "GenBuffers": (None, _INT, _POINTER),
    "GenFramebuffers": (None, _INT, _POINTER),
    "GenQueries": (None, _INT, _POINTER),
    "GenSamplers": (None, _INT, _POINTER),
    "GenTextures": (None, _INT, _POINTER),
    "GenVertexArrays": (None, _INT, _POINTER),
    "GenerateMipmap": (None, _UINT),
    "GetActiveAttrib": (None, _UINT, _UINT, _INT, *[_POINTER] * 4),
    "GetActiveUniformBlockName": (
        None,
        _UINT,
        _UINT,
        _INT,
        _POINTER,
        _POINTER,
    ),
    "GetActiveUniformBlockiv": (None, _UINT, _UINT, _UINT, _POINTER),
    "GetActiveUniformName": (None, _UINT, _UINT, _INT, _POINTER, _POINTER),
    "GetActiveUniformsiv": (None, _UINT, _INT, _POINTER, _UINT, _POINTER),
    "GetAttribLocation": (_INT, _UINT, _POINTER),
    "GetBooleani_v": (None, _UINT, _UINT, _POINTER),
    "GetBufferSubData": (None, _UINT, _SIZE, _SIZE, _POINTER),
    "GetDoublev": (None, _UINT, _POINTER),
    "GetInteger64i_v": (None, _UINT, _UINT, _POINTER),
    "GetIntegeri_v": (None, _UINT, _UINT, _POINTER),
    "GetIntegerv": (None, _UINT, _POINTER),
    "GetProgramInfoLog": (None, _UINT, _INT, _POINTER, _POINTER),
    "GetProgramiv": (None, _UINT, _UINT, _POINTER),
    "GetQueryObjectiv": (None, _UINT, _UINT, _POINTER),
    "GetQueryObjectui64v": (None, _UINT, _UINT, _POINTER),
    "GetShaderInfoLog": (None, _UINT, _INT, _POINTER, _POINTER),
    "GetShaderiv": (None, _UINT, _UINT, _POINTER),
    "GetTexImage": (None, _UINT, _INT, _UINT, _UINT, _POINTER),
    "GetUniformLocation": (_INT, _UINT, _POINTER),
    "IsEnabled": (_BOOL, _UINT),
    "IsEnabledi": (_BOOL, _UINT, _UINT),
    "LinkProgram": (None, _UINT),
    "MultiDrawArraysIndirect": (None, _UINT, _POINTER, _INT, _INT),
    "MultiDrawElementsIndirect": (
        None,
        _UINT,
        _UINT,
        _POINTER,
        _INT,
        _INT,
    ),
    "PixelStorei": (None, _UINT, _INT),
    "PolygonMode": (None, _UINT, _UINT),
    "QueryCounter": (None, _UINT, _UINT),
    "ReadBuffer": (None, _UINT),
    "ReadPixels": (None, *[_INT] * 4, _UINT, _UINT, _POINTER),
    "SamplerParameterf": (None, _UINT, _UINT, _FLOAT),
    "SamplerParameteri": (None, _UINT, _UINT, _INT),
    "Scissor": (None, _INT, _INT, _INT, _INT),
    "ShaderSource": (None, _UINT, _INT, _POINTER, _POINTER),
    "TexBuffer": (None, _UINT, _UINT, _UINT),
    "TexImage2D": (
        None,
        _UINT,
        _INT,
        _INT,
        _INT,
        _INT,
        _INT,
        _UINT,
        _UINT,
        _POINTER,
    ),
    "TexImage2DMultisample": (
        None,
        _UINT,
        _INT,
        _UINT,
        _INT,
        _INT,
        _BOOL,
    ),
    "TexParameteri": (None, _UINT, _UINT, _INT),
    "Uniform1i": (None, _INT, _INT),
    "UniformBlockBinding": (None, _UINT, _UINT, _UINT),
    "UseProgram": (None, _UINT),
    "VertexAttribDivisor": (None, _UINT, _UINT),
    "VertexAttribIPointer": (None, _UINT, _INT, _UINT, _INT, _POINTER),
    "VertexAttribPointer": (
        None,
        _UINT,
        _INT,
        _UINT,
        _BOOL,
        _INT,
        _POINTER,
    ),
    "Viewport": (None, _INT, _INT, _INT, _INT),
}


class Functions:
    """GL functions as attributes without their prefix: ``gl.Finish()``.

    ``load`` returns the ctypes function of an entry point; see
    :meth:`moka.backend.contexts.GraphicsContext.function`.
    """

    def __init__(self, load: Callable[..., Any]) -> None:
        self._load = load

    def __getattr__(self, name: str) -> Any:
        signature = _SIGNATURES.get(name)
        if signature is None:
            raise AttributeError(name)
        function = self._load("gl" + name, *signature)
        setattr(self, name, function)
        return function

    def make(self, kind: str) -> int:
        """The name of one new object: ``make("Textures")``."""
        name = c_uint()
        getattr(self, "Gen" + kind)(1, addressof(name))
        return name.value

    def parameter(self, kind: str, name: int, what: int) -> int:
        """What a ``Program`` or ``Shader`` is; waits until it is known."""
        value = c_int()
        getattr(self, f"Get{kind}iv")(name, what, addressof(value))
        return value.value

    def log(self, kind: str, name: int) -> str:
        """What the driver has to say of a ``Program`` or ``Shader``."""
        size = self.parameter(kind, name, c.INFO_LOG_LENGTH) + 1
        text = create_string_buffer(size)
        getattr(self, f"Get{kind}InfoLog")(name, size, None, addressof(text))
        return text.value.decode("utf-8", "replace")

    def is_available(self, query: int) -> bool:
        """Whether the result of a query can be had without waiting."""
        value = c_int()
        self.GetQueryObjectiv(query, c.QUERY_RESULT_AVAILABLE, addressof(value))
        return bool(value.value)

    def query_result(self, query: int) -> int:
        """The result of a query; waits for it."""
        value = c_uint64()
        self.GetQueryObjectui64v(query, c.QUERY_RESULT, addressof(value))
        return value.value

    def delete(self, kind: str, name: int) -> None:
        """Delete one object: ``delete("Textures", name)``."""
        getattr(self, "Delete" + kind)(1, addressof(c_uint(name)))
