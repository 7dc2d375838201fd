"""The command line: ``moka render | info | doctor``.

A user's error is one line on stderr that begins with ``moka: error:`` and
exit code 2; nothing else is printed unless ``--debug`` asks for a traceback.
"""

from moka.cli.main import main

__all__ = ["main"]
