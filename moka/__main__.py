"""``python -m moka`` is the command ``moka``."""

import sys

from moka.cli import main

if __name__ == "__main__":
    sys.exit(main())
