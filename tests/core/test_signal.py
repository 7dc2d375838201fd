"""Signals while their slots come and go."""

import threading

from moka.core.signal import Signal


def test_slots_are_called_in_order_with_what_is_said() -> None:
    heard: list[tuple[str, int]] = []
    signal: Signal[[int]] = Signal()
    signal.connect(lambda value: heard.append(("first", value)))
    signal.connect(lambda value: heard.append(("second", value)))
    signal.notify(3)
    assert heard == [("first", 3), ("second", 3)]


def test_nobody_is_called_after_being_disconnected() -> None:
    heard: list[int] = []
    signal: Signal[[int]] = Signal()
    connection = signal.connect(heard.append)
    signal.disconnect(connection)
    signal.disconnect(connection)
    signal.notify(1)
    signal.connect(heard.append)
    signal.clear()
    signal.notify(2)
    assert heard == []
    assert len(signal) == 0


def test_slots_may_change_the_slots_while_they_are_called() -> None:
    heard: list[str] = []
    signal: Signal[[]] = Signal()

    def first() -> None:
        heard.append("first")
        signal.disconnect(second)
        signal.connect(lambda: heard.append("late"))

    signal.connect(first)
    second = signal.connect(lambda: heard.append("second"))
    signal.notify()
    assert heard == ["first"]
    signal.notify()
    assert heard == ["first", "first", "late"]


def test_threads_may_connect_while_it_is_notified() -> None:
    signal: Signal[[]] = Signal()
    stop = threading.Event()

    def churn() -> None:
        while not stop.is_set():
            signal.disconnect(signal.connect(lambda: None))

    threads = [threading.Thread(target=churn) for _ in range(4)]
    for thread in threads:
        thread.start()
    try:
        for _ in range(500):
            signal.notify()
    finally:
        stop.set()
        for thread in threads:
            thread.join()
    assert len(signal) == 0
