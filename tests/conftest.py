"""Fixtures that every test can ask for."""

from collections.abc import Iterator
from itertools import count
from pathlib import Path

import pytest
from hypothesis import settings

# A slow machine is no fault of the code; examples are few but the same.
settings.register_profile("moka", deadline=None, derandomize=True)
settings.load_profile("moka")

_numbers = count()

ASSETS = Path(__file__).resolve().parents[2] / "shared" / "assets"


@pytest.fixture(scope="session", autouse=True)
def cache_of_the_session(
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[None]:
    """Keep fixtures that outlive a test away from the user's cache too."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.getbasetemp() / "cache"
        patch.setenv("MOKA_CACHE_DIR", str(folder))
        yield


@pytest.fixture(autouse=True)
def cache_of_its_own(
    tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Keep every test, and what it starts, away from the user's cache."""
    folder = tmp_path_factory.getbasetemp() / f"cache-{next(_numbers)}"
    monkeypatch.setenv("MOKA_CACHE_DIR", str(folder))


@pytest.fixture(scope="session")
def assets() -> Path:
    """The folder of real models and environments beside the project."""
    if not ASSETS.is_dir():
        pytest.skip("the real models of ../shared/assets are not here")
    return ASSETS
