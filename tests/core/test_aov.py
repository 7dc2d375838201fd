"""Names of AOVs and of their layers."""

import pytest

from moka.core.aov import AOVS, exr_layer, parse_aovs
from moka.core.errors import OptionError


def test_a_text_and_a_list_name_the_same() -> None:
    assert parse_aovs("depth, normal,depth") == ("depth", "normal")
    assert parse_aovs(["depth", "normal"]) == ("depth", "normal")
    assert parse_aovs(()) == ()


def test_an_unknown_name_is_told_with_the_known_ones() -> None:
    with pytest.raises(OptionError) as caught:
        parse_aovs("depth,colour")
    assert "'colour'" in str(caught.value)
    assert all(name in str(caught.value) for name in AOVS)


def test_layers_have_the_letters_of_their_channels() -> None:
    assert exr_layer("depth") == "depth"
    assert exr_layer("normal") == "normal.XYZ"
    assert exr_layer("albedo") == "albedo.RGB"
    assert exr_layer("my own") == "my own"
