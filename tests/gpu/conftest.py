"""Devices for tests that draw: EGL and OSMesa, with GL errors fatal."""

from collections.abc import Iterator

import pytest

from moka.core.errors import ContextError
from moka.graphics.device import GraphicsDevice


def open_device(backend: str) -> GraphicsDevice:
    """A debug device; skips the test where the driver is not installed."""
    device = GraphicsDevice.open(backend, debug=True)
    try:
        device.finish()
    except ContextError as error:
        device.close()
        pytest.skip(f"no {backend} context: {error}")
    return device


@pytest.fixture(params=["egl", "osmesa"])
def device(request: pytest.FixtureRequest) -> Iterator[GraphicsDevice]:
    """A device of each headless backend; its errors fail the test."""
    with open_device(request.param) as device:
        yield device
        device.finish()


@pytest.fixture
def egl_device() -> Iterator[GraphicsDevice]:
    """A device on EGL, where one driver says enough."""
    with open_device("egl") as device:
        yield device
        device.finish()
