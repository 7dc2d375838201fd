"""Prints the largest error of each term for the driver at hand.

python -m tests.support.stated_errors [TERM ...]
"""

import sys

from tests.support.stated_errors import MEASURES

for name in sys.argv[1:] or MEASURES:
    print(f"{name:32} {MEASURES[name]():.1e}")
