"""Loggers of moka are silent until a program asks to hear them."""

import logging
import subprocess
import sys

import pytest

from moka.core.log import get_logger


def test_a_program_that_asks_hears_it(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, "moka"):
        get_logger("moka.model.load").info("read")
    assert caplog.record_tuples == [("moka.model.load", logging.INFO, "read")]


def test_a_program_that_does_not_hears_nothing() -> None:
    code = (
        "from moka.core.log import get_logger\n"
        "get_logger('moka.model.load').warning('nobody asked')"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert done.stdout == done.stderr == ""
