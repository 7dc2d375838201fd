"""The scanlines of Radiance pictures: run-length coded or flat.

Ward, Real Pixels, Graphics Gems II, 1991, and Radiance's color.c. The newer
run-length code stores, for each scanline, four bytes with its width and
then the four components one after another, each as packets: a count above
128 and one byte to repeat, or a count and as many bytes as they are. The
older one repeats whole pixels. Errors are ValueErrors without a file name.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

__all__ = ["decode_scanlines", "encode_scanlines"]

Bytes = NDArray[np.uint8]

#: Widths that the newer run-length code can express.
_NEW_WIDTHS = range(8, 0x8000)

#: Runs shorter than this are stored as they are.
_SHORTEST_RUN = 4
_LONGEST_RUN = 127
_LONGEST_LITERAL = 128

# Bytes of a file.
_REPEATED_AT_ONCE = 1 << 20

#: By its first byte: how far a packet reaches.
_STEPS = bytes(2 if code > 128 else code + 1 for code in range(256))


def decode_scanlines(data: bytes, width: int, height: int) -> Bytes:
    """RGBE pixels (``height``, ``width``, 4) from all that follows a header.

    Raises ValueError if ``data`` ends too early or contradicts itself.
    """
    if width in _NEW_WIDTHS and _is_header(data[:4]):
        return _decode_new(data, width, height)
    return _decode_old(np.frombuffer(data, np.uint8), width, height)


def encode_scanlines(rgbe: Bytes, coding: str) -> bytes:
    """Pixels (H, W, 4) as ``new`` or ``old`` run-length code, or ``flat``.

    What is too narrow or too wide for the newer code is stored flat.
    """
    width = rgbe.shape[1]
    if coding == "new" and width in _NEW_WIDTHS:
        header = bytes([2, 2, width >> 8, width & 0xFF])
        return b"".join(
            header + b"".join(_encode_component(part) for part in row.T)
            for row in rgbe
        )
    if coding == "old":
        return b"".join(_encode_pixels(row) for row in rgbe)
    return rgbe.tobytes()


def _is_header(start: bytes) -> bool:
    return start[:2] == b"\2\2" and len(start) == 4 and start[2] < 128


def _decode_new(data: bytes, width: int, height: int) -> Bytes:
    planes = np.empty((height, 4 * width), np.uint8)
    done, position = _decode_at_once(data, planes)
    _decode_in_turn(data, position, planes, done)
    return planes.reshape(height, 4, width).swapaxes(1, 2)


def _decode_at_once(data: bytes, planes: Bytes) -> tuple[int, int]:
    """Decode scanlines with one short loop over all their packets.

    A scanline's header is recognised by its bytes, which a packet may hold
    by chance. So every boundary is checked, and only the scanlines before
    the first that fails count. Returns how many they are and where the next
    one begins.
    """
    height, size = planes.shape
    width = size // 4
    values = np.frombuffer(data, np.uint8)
    headers = _find_all(data, bytes([2, 2, width >> 8, width & 0xFF]))
    starts, stops = _packets(data, headers)
    is_header = np.isin(starts, headers, assume_unique=True)
    codes = values[starts]
    repeated = (codes > 128) & ~is_header
    counts = codes.astype(np.intp)
    counts[repeated] -= 128
    counts[is_header] = 0
    ends = np.cumsum(counts)

    # What each scanline begins with, where its four components end, and
    # that no packet is empty.
    first = ends[is_header][:height]
    sound = np.zeros(height, np.bool_)
    sound[: len(first)] = first == size * np.arange(len(first))
    edges = width * np.arange(1, 4 * height + 1)
    packets = np.minimum(np.searchsorted(ends, edges), len(ends) - 1)
    sound &= (ends[packets] == edges).reshape(height, 4).all(axis=1)
    empty = ends[(counts == 0) & ~is_header] // size
    sound[empty[empty < height]] = False
    done = height if sound.all() else int(sound.argmin())
    if done == 0:
        return 0, 0

    used = slice(int(packets[4 * done - 1]) + 1)
    starts, repeated, counts = starts[used], repeated[used], counts[used]
    stop = int(stops[used][-1])
    copies = np.ones(stop, np.intp)
    copies[starts] = 0
    copies[starts[is_header[used]][:, np.newaxis] + np.arange(4)] = 0
    copies[starts[repeated] + 1] = counts[repeated]
    decoded = planes[:done].reshape(-1)
    end = 0
    # NumPy repeats with Python's lock: not all at once, for whoever waits.
    for place in range(0, stop, _REPEATED_AT_ONCE):
        part = slice(place, min(place + _REPEATED_AT_ONCE, stop))
        texels = np.repeat(values[part], copies[part])
        begin, end = end, end + len(texels)
        decoded[begin:end] = texels
    return done, stop


def _find_all(data: bytes, pattern: bytes) -> NDArray[np.intp]:
    """Where ``pattern`` lies in ``data``."""
    found = []
    position = data.find(pattern)
    while position >= 0:
        found.append(position)
        position = data.find(pattern, position + 1)
    return np.array(found, np.intp)


def _packets(
    data: bytes, headers: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Where the packets from the first byte on begin and end.

    By the shortest loop there is: for every byte a table says how far the
    packet reaches that begins there, if one does. A packet that is cut off
    at the end is left out.
    """
    steps = bytearray(data.translate(_STEPS))
    for header in headers.tolist():
        steps[header] = 4
    starts = np.fromiter(_visited(steps), np.intp)
    stops = starts + np.frombuffer(steps, np.uint8)[starts]
    whole = len(starts) - (stops[-1:] > len(data)).sum()
    return starts[:whole], stops[:whole]


