"""Progress on a terminal, and nowhere else."""

import io

from moka.core.progress import Progress


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        return True


def test_a_terminal_sees_the_steps_and_then_nothing() -> None:
    terminal = Terminal()
    with Progress("frame", 4, terminal) as progress:
        progress.step()
        assert "frame 1/4" in terminal.getvalue()
    assert terminal.getvalue().endswith("\r\x1b[K")


def test_a_file_sees_nothing() -> None:
    file = io.StringIO()
    with Progress("frame", 2, file) as progress:
        progress.step()
        progress.step()
    assert file.getvalue() == ""
    assert progress.done == 2


def test_a_hidden_one_is_silent_on_a_terminal() -> None:
    stream = Terminal()
    with Progress("frame", 3, stream, is_shown=False) as progress:
        progress.step()
    assert stream.getvalue() == ""
