"""Shader source: includes, defines, and driver errors that name a file.

GLSL has no ``#include``; this preprocessor adds it, each file once. It also
writes ``#line`` directives, so that a driver's complaint can be traced back
to the file a person has to edit.

Drivers disagree about the second number of ``#line``, the file: Mesa drops
it from every semantic error. So the file is carried in the line number too:
line 17 of file 2 is line 20017 to the driver, and :func:`explain_log` reads
both back from there.
"""

import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType

from moka.commands.descriptors import ShaderText
from moka.core.errors import ShaderError
from moka.core.resources import shader_folder

__all__ = ["explain_log", "forget_shaders", "load_shader", "preprocess_shader"]

LINES_PER_FILE = 10_000

_NO_DEFINES: Mapping[str, str | int] = MappingProxyType({})
_INCLUDE = re.compile(r'\s*#\s*include\b\s*(?:"([^"]+)"\s*(?://.*)?$)?')
_CONDITION = re.compile(r"\s*#\s*(if|ifdef|ifndef|endif)\b")
_DEFINE_NAME = re.compile(r"MOKA_[A-Z0-9_]+")

# "0:12(5): error: text" is Mesa's form, "0(12) : error C1008: text" is
# NVIDIA's, "ERROR: 0:12: text" that of AMD, Apple and Intel's own driver.
_MESSAGES = (
    re.compile(r"\d+:(\d+)\(\d+\): (?:preprocessor )?error: (.*)"),
    re.compile(r"\d+\((\d+)\) : (?:fatal )?error (?:\w+: )?(.*)"),
    re.compile(r"ERROR: \d+:(\d+): (.*)"),
)

# Above what NVIDIA's linker says of the vertex or of the fragment shader.
_HEADINGS = {"Vertex info": 0, "Fragment info": -1}


def load_shader(
    name: str,
    defines: Mapping[str, str | int] = _NO_DEFINES,
    *,
    injected: str = "",
    version: int = 330,
    folder: Path | None = None,
) -> ShaderText:
    """Read shader ``name`` and everything it includes.

    The text begins with ``#version``, then one ``#define`` for each of
    ``defines`` in sorted order, so that equal permutations are equal texts,
    then ``injected``, GLSL that was generated. Names, also those in
    ``#include "include/srgb.glsl"``, are relative to ``folder``, by default
    the folder of moka's own shaders.

    Raises ShaderError, naming file and line, for a file that cannot be
    read, files that include each other, an ``#include`` that depends on a
    condition (a later one would be skipped as already done) and defines
    that are not named ``MOKA_...`` or do not fit on a line.
    """
    reader = _Reader(folder or shader_folder(), name)
    head = _head(name, defines, injected, version)
    return reader.text(head, reader.expand(name, reader.lines(name)))


def preprocess_shader(
    source: str,
    defines: Mapping[str, str | int] = _NO_DEFINES,
    *,
    name: str = "inline shader",
    injected: str = "",
    version: int = 330,
    folder: Path | None = None,
) -> ShaderText:
    """As :func:`load_shader`, for a ``source`` in memory.

    ``name`` stands for it in messages; its includes are files.
    """
    reader = _Reader(folder or shader_folder(), name)
    head = _head(name, defines, injected, version)
    lines = tuple(source.splitlines())
    return reader.text(head, reader.expand(name, lines))


def explain_log(log: str, *texts: ShaderText) -> str:
    """The first error in a driver's ``log`` as ``file:line: message``.

    ``texts`` are the shaders that the log is about: one, or the vertex and
    the fragment shader of a program that does not link. An error without a
    line, as linkers give, is reported for the shader, or both, as a whole.
    Never more than one line; the log itself holds the rest.
    """
    about = texts
    whole = []
    for line in filter(None, map(str.strip, log.splitlines())):
        if line in _HEADINGS:
            about = (texts[_HEADINGS[line]],)
            continue
        found = (pattern.match(line) for pattern in _MESSAGES)
        match = next(filter(None, found), None)
        if match and len(about) == 1:
            return f"{_position(int(match[1]), about[0])}: {match[2]}"
        whole.append((about, line))
    errors = [each for each in whole if "error" in each[1].lower()]
    nothing = (texts, "failed without a message")
    about, message = (errors or whole or [nothing])[0]
    # Two texts of one file, or of none, have one name.
    names = dict.fromkeys(
        text.files[1] if len(text.files) > 1 else "shader" for text in about
    )
    return f"{' and '.join(names)}: {message.removeprefix('error: ')}"


