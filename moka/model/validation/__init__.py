"""The rules of glTF 2.0 that matter for drawing, checked one by one.

Each file holds the rules of one subject; :mod:`.validate` goes through them.
"""
