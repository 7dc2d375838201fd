"""Which modules one picture loads: each is time before it and for nothing.

``rendered_modules.txt`` holds those of moka that the simplest pictures may
load. Whoever needs another one for every picture adds it there; what only
some pictures need is imported where it is used.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.gpu

LIST = Path(__file__).parent / "rendered_modules.txt"

#: Installed packages that every picture needs.
ALWAYS = {"_moderngl", "moderngl", "msgspec", "numpy"}
#: Loaded by what is above or by the interpreter, if they are installed.
BY_CHANCE = {"_distutils_hack", "typing_extensions"}

#: What costs milliseconds and has been avoided.
SLOW = {
    "asyncio",
    "dataclasses",
    "email",
    "http",
    "json",
    "multiprocessing",
    "numpy.ma",
    "socket",
    "subprocess",
    "unittest",
    "xml",
}

#: What lighting that is found in the cache was made with.
MAKERS = {
    "moka.lighting.make_lighting",
    "moka.lighting.preintegration",
    "moka.lighting.spherical_harmonics",
    "moka.lighting.suns",
}

SCRIPT = """
import sys
from moka.cli.main import main

assert main(sys.argv[1:]) == 0
for name, module in sorted(sys.modules.items()):
    installed = "site-packages" in (getattr(module, "__file__", None) or "")
    print("installed" if installed else "other", name)
"""


def rendered(folder: Path, *arguments: str) -> tuple[set[str], set[str]]:
    """What ``moka render`` has loaded at its end.

    Packages that are installed, without moka, and all modules.
    """
    result = subprocess.run(
        [
            *(sys.executable, "-c", SCRIPT, "render", *arguments),
            *("--size", "16x16", "-o", str(folder / "picture.png")),
        ],
        env={**os.environ, "MOKA_CACHE_DIR": str(folder / "cache")},
        capture_output=True,
        text=True,
        check=True,
    )
    packages, modules = set(), set()
    for line in result.stdout.splitlines():
        kind, name = line.split(" ", 1)
        package = name.partition(".")[0]
        if kind == "installed" and package != "moka":
            packages.add(package)
        modules.add(name)
    return packages - BY_CHANCE, modules


def check_modules(modules: set[str]) -> None:
    listed = set(LIST.read_text(encoding="utf-8").split())
    own = {name for name in modules if name.partition(".")[0] == "moka"}
    added = sorted(own - listed)
    assert not added, (
        f"moka render loads {', '.join(added)}: import it where it is used, "
        f"or, if every picture needs it, add it to tests/{LIST.name}"
    )
    slow = sorted(modules & SLOW)
    assert not slow, f"moka render loads {', '.join(slow)}"


def test_a_picture_loads_what_it_needs(tmp_path: Path) -> None:
    packages, modules = rendered(tmp_path, "--environment", "none")
    assert packages == ALWAYS | {"PIL"}  # the model has PNG images
    check_modules(modules - {"subprocess"})  # which Pillow loads
    assert not modules & MAKERS


@pytest.mark.assets
def test_a_cached_picture_loads_what_it_needs(
    tmp_path: Path, assets: Path
) -> None:
    arguments = (
        str(assets / "models/DamagedHelmet/DamagedHelmet.gltf"),
        "--environment",
        str(assets / "environments/spiaggia_di_mondello_1k.hdr"),
    )
    _, modules = rendered(tmp_path, *arguments)
    assert modules >= MAKERS
    packages, modules = rendered(tmp_path, *arguments)
    assert packages == ALWAYS | {"simplejpeg"}
    check_modules(modules)
    assert not modules & MAKERS


def test_the_list_is_sorted_and_true() -> None:
    listed = LIST.read_text(encoding="utf-8").split()
    assert listed == sorted(set(listed))
    root = Path(__file__).parents[1]
    for name in listed:
        place = root.joinpath(*name.split("."))
        assert place.with_suffix(".py").is_file() or place.is_dir(), name
