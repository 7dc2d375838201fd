"""A file against the rules of glTF 2.0, one subject after the other."""

from pathlib import Path
from typing import Any

import msgspec

from moka.model.container import read_file
from moka.model.json_fault import describe_fault
from moka.model.validation.accessors import check_accessors
from moka.model.validation.animations import check_animations
from moka.model.validation.buffers import check_buffers
from moka.model.validation.container import split_checked
from moka.model.validation.context import CheckedFile
from moka.model.validation.descriptions import (
    check_asset,
    check_cameras,
    check_extensions,
    check_lights,
    check_materials,
)
from moka.model.validation.geometry import check_meshes
from moka.model.validation.images import check_images
from moka.model.validation.issues import Report
from moka.model.validation.nodes import check_nodes
from moka.model.validation.skins import check_skins
from moka.model.validation.structure import check_structure

__all__ = ["validate"]

_BYTE_ORDER_MARK = b"\xef\xbb\xbf"


def validate(source: Path | bytes) -> Report:
    """All issues of a .gltf or .glb, by its path or its bytes.

    Raises ModelError only if the file cannot be read at all; whatever is
    wrong inside of it is in the report.
    """
    report = Report()
    folder = None
    if isinstance(source, Path):
        folder = source.parent
        source = read_file(source)
    data = memoryview(source)
    binary, is_container = None, bytes(data[:4]) == b"glTF"
    text: memoryview | None = data
    if is_container:
        text, binary = split_checked(data, report)
    elif data[:3] == _BYTE_ORDER_MARK:
        text = data[3:]
    if text is None:
        return report
    try:
        document: Any = msgspec.json.decode(bytes(text).rstrip(b"\0"))
    except msgspec.DecodeError as error:
        report.add("INVALID_JSON", (), describe_fault(text, str(error)))
        return report
    except (UnicodeDecodeError, RecursionError) as error:
        report.add("INVALID_JSON", (), str(error))
        return report
    if not isinstance(document, dict):
        report.add("TYPE_MISMATCH", (), "the JSON is not an object")
        return report
    _check(
        CheckedFile(
            document,
            report,
            binary=binary,
            is_container=is_container,
            folder=folder,
        )
    )
    return report


def _check(file: CheckedFile) -> None:
    if not check_asset(file):
        return
    check_structure(file.document, file.report)
    check_extensions(file)
    check_buffers(file)
    check_accessors(file)
    check_meshes(file)
    parents = check_nodes(file)
    check_skins(file, parents)
    check_animations(file)
    check_cameras(file)
    check_lights(file)
    check_materials(file)
    check_images(file)
