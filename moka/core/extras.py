"""The extra ``moka-pbr[compressed]``: decoders that few files need."""

from importlib.util import find_spec

__all__ = ["is_installed", "missing_decoder"]


def is_installed(package: str) -> bool:
    """Whether ``package`` can be imported, without doing so."""
    try:
        return find_spec(package) is not None
    except ValueError:  # it stands in sys.modules as None
        return False


def missing_decoder(package: str, reason: ImportError) -> str:
    """What to do when importing ``package`` failed, as a part of a line."""
    found = isinstance(reason, ModuleNotFoundError)
    why = "" if found else f" to load ({reason})"
    return (
        f"needs the package {package}{why}; pip install 'moka-pbr[compressed]'"
    )
