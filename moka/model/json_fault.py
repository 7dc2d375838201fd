"""Where a text stops being JSON, as a person finds it in an editor."""

import re

__all__ = ["describe_fault"]


def describe_fault(text: bytes | memoryview, complaint: str) -> str:
    """One line: what msgspec complains of, and its line and column.

    ``complaint`` is the text of its DecodeError. Columns count bytes, from 1
    as lines do.
    """
    data = bytes(text)
    found = re.fullmatch(r"JSON is malformed: (.*) \(byte (\d+)\)", complaint)
    if found is None:
        line = data.rstrip().count(b"\n") + 1
        return f"line {line}: the JSON ends before it is complete"
    what, byte = found[1], int(found[2])
    line = data.count(b"\n", 0, byte) + 1
    column = byte - (data.rfind(b"\n", 0, byte) + 1) + 1
    return f"line {line}, column {column}: the JSON is malformed: {what}"
