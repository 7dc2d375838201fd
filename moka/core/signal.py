"""A signal: whoever is connected is called when it is notified."""

import itertools
import threading
from collections.abc import Callable
from typing import Generic, ParamSpec

__all__ = ["Signal"]

P = ParamSpec("P")


class Signal(Generic[P]):
    """Calls its slots in the order in which they were connected.

    Slots may be connected and disconnected from any thread, and by slots
    while they are being called: a notification calls those that are
    connected when it begins, except for those that are disconnected before
    their turn.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._numbers = itertools.count()
        self._slots: dict[int, Callable[P, object]] = {}

    def __len__(self) -> int:
        return len(self._slots)

    def connect(self, slot: Callable[P, object]) -> int:
        """Call ``slot`` from now on; returns what disconnects it."""
        with self._lock:
            number = next(self._numbers)
            self._slots[number] = slot
        return number

    def disconnect(self, connection: int) -> None:
        """Undo a :meth:`connect`; does nothing if that has been done."""
        with self._lock:
            self._slots.pop(connection, None)

    def clear(self) -> None:
        """Disconnect everybody."""
        with self._lock:
            self._slots.clear()

    def notify(self, *args: P.args, **kwargs: P.kwargs) -> None:
        """Call every slot; what one raises is raised here, at once."""
        with self._lock:
            connected = list(self._slots.items())
        for number, slot in connected:
            if number in self._slots:
                slot(*args, **kwargs)
