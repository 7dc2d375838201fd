"""The extra ``moka-pbr[compressed]``: decoders that few files need."""

__all__ = ["missing_decoder"]


def missing_decoder(package: str, reason: ImportError) -> str:
    """What to do when importing ``package`` failed, as a part of a line."""
    found = isinstance(reason, ModuleNotFoundError)
    why = "" if found else f" to load ({reason})"
    return (
        f"needs the package {package}{why}; pip install 'moka-pbr[compressed]'"
    )
