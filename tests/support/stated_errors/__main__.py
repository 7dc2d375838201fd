"""Prints the largest error of each term for the driver at hand."""

from tests.support.stated_errors import MEASURES

for name, measure in MEASURES.items():
    print(f"{name:32} {measure():.1e}")
