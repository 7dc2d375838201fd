"""An image that is still encoded: bytes in memory or in a file.

Nothing is opened before something needs the texels, so that a texture which
no visible material samples costs nothing.
"""

from functools import cached_property
from pathlib import Path

from moka.core.errors import ImageFileError

__all__ = ["EncodedImage"]


class EncodedImage:
    """A PNG, JPEG or other image file, not yet decoded.

    ``where`` names it in error messages, for instance
    ``helmet.gltf: images[2]``. Exactly one of ``path`` and ``data`` is given.
    """

    def __init__(
        self,
        where: str,
        *,
        path: Path | None = None,
        data: bytes | memoryview | None = None,
    ) -> None:
        if (path is None) == (data is None):
            raise ValueError("give either a path or the data of an image")
        self.where = where
        self.path = path
        self._data = data

    def __repr__(self) -> str:
        return f"EncodedImage({self.where!r})"

    @property
    def size(self) -> int:
        """How many bytes it has, 0 for a file that is gone."""
        if self._data is not None:
            return len(self._data)
        assert self.path is not None
        try:
            return self.path.stat().st_size
        except OSError:
            return 0

    def read(self) -> bytes | memoryview:
        """The encoded bytes; raises ImageFileError if the file is gone."""
        if self._data is not None:
            return self._data
        assert self.path is not None
        try:
            return self.path.read_bytes()
        except OSError as error:
            raise ImageFileError(
                f"{self.where}: cannot read {self.path}: {error.strerror}"
            ) from error

    @cached_property
    def identity(self) -> str:
        """Equal for images of equal content, for caches within one run.

        A file is identified by its resolved path, embedded data by its hash.
        """
        if self.path is not None:
            return str(self.path.resolve())
        assert self._data is not None
        from hashlib import blake2b

        return blake2b(self._data, digest_size=16).hexdigest()
