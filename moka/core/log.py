"""Loggers below ``moka`` of the standard library, silent until asked for.

A warning says that a picture is not what its file asks for, or that a file
is not what it should be; information, what was read, found and chosen;
debug messages, every attempt and every texture.
"""

import logging

__all__ = ["get_logger"]

# Programs decide what is shown, not libraries: without a handler Python
# itself would print warnings.
logging.getLogger("moka").addHandler(logging.NullHandler())


def get_logger(module: str) -> logging.Logger:
    """The logger of a module, by its ``__name__``."""
    return logging.getLogger(module)
