"""CPU time to read glTF files with moka, and with other packages in Python.

    python tests/benchmarks/load_models.py -n 9 MODEL...

Every package reads all vertices, indices and animations into NumPy arrays,
as far as it does that by itself; none decodes an image. Each round reads a
file once with every package, so that a machine that is slow for a while is
slow for all of them. Ratios are medians of the ratios to moka of one round.
Packages that are not installed or cannot read a file are named as such.
"""

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import numpy as np

Reader = Callable[[Path], object]

_TYPES = {
    5120: np.int8,
    5121: np.uint8,
    5122: np.int16,
    5123: np.uint16,
    5125: np.uint32,
    5126: np.float32,
}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def with_moka(path: Path) -> object:
    from moka.model import load_model

    return load_model(path)


def with_trimesh(path: Path) -> object:
    import trimesh

    return trimesh.load(path, skip_materials=True)


def with_pygltflib(path: Path) -> object:
    """It reads the JSON and the bytes; the arrays are made as users do."""
    import pygltflib

    gltf = pygltflib.GLTF2().load(str(path))
    buffers = [
        gltf.get_data_from_buffer_uri(buffer.uri)
        if buffer.uri
        else gltf.binary_blob()
        for buffer in gltf.buffers
    ]
    arrays = []
    for accessor in gltf.accessors:
        view = gltf.bufferViews[accessor.bufferView]
        width = _WIDTHS[accessor.type]
        dtype = np.dtype(_TYPES[accessor.componentType])
        tight = width * dtype.itemsize
        start = (view.byteOffset or 0) + (accessor.byteOffset or 0)
        arrays.append(
            np.ndarray(
                (accessor.count, width),
                dtype,
                buffers[view.buffer],
                start,
                (view.byteStride or tight, dtype.itemsize),
            ).copy()
        )
    return gltf, arrays


READERS: dict[str, Reader] = {
    "moka": with_moka,
    "trimesh": with_trimesh,
    "pygltflib": with_pygltflib,
}


def milliseconds(reader: Reader, path: Path) -> float:
    """CPU time, which other work on the machine changes least."""
    start = time.process_time()
    reader(path)
    return (time.process_time() - start) * 1e3


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", type=Path, nargs="+")
    parser.add_argument("-n", "--rounds", type=int, default=9)
    arguments = parser.parse_args()
    print("| model | moka | " + " | ".join(list(READERS)[1:]) + " |")
    print("| --- |" + " --- |" * len(READERS))
    for path in arguments.models:
        times: dict[str, list[float]] = {}
        for name, reader in READERS.items():
            try:
                reader(path)  # imports, and what it keeps
            except Exception as error:
                print(f"{name}: {path.name}: {type(error).__name__}: {error}")
            else:
                times[name] = []
        for _ in range(arguments.rounds):
            for name, values in times.items():
                values.append(milliseconds(READERS[name], path))
        ours = times.pop("moka")
        cells = [f"{median(ours):.1f} ms"]
        for name in list(READERS)[1:]:
            theirs = times.get(name) or []
            ratios = [a / b for a, b in zip(theirs, ours, strict=False)]
            cells.append(f"{median(ratios):.1f}" if ratios else "not read")
        print(f"| {path.name} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
