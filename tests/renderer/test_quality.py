"""Named qualities, and what options make of them."""

import pytest

from moka.core.errors import OptionError
from moka.renderer.quality import QUALITIES, settings_of_quality
from moka.renderer.settings import RenderSettings


def test_balanced_has_the_defaults() -> None:
    assert settings_of_quality("balanced") == RenderSettings()
    assert settings_of_quality() == RenderSettings()


@pytest.mark.parametrize("quality", sorted(QUALITIES))
def test_every_quality_is_valid_and_another(quality: str) -> None:
    settings = settings_of_quality(quality)
    for name, value in QUALITIES[quality].items():
        assert getattr(settings, name) == value
    others = {settings_of_quality(each) for each in QUALITIES}
    assert len(others) == len(QUALITIES)


def test_options_override_a_quality() -> None:
    settings = settings_of_quality("best", ibl_samples=8, suns="off")
    assert settings.ibl == "filtered"
    assert settings.ibl_samples == 8
    assert settings.suns == "off"
    assert settings_of_quality("best", ibl="split-sum").ibl == "split-sum"
    # Also by what happens to be the default.
    assert settings_of_quality("fast", irradiance="auto").irradiance == "auto"


def test_none_is_an_option_that_was_not_given() -> None:
    assert settings_of_quality("fast", irradiance=None, ibl=None) == (
        settings_of_quality("fast")
    )


def test_values_that_are_false_are_given() -> None:
    assert settings_of_quality("best", suns=0).suns == 0
    assert not settings_of_quality("best", multiscatter=False).multiscatter


def test_mistakes_are_named() -> None:
    with pytest.raises(OptionError, match="'ultra' is unknown; choose from"):
        settings_of_quality("ultra")
    with pytest.raises(OptionError, match="irradiance"):
        settings_of_quality("fast", irradiance="magic")
