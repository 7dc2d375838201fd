"""Runs command lines as fresh processes, in turn, and measures them."""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from moka.core.errors import MokaError

__all__ = ["ProcessRun", "in_turn", "run_process"]


@dataclass(frozen=True, slots=True)
class ProcessRun:
    """What one process took; None where the system does not tell.

    ``cpu_ms`` is user and system time, ``peak_rss_mb`` the largest resident
    set in MiB, both of the process and of those that it waited for. Linux
    counts what this process held when it started the other, so that the peak
    is never below that.
    """

    wall_ms: float
    cpu_ms: float | None = None
    peak_rss_mb: float | None = None


def run_process(
    command: Sequence[str], environment: Mapping[str, str] | None = None
) -> ProcessRun:
    """Run ``command`` to its end.

    ``environment`` is added to that of this process. Raises MokaError with
    the last line of its output if it cannot be started or fails.
    """
    with tempfile.TemporaryFile() as output:
        start = time.perf_counter()
        try:
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                env={**os.environ, **(environment or {})},
            )
        except OSError as error:
            raise MokaError(
                f"{command[0]}: cannot be run: {error.strerror}"
            ) from error
        run = _wait(process, start)
        if process.returncode:
            output.seek(0)
            lines = output.read().decode(errors="replace").split("\n")
            said = [line for line in lines if line.strip()]
            raise MokaError(
                f"{command[0]}: ended with exit code {process.returncode}: "
                f"{said[-1] if said else 'it said nothing'}"
            )
    return run


def in_turn(
    jobs: Mapping[str, Callable[[], ProcessRun]], rounds: int
) -> dict[str, list[ProcessRun]]:
    """Runs of each job: one warm-up that is not counted, then ``rounds``.

    A B A B, so that a machine that grows slower does so for all of them and
    runs of one round are pairs.
    """
    runs: dict[str, list[ProcessRun]] = {name: [] for name in jobs}
    for number in range(1 + rounds):
        for name, job in jobs.items():
            run = job()
            if number:
                runs[name].append(run)
    return runs


def _wait(process: "subprocess.Popen[bytes]", start: float) -> ProcessRun:
    if not hasattr(os, "wait4"):
        process.wait()
        return ProcessRun(1000.0 * (time.perf_counter() - start))
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    return ProcessRun(
        1000.0 * wall,
        1000.0 * (usage.ru_utime + usage.ru_stime),
        # Kibibytes on Linux, bytes on macOS.
        usage.ru_maxrss / (1 << 20 if sys.platform == "darwin" else 1 << 10),
    )