def _position(line: int, text: ShaderText) -> str:
    file, line_in_file = divmod(line, LINES_PER_FILE)
    if file < len(text.files):
        return f"{text.files[file]}:{line_in_file}"
    return f"line {line}"


def _head(
    shader: str,
    defines: Mapping[str, str | int],
    injected: str,
    version: int,
) -> list[str]:
    return [
        f"#version {version} core",
        *(_define(shader, *item) for item in sorted(defines.items())),
        *injected.splitlines(),
    ]


def _define(shader: str, name: str, value: str | int) -> str:
    if not _DEFINE_NAME.fullmatch(name):
        raise ShaderError(
            f"{shader}: #define {name!r}: call it MOKA_..., in capitals"
        )
    # Booleans are integers in Python and GLSL has no word True.
    word = value if isinstance(value, str) else str(int(value))
    if "\n" in word or word.endswith("\\"):
        raise ShaderError(
            f"{shader}: #define {name}: the value {word!r} spans lines"
        )
    return f"#define {name} {word}".rstrip()


class _Reader:
    """Expands one shader; ``files[n]`` is the file of source number n."""

    def __init__(self, folder: Path, name: str) -> None:
        self._folder = folder
        self.files = [f"{name} (generated head)"]

    def text(self, head: list[str], body: Iterator[str]) -> ShaderText:
        source = "\n".join([*head, *body]) + "\n"
        return ShaderText(source, tuple(self.files))

    def expand(
        self, name: str, lines: tuple[str, ...], opened: tuple[str, ...] = ()
    ) -> Iterator[str]:
        """The ``lines`` of ``name`` and, in their place, its includes."""
        number = len(self.files)
        self.files.append(name)
        depth = 0
        yield self._line_directive(number, 1)
        for count, line in enumerate(lines, start=1):
            if "#" not in line:
                yield line
                continue
            if condition := _CONDITION.match(line):
                depth += -1 if condition[1] == "endif" else 1
            include = _INCLUDE.match(line)
            if include is None:
                yield line
                continue
            here = f"{name}:{count}"
            chain = (*opened, name)
            self._check_include(include[1], depth, chain, here)
            if include[1] not in self.files:
                included = self.lines(include[1], here)
                yield from self.expand(include[1], included, chain)
            yield self._line_directive(number, count + 1)

    def lines(self, name: str, where: str = "") -> tuple[str, ...]:
        """The lines of file ``name``, included from ``where``."""
        path = self._folder / name
        try:
            return _read_lines(path)
        except (OSError, UnicodeDecodeError) as error:
            reason = getattr(error, "strerror", None) or error
            origin = f"{where}: " if where else ""
            raise ShaderError(
                f"{origin}cannot read shader {path}: {reason}"
            ) from error

    @staticmethod
    def _line_directive(file: int, line: int) -> str:
        return f"#line {file * LINES_PER_FILE + line} {file}"

    @staticmethod
    def _check_include(
        target: str | None, depth: int, opened: tuple[str, ...], here: str
    ) -> None:
        if target is None:
            raise ShaderError(f'{here}: expected #include "include/name.glsl"')
        if depth:
            raise ShaderError(
                f"{here}: #include {target} depends on a condition; "
                "include it at the top and put the condition inside"
            )
        if target in opened:
            circle = " -> ".join((*opened[opened.index(target) :], target))
            raise ShaderError(f"{here}: files include each other: {circle}")


def forget_shaders() -> None:
    """Read every file anew when it is asked for the next time."""
    _read_lines.cache_clear()


@cache
def _read_lines(path: Path) -> tuple[str, ...]:
    return tuple(path.read_text(encoding="utf-8").splitlines())
