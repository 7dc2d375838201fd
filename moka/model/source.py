"""A glTF file that was opened: its document, and its buffers when asked.

It is what the readers of this package share: the typed JSON, the bytes of
buffers and views, and errors that name the file and the JSON path.
"""

import os
import threading
from pathlib import Path
from typing import Protocol, TypeAlias

from moka.core.errors import ModelError
from moka.model.container import read_file, split_container
from moka.model.schema import Document, decode_document
from moka.model.uri import (
    UriError,
    decode_data_uri,
    is_data_uri,
    quote,
    resolve,
)

__all__ = ["GltfSource", "ModelSource", "PygltflibDocument", "open_source"]


class PygltflibDocument(Protocol):
    """What moka asks of a ``pygltflib.GLTF2``, which has no types itself."""

    def to_json(self) -> str:
        """The document as JSON text."""

    def binary_blob(self) -> bytes | None:
        """The binary chunk, if there is one."""


ModelSource: TypeAlias = (
    str | os.PathLike[str] | bytes | bytearray | memoryview | PygltflibDocument
)


class GltfSource:
    """An open glTF file.

    ``where`` names it in errors, ``path`` is None if it came from memory,
    ``folder`` is what relative URIs start from.
    """

    def __init__(
        self,
        document: Document,
        where: str,
        *,
        path: Path | None = None,
        folder: Path | None = None,
        binary: memoryview | None = None,
    ) -> None:
        self.document = document
        self.where = where
        self.path = path
        self.folder = folder
        self._binary = binary
        self._buffers: dict[int, memoryview] = {}
        self._lock = threading.Lock()
        self._decoded: dict[int, memoryview] = {}

    def error(self, path: str, text: str) -> ModelError:
        """An error at JSON ``path``, to be raised by the caller."""
        return ModelError(f"{self.where}: {path}: {text}")

    def check_index(self, path: str, index: int, kind: str, count: int) -> None:
        """Raise ModelError unless ``index`` is one of ``count`` things."""
        if not 0 <= index < count:
            raise self.error(
                path, f"there is no {kind}[{index}], the file has {count}"
            )

    def buffer(self, index: int) -> memoryview:
        """The bytes of a buffer, read once, when first asked for."""
        data = self._buffers.get(index)
        if data is None:
            with self._lock:  # views are decoded in several threads
                data = self._buffers.get(index)
                if data is None:
                    data = self._buffers[index] = self._read_buffer(index)
        return data

    def view(self, index: int) -> memoryview:
        """The bytes of a buffer view, decoded once if it is compressed.

        Raises ModelError if it has too few, or cannot be decoded.
        """
        view = self.document.buffer_views[index]
        if view.extensions is not None:
            decoded = self._decoded.get(index) or self._decode(index)
            if decoded is not None:
                return decoded
        path = f"bufferViews[{index}]"
        return self.range(path, view.buffer, view.byte_offset, view.byte_length)

    def range(
        self, path: str, buffer: int, offset: int, length: int
    ) -> memoryview:
        """Some bytes of a buffer, which JSON ``path`` asks for.

        Raises ModelError if it has too few.
        """
        buffers = self.document.buffers
        self.check_index(f"{path}.buffer", buffer, "buffers", len(buffers))
        end, size = offset + length, buffers[buffer].byte_length
        if end > size:
            raise self.error(
                path, f"ends at byte {end}, buffers[{buffer}] has {size}"
            )
        return self.buffer(buffer)[offset:end]

    def uri_data(self, path: str, uri: str) -> bytes:
        """The data of a data URI that stands at JSON ``path``."""
        try:
            return decode_data_uri(uri)
        except UriError as error:
            raise self.error(path, str(error)) from error

    def uri_path(self, path: str, uri: str) -> Path:
        """The file named by a relative URI that stands at ``path``."""
        try:
            return resolve(uri, self.folder)
        except UriError as error:
            raise self.error(path, str(error)) from error

    def _decode(self, index: int) -> memoryview | None:
        """The bytes of a view if it is compressed, None if it is not."""
        from moka.model.meshopt import decode_view, is_compressed

        if not is_compressed(self.document.buffer_views[index]):
            return None
        decoded = decode_view(self, index)
        if decoded is not None:
            self._decoded[index] = decoded
        return decoded

    def _read_buffer(self, index: int) -> memoryview:
        path = f"buffers[{index}]"
        buffer = self.document.buffers[index]
        size = buffer.byte_length
        if buffer.uri is None:
            if index != 0 or self._binary is None:
                raise self.error(
                    path, "has no uri, and there is no binary chunk for it"
                )
            data = self._binary
        elif is_data_uri(buffer.uri):
            data = memoryview(self.uri_data(f"{path}.uri", buffer.uri))
        else:
            file = self.uri_path(f"{path}.uri", buffer.uri)
            try:
                data = memoryview(read_file(file, size))
            except ModelError as error:
                raise self.error(f"{path}.uri", str(error)) from error
        if len(data) < size:
            raise self.error(
                f"{path}.byteLength", f"is {size}, the data has {len(data)}"
            )
        return data[:size]


def open_source(source: ModelSource) -> GltfSource:
    """Open a path, the bytes of a file, or a ``pygltflib.GLTF2``.

    Raises ModelError if it is not a glTF 2 file.
    """
    if isinstance(source, str | os.PathLike):
        path = Path(source)
        opened = _from_bytes(memoryview(read_file(path)), str(path), path)
    elif isinstance(source, bytes | bytearray | memoryview):
        opened = _from_bytes(memoryview(source).cast("B"), "<bytes>", None)
    elif type(source).__module__.partition(".")[0] == "pygltflib":
        opened = _from_pygltflib(source)
    else:
        raise ModelError(
            f"{type(source).__name__}: not a model; give a path, bytes or a "
            "pygltflib.GLTF2"
        )
    _check_version(opened)
    return opened


def _from_bytes(data: memoryview, where: str, path: Path | None) -> GltfSource:
    text, binary = split_container(data, where)
    return GltfSource(
        decode_document(text, where),
        where,
        path=path,
        folder=path.parent if path else None,
        binary=binary,
    )


def _from_pygltflib(gltf: PygltflibDocument) -> GltfSource:
    """Its objects take any value, so they pass through JSON to be checked."""
    folder = getattr(gltf, "_path", None)
    where = getattr(gltf, "_name", None) or "<pygltflib.GLTF2>"
    try:
        text = gltf.to_json().encode()
    except (TypeError, ValueError, AttributeError) as error:
        raise ModelError(f"{where}: cannot be written: {error}") from error
    blob = gltf.binary_blob()
    return GltfSource(
        decode_document(text, where),
        where,
        path=Path(folder, where) if folder else None,
        folder=folder,
        binary=None if blob is None else memoryview(blob),
    )


def _check_version(source: GltfSource) -> None:
    """A file of version 2.x that needs no more than 2.0 can be read."""
    asset = source.document.asset
    if asset.version.partition(".")[0] != "2":
        raise source.error(
            "asset.version",
            f"is {quote(asset.version)}; moka reads glTF 2.0, convert the file",
        )
    if asset.min_version not in (None, "2.0"):
        raise source.error(
            "asset.minVersion",
            f"asks for {quote(asset.min_version)}; moka reads glTF 2.0",
        )
