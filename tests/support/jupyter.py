"""A Jupyter server of the tests' own Python, on a port of its own."""

import os
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

__all__ = ["serve_notebooks"]

_SECONDS = 30.0


@contextmanager
def serve_notebooks(folder: Path) -> Iterator[str]:
    """The address of JupyterLab for the notebooks of ``folder``.

    It keeps its own files beside them, and puts its front end into
    ``window.jupyterapp``. Skips the test where a package is missing.
    """
    for package in ("jupyterlab", "ipykernel"):
        pytest.importorskip(package, reason=f"{package} is not installed")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    own = folder / ".jupyter"
    kinds = ("CONFIG_DIR", "DATA_DIR", "RUNTIME_DIR")
    environment = {
        **os.environ,
        **{f"JUPYTER_{kind}": str(own / kind.lower()) for kind in kinds},
        "IPYTHONDIR": str(own / "ipython"),
        "JUPYTERLAB_SETTINGS_DIR": str(own / "settings"),
        "JUPYTERLAB_WORKSPACES_DIR": str(own / "workspaces"),
    }
    own.mkdir()
    with (own / "log").open("wb") as log:
        server = subprocess.Popen(
            [
                *(sys.executable, "-m", "jupyterlab", "--no-browser"),
                *("--allow-root", f"--ServerApp.root_dir={folder}"),
                *("--ServerApp.ip=127.0.0.1", f"--ServerApp.port={port}"),
                *("--ServerApp.port_retries=0", "--IdentityProvider.token="),
                "--LabApp.expose_app_in_browser=True",
                "--LabApp.check_for_updates_class="
                "jupyterlab.NeverCheckForUpdate",
            ],
            env=environment,
            stdout=log,
            stderr=log,
        )
    try:
        address = f"http://127.0.0.1:{port}"
        _wait_for(address, server, own / "log")
        yield address
    finally:
        # It ends its kernels before itself.
        server.terminate()
        try:
            server.wait(timeout=10)
        except subprocess.TimeoutExpired:
            server.kill()
            server.wait()


def _wait_for(
    address: str, server: "subprocess.Popen[bytes]", log: Path
) -> None:
    deadline = time.monotonic() + _SECONDS
    while server.poll() is None and time.monotonic() < deadline:
        try:
            with urllib.request.urlopen(f"{address}/api", timeout=5):
                return
        except OSError:
            time.sleep(0.1)
    pytest.fail(f"no answer from JupyterLab:\n{log.read_text()[-2000:]}")
