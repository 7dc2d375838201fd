"""The version of moka; the build reads it from this file.

It is a constant and not a look-up in the installed metadata, because that
look-up alone would cost as much as the whole of ``import moka``.
"""

__all__ = ["__version__"]

__version__ = "0.1.0"
