"""What glTF files must look like: scenes, expectations and their checks.

A test runs every case, and `make conformance` makes a page of them.
"""
