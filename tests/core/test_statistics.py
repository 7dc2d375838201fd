"""Times and counters as the statistics file has them."""

import json
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from moka.core.errors import MokaError
from moka.core.statistics import Statistics, write_statistics


def test_stages_add_up_from_any_thread() -> None:
    statistics = Statistics()
    threads = [
        threading.Thread(target=statistics.add_time, args=("decode", 0.25))
        for _ in range(8)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    statistics.count("objects", 2)
    statistics.count("objects")
    content = statistics.as_dict()
    assert content["stages_ms"] == {"decode": 2000.0}
    assert content["counts"] == {"objects": 3}
    assert content["total_ms"] >= 0


def test_a_stage_that_fails_is_still_timed() -> None:
    statistics = Statistics()
    with pytest.raises(ZeroDivisionError), statistics.stage("frame"):
        raise ZeroDivisionError
    assert statistics.stages_ms["frame"] >= 0


def test_the_file_is_json_and_a_bad_path_is_named(tmp_path: Path) -> None:
    path = tmp_path / "stats.json"
    write_statistics(Statistics(), path)
    assert json.loads(path.read_text())["lighting"] == {}
    with pytest.raises(MokaError, match=r"missing.stats\.json: cannot write"):
        write_statistics(Statistics(), tmp_path / "missing" / "stats.json")


@pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="reads Linux's own figure"
)
def test_peak_memory_is_not_that_of_the_parent() -> None:
    """A small child of a process that holds 300 MiB."""
    ballast = bytearray(300 << 20)
    ballast[::4096] = b"x" * len(ballast[::4096])
    code = (
        "from moka.core.statistics import Statistics\n"
        "print(Statistics().as_dict()['peak_rss_mb'])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
    )
    assert float(done.stdout) < 100
