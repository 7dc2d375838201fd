"""Run-length codes of Radiance, there and back and broken on purpose."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from moka.core import radiance_scanlines
from moka.core.radiance_scanlines import decode_scanlines, encode_scanlines


def picture(height: int, width: int, seed: int = 0) -> np.ndarray:
    """RGBE pixels with runs of every length and with noise."""
    random = np.random.default_rng(seed)
    rgbe = random.integers(0, 256, (height, width, 4), dtype=np.uint8)
    rgbe[:, :, 0] |= 128
    for row in rgbe:
        for channel in range(4):
            start, stop = sorted(random.integers(0, width + 1, 2))
            row[start:stop, channel] = 200
        start, stop = sorted(random.integers(0, width + 1, 2))
        row[start:stop] = row[min(start, width - 1)]
    return rgbe


@pytest.mark.parametrize("coding", ["new", "old", "flat"])
@given(
    height=st.integers(1, 6),
    width=st.one_of(st.integers(1, 40), st.integers(100, 700)),
    seed=st.integers(0, 1000),
)
def test_pixels_come_back(
    coding: str, height: int, width: int, seed: int
) -> None:
    rgbe = picture(height, width, seed)
    data = encode_scanlines(rgbe, coding)
    decoded = decode_scanlines(data, width, height)
    np.testing.assert_array_equal(decoded, rgbe)
    # What follows the picture is none of its business.
    decoded = decode_scanlines(data + b"\xff\0\2\2", width, height)
    np.testing.assert_array_equal(decoded, rgbe)


@pytest.mark.parametrize("coding", ["new", "old"])
def test_even_pictures_shrink(coding: str) -> None:
    rgbe = np.full((10, 1000, 4), 130, np.uint8)
    assert len(encode_scanlines(rgbe, coding)) < rgbe.nbytes / 30


@pytest.mark.parametrize("width", [7, 0x8000])
def test_widths_without_the_newer_code_are_flat(width: int) -> None:
    rgbe = picture(2, width)
    data = encode_scanlines(rgbe, "new")
    assert data == rgbe.tobytes()
    np.testing.assert_array_equal(decode_scanlines(data, width, 2), rgbe)


def in_turn(data: bytes, width: int, height: int) -> np.ndarray:
    """The picture as the loop over packets reads it."""
    planes = np.zeros((height, 4 * width), np.uint8)
    radiance_scanlines._decode_in_turn(data, 0, planes, 0)
    return planes.reshape(height, 4, width).swapaxes(1, 2)


def test_both_ways_read_the_same_sound_picture() -> None:
    rgbe = picture(9, 300)
    data = encode_scanlines(rgbe, "new")
    planes = np.zeros((9, 1200), np.uint8)
    done = radiance_scanlines._decode_at_once(data, planes)
    assert done == (9, len(data))
    np.testing.assert_array_equal(in_turn(data, 300, 9), rgbe)


@given(st.data())
def test_both_ways_agree_on_damage(data: st.DataObject) -> None:
    rgbe = picture(4, 50, seed=3)
    sound = encode_scanlines(rgbe, "new")
    damaged = bytearray(sound)
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, len(sound) - 1))
        damaged[place] = data.draw(st.sampled_from([0, 1, 2, 50, 128, 129]))
    del damaged[data.draw(st.integers(len(sound) // 2, len(sound))) :]
    if not radiance_scanlines._is_header(bytes(damaged[:4])):
        return
    expected = outcome(in_turn, bytes(damaged))
    assert outcome(decode_scanlines, bytes(damaged)) == expected


def outcome(decode: Callable[..., np.ndarray], data: bytes) -> object:
    """The pixels of a picture of 50 x 4, or why there are none."""
    try:
        return decode(data, 50, 4).tolist()
    except ValueError as error:
        return str(error)


def test_header_that_a_packet_holds_by_chance() -> None:
    # Width 0x0510: a packet of two bytes 2, 5, and one of 0x10 bytes.
    width = 0x0510
    rest = width - 2 - 0x10
    component = (
        bytes([2, 2, 5, 0x10])
        + bytes(range(0x10))
        + b"".join(bytes([128 + 125, 7]) for _ in range(rest // 125))
        + bytes([128 + rest % 125, 9])
    )
    data = (bytes([2, 2, 5, 0x10]) + 4 * component) * 3
    decoded = decode_scanlines(data, width, 3)
    np.testing.assert_array_equal(decoded[0, :3, 1], [2, 5, 0])
    np.testing.assert_array_equal(decoded, in_turn(data, width, 3))


def test_components_may_not_run_into_each_other() -> None:
    # 17 + 15 bytes for the first two components of 16.
    data = bytes([2, 2, 0, 16, 128 + 17, 5, 128 + 15, 5, 128 + 32, 5])
    with pytest.raises(ValueError, match=r"scanline 1 of 1 .* too long"):
        decode_scanlines(data, 16, 1)


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (bytes([2, 2, 0, 9]), "another width"),
        (bytes([2, 2, 0, 8]), "ends in scanline 1 of 2"),
        (bytes([2, 2, 0, 8, 0]), "length 0"),
        (bytes([2, 2, 0, 8, 136]), "ends in scanline 1 of 2"),
        (bytes([2, 2, 0, 8, 8, 1, 2]), "ends in scanline 1 of 2"),
        (bytes([2, 2, 0, 8, *[136, 1] * 4]), "ends before scanline 2 of 2"),
        (
            bytes([2, 2, 0, 8, *[136, 1] * 4, 9, 9, 9, 9]),
            "scanline 2 of 2 does not begin",
        ),
    ],
)
def test_faults_of_the_newer_code_are_named(data: bytes, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        decode_scanlines(data, 8, 2)


def test_repetitions_of_pixels_count_in_bytes() -> None:
    pixel = bytes([150, 3, 4, 128])
    for digits, count in [([9], 9), ([44, 1], 300), ([0, 2], 512)]:
        data = pixel + b"".join(bytes([1, 1, 1, d]) for d in digits)
        decoded = decode_scanlines(data, count + 1, 1)
        assert (decoded == np.frombuffer(pixel, np.uint8)).all()


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "after 0 of 8 pixels"),
        (bytes(4 * 7), "after 7 of 8 pixels"),
        (bytes(4 * 8 - 1), "after 7 of 8 pixels"),
        (bytes([1, 1, 1, 3, *[9] * 28]), "begins with a repetition"),
        (bytes([9, 9, 9, 9, 1, 1, 1, 8]), "beyond the last"),
        (bytes([9, 9, 9, 9, 1, 1, 1, 6]), "after 7 of 8 pixels"),
        (bytes([9] * 4 + [1, 1, 1, 255] * 9), "beyond the last"),
    ],
)
def test_faults_of_the_older_code_are_named(data: bytes, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        decode_scanlines(data, 4, 2)
