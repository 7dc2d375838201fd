"""The render thread ends in every case, and errors come back to people."""

import gc
import threading
import time
import traceback

import pytest

from moka.backend.protocol import Backend
from moka.backend.recording_backend import RecordingBackend
from moka.core.errors import ContextError, DeviceError
from moka.graphics.render_thread import RenderThread


def fail(_: Backend) -> None:
    """A job that goes wrong."""
    raise ZeroDivisionError("a fault in the driver")


def test_jobs_run_in_order_on_one_other_thread() -> None:
    thread = RenderThread(RecordingBackend)
    seen: list[tuple[int, int]] = []
    for number in range(20):
        thread.post(lambda _, n=number: seen.append((n, threading.get_ident())))
    assert thread.call(lambda _: "done") == "done"
    assert [number for number, _ in seen] == list(range(20))
    (ident,) = {ident for _, ident in seen}
    assert ident != threading.get_ident()
    assert thread.close()


def test_an_awaited_error_reaches_its_caller_and_nobody_else() -> None:
    thread = RenderThread(RecordingBackend)
    with pytest.raises(ZeroDivisionError) as caught:
        thread.call(fail)
    names = [frame.name for frame in traceback.extract_tb(caught.tb)]
    assert "fail" in names
    assert thread.call(lambda _: 1) == 1
    assert thread.close()


def test_an_unawaited_error_is_raised_at_the_next_call() -> None:
    thread = RenderThread(RecordingBackend)
    future = thread.post(fail)
    while not future.done():
        time.sleep(0.001)
    for _ in range(2):
        with pytest.raises(ZeroDivisionError, match="fault in the driver"):
            thread.post(lambda _: None)
    assert thread.close()


def test_work_queued_behind_an_error_is_refused() -> None:
    gate = threading.Event()
    thread = RenderThread(RecordingBackend)
    thread.post(lambda _: gate.wait(5))
    thread.post(fail)
    ran = []
    behind = thread.post(lambda _: ran.append(1))
    gate.set()
    with pytest.raises((ZeroDivisionError, DeviceError)):
        thread.wait(behind)
    assert not ran
    assert thread.close()


def test_a_backend_that_cannot_open_raises_at_the_first_call() -> None:
    def open_backend() -> Backend:
        raise ContextError("no driver here")

    thread = RenderThread(open_backend)
    with pytest.raises(ContextError, match="no driver here"):
        thread.wait_until_open()
    with pytest.raises(ContextError, match="no driver here"):
        thread.call(lambda _: None)
    assert thread.close()


def test_closing_frees_the_backend_and_may_be_repeated() -> None:
    backend = RecordingBackend()
    thread = RenderThread(lambda: backend)
    assert thread.close()
    assert thread.close()
    assert backend.closed
    with pytest.raises(DeviceError, match="closed"):
        thread.post(lambda _: None)


def test_a_backend_that_fails_to_close_still_ends() -> None:
    class Broken(RecordingBackend):
        def close(self) -> None:
            raise RuntimeError("lost context")

    thread = RenderThread(Broken)
    assert thread.close()
    assert not thread.is_alive


def test_waiting_is_bounded() -> None:
    gate = threading.Event()
    thread = RenderThread(RecordingBackend, timeout=0.0)
    with pytest.raises(DeviceError, match="not answered"):
        thread.call(lambda _: gate.wait(10))
    gate.set()
    assert thread.close()


def test_a_device_that_nobody_holds_ends_its_thread() -> None:
    from moka.graphics.device import GraphicsDevice

    backend = RecordingBackend()
    device = GraphicsDevice(lambda: backend)
    device.finish()
    del device
    gc.collect()
    deadline = time.monotonic() + 5
    while not backend.closed and time.monotonic() < deadline:
        time.sleep(0.01)
    assert backend.closed
