"""Files dragged from elsewhere and dropped into a window of X11.

A drag source of version 5 of the XDND protocol, as file managers are one:
https://freedesktop.org/wiki/Specifications/XDND
"""

import select
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

__all__ = ["drop_files"]

VERSION = 5
DEADLINE_S = 30.0


def drop_files(display: str, paths: list[Path], at: tuple[int, int]) -> None:
    """Drag ``paths`` to a place of the screen and let go of them there.

    Returns when the window there says that it has taken them. Fails where
    there is none that takes files, or it does not answer within
    ``DEADLINE_S``. Skips the test without python-xlib.
    """
    pytest.importorskip("Xlib", reason="python-xlib is not installed")
    with _Source(display) as source:
        source.drag(paths, at)


class _Source:
    """Somebody who has files to give, with a connection of its own."""

    def __init__(self, display: str) -> None:
        from Xlib.display import Display

        self._display: Any = Display(display)
        self._root = self._display.screen().root
        self._window = self._root.create_window(0, 0, 1, 1, 0, 0)
        self._deadline = time.monotonic() + DEADLINE_S

    def __enter__(self) -> "_Source":
        return self

    def __exit__(self, *exception: object) -> None:
        self._display.close()

    def drag(self, paths: list[Path], at: tuple[int, int]) -> None:
        from Xlib import X

        target = self._target(*at)
        source = self._window.id
        types = self._atom("text/uri-list")
        copy = self._atom("XdndActionCopy")
        selection = self._atom("XdndSelection")
        self._window.set_selection_owner(selection, X.CurrentTime)
        owner = self._display.get_selection_owner(selection)
        assert owner.id == source, "somebody else drags"

        self._send(target, "XdndEnter", source, VERSION << 24, types, 0, 0)
        place = at[0] << 16 | at[1]
        self._send(target, "XdndPosition", source, 0, place, 0, copy)
        status = self._answer("XdndStatus")
        assert status[0] == target.id
        assert status[1] & 1, "the window refuses the files"

        self._send(target, "XdndDrop", source, 0, X.CurrentTime, 0, 0)
        request = self._wait(
            "SelectionRequest", lambda event: event.type == X.SelectionRequest
        )
        assert (request.selection, request.target) == (selection, types)
        self._give(request, "".join(f"{path.as_uri()}\r\n" for path in paths))

        finished = self._answer("XdndFinished")
        assert finished[0] == target.id
        # Bit 0 by the specification; GLFW says how many bytes it has read.
        assert finished[1], "the window did not take the files"
        assert finished[2] == copy

    def _atom(self, name: str) -> int:
        return self._display.intern_atom(name)

    def _target(self, x: int, y: int) -> Any:
        """The window at a place of the screen that takes what is dropped."""
        from Xlib import Xatom

        aware = self._atom("XdndAware")
        window = self._root
        while window:
            known = window.get_full_property(aware, Xatom.ATOM)
            if known is not None:
                assert known.value[0] >= VERSION
                return window
            window = window.translate_coords(self._root, x, y).child
        raise AssertionError(f"no window at {x}, {y} takes files")

    def _send(self, target: Any, message: str, *data: int) -> None:
        from Xlib.protocol.event import ClientMessage

        target.send_event(
            ClientMessage(
                window=target,
                client_type=self._atom(message),
                data=(32, data),
            )
        )
        self._display.flush()

    def _give(self, request: Any, text: str) -> None:
        """Answer who asks for the files, as ICCCM 2.2 says."""
        from Xlib.protocol.event import SelectionNotify

        request.requestor.change_property(
            request.property, request.target, 8, text.encode("ascii")
        )
        request.requestor.send_event(
            SelectionNotify(
                time=request.time,
                requestor=request.requestor,
                selection=request.selection,
                target=request.target,
                property=request.property,
            )
        )
        self._display.flush()

    def _answer(self, message: str) -> Any:
        """The five numbers of the target's next message of this name."""
        from Xlib import X

        kind = self._atom(message)
        event = self._wait(
            message,
            lambda event: (
                event.type == X.ClientMessage and event.client_type == kind
            ),
        )
        return event.data[1]

    def _wait(self, what: str, is_it: Callable[[Any], bool]) -> Any:
        while True:
            while self._display.pending_events():
                event = self._display.next_event()
                if is_it(event):
                    return event
            left = self._deadline - time.monotonic()
            assert left > 0, f"{what} did not come"
            select.select([self._display], [], [], left)