def _visited(steps: bytearray) -> Iterator[int]:
    """Where one arrives from 0 by steps that each place tells."""
    place, end = 0, len(steps)
    while place < end:
        yield place
        place += steps[place]


def _decode_in_turn(
    data: bytes, position: int, planes: Bytes, first: int
) -> None:
    """Decode the scanlines from ``first`` on, packet by packet."""
    height, size = planes.shape
    width = size // 4
    for index in range(first, height):
        where = f"scanline {index + 1} of {height}"
        start = data[position : position + 4]
        position += 4
        if len(start) < 4:
            raise ValueError(f"it ends before {where}")
        if not _is_header(start):
            raise ValueError(f"{where} does not begin with its header")
        if start[2] << 8 | start[3] != width:
            raise ValueError(f"{where} is coded for another width")
        row = bytearray()
        for component in range(4):
            while len(row) < (component + 1) * width:
                count = data[position] if position < len(data) else 0
                run = count > 128
                stop = position + (2 if run else 1 + count)
                if stop > len(data) or position >= len(data):
                    raise ValueError(f"it ends in {where}")
                if count == 0:
                    raise ValueError(f"{where} has a packet of length 0")
                packet = data[position + 1 : stop]
                row += packet * (count - 128) if run else packet
                position = stop
            if len(row) > (component + 1) * width:
                raise ValueError(f"{where} has a packet that is too long")
        planes[index] = np.frombuffer(row, np.uint8)


def _decode_old(data: Bytes, width: int, height: int) -> Bytes:
    """Pixels as they are, and repetitions of the pixel before.

    A repetition is a pixel of the mantissas 1, 1, 1, whose exponent counts;
    of repetitions that follow one another each counts 256 times as much.
    """
    size = width * height
    pixels = data[: len(data) // 4 * 4].reshape(-1, 4)
    repetition = (pixels[:size, :3] == 1).all(axis=1)
    if not repetition.any():
        if len(pixels) < size:
            raise ValueError(f"it ends after {len(pixels)} of {size} pixels")
        return pixels[:size].reshape(height, width, 4)

    pixels = pixels[:size]
    if repetition[0]:
        raise ValueError("it begins with a repetition of nothing")
    index = np.arange(len(pixels))
    source = np.maximum.accumulate(np.where(repetition, 0, index))
    places = np.minimum(index - source - 1, 4)
    copies = np.ones(len(pixels), np.int64)
    copies[repetition] = pixels[repetition, 3].astype(np.int64) << (
        8 * places[repetition]
    )
    ends = np.cumsum(np.minimum(copies, size + 1))
    last = int(np.searchsorted(ends, size))
    if last == len(ends):
        raise ValueError(f"it ends after {ends[-1]} of {size} pixels")
    if ends[last] != size:
        raise ValueError("it repeats a pixel beyond the last one")
    which = np.repeat(source[: last + 1], copies[: last + 1])
    whole: Bytes = pixels[which]
    return whole.reshape(height, width, 4)


def _encode_component(values: Bytes) -> bytes:
    """Packets of one component of a scanline."""
    edges = _run_edges(values[1:] != values[:-1])
    long = np.flatnonzero(np.diff(edges) >= _SHORTEST_RUN)
    parts = []
    position = 0
    runs = zip(edges[long], edges[long + 1], strict=True)
    for start, stop in (*runs, (len(values), len(values))):
        for piece in range(position, start, _LONGEST_LITERAL):
            literal = values[piece : min(piece + _LONGEST_LITERAL, start)]
            parts.append(bytes([len(literal)]) + literal.tobytes())
        for piece in range(start, stop, _LONGEST_RUN):
            count = min(stop - piece, _LONGEST_RUN)
            parts.append(bytes([128 + count, values[start]]))
        position = stop
    return b"".join(parts)


def _encode_pixels(row: Bytes) -> bytes:
    """Pixels of one scanline, and repetitions."""
    edges = _run_edges((row[1:] != row[:-1]).any(axis=1))
    parts = []
    for start, count in zip(edges[:-1], np.diff(edges), strict=True):
        parts.append(row[start].tobytes())
        left = int(count) - 1
        while left:
            parts.append(bytes([1, 1, 1, left & 0xFF]))
            left >>= 8
    return b"".join(parts)


def _run_edges(changes: NDArray[np.bool_]) -> NDArray[np.intp]:
    """Where runs begin, and the end of the last."""
    return np.concatenate(
        [[0], np.flatnonzero(changes) + 1, [len(changes) + 1]]
    )
