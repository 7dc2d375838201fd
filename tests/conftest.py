"""Fixtures that every test can ask for."""

from pathlib import Path

import pytest
from hypothesis import settings

# A slow machine is no fault of the code; examples are few but the same.
settings.register_profile("moka", deadline=None, derandomize=True)
settings.load_profile("moka")

ASSETS = Path(__file__).resolve().parents[2] / "shared" / "assets"


@pytest.fixture(scope="session")
def assets() -> Path:
    """The folder of real models and environments beside the project."""
    if not ASSETS.is_dir():
        pytest.skip("the real models of ../shared/assets are not here")
    return ASSETS
