"""What is found: codes, their severity, and where in the JSON.

Codes are those of the Khronos glTF validator, so that what both find can be
compared and looked up.
"""

from enum import Enum

from msgspec import Struct

__all__ = ["Issue", "Report", "Severity", "path_text"]

Place = tuple[str | int, ...]


class Severity(Enum):
    """How bad an issue is; only errors make a file invalid."""

    ERROR = "error"
    WARNING = "warning"
    INFORMATION = "information"


# All others are errors.
_MILD = {
    "ACCESSOR_INDEX_TRIANGLE_DEGENERATE": Severity.INFORMATION,
    "ACCESSOR_JOINTS_USED_ZERO_WEIGHT": Severity.WARNING,
    "CAMERA_YFOV_GEQUAL_PI": Severity.WARNING,
    "DATA_URI_GLB": Severity.WARNING,
    "GLB_EXTRA_DATA": Severity.WARNING,
    "GLB_UNKNOWN_CHUNK_TYPE": Severity.WARNING,
    "IMAGE_UNRECOGNIZED_FORMAT": Severity.WARNING,
    "MATERIAL_ALPHA_CUTOFF_INVALID_MODE": Severity.WARNING,
    "MESH_PRIMITIVE_GENERATED_TANGENT_SPACE": Severity.WARNING,
    "MESH_PRIMITIVE_INCOMPATIBLE_MODE": Severity.WARNING,
    "MESH_PRIMITIVE_NO_POSITION": Severity.WARNING,
    "MESH_PRIMITIVE_TANGENT_WITHOUT_NORMAL": Severity.WARNING,
    "NODE_SKINNED_MESH_LOCAL_TRANSFORMS": Severity.WARNING,
    "NODE_SKINNED_MESH_NON_ROOT": Severity.WARNING,
    "NODE_SKINNED_MESH_WITHOUT_SKIN": Severity.WARNING,
    "UNEXPECTED_PROPERTY": Severity.WARNING,
    "UNKNOWN_ASSET_MINOR_VERSION": Severity.WARNING,
    "UNSUPPORTED_EXTENSION": Severity.INFORMATION,
    "VALUE_NOT_IN_LIST": Severity.WARNING,
}


class Issue(Struct, frozen=True):
    """One rule that is broken at one place.

    ``path`` is the JSON path, such as ``accessors[0].min[2]``, empty for the
    file as a whole; ``message`` is one line.
    """

    code: str
    severity: Severity
    path: str
    message: str


class Report:
    """Issues in the order in which they are found, each once."""

    def __init__(self) -> None:
        self._issues: dict[tuple[str, str], Issue] = {}

    @property
    def issues(self) -> list[Issue]:
        """All issues, errors first."""
        order = list(Severity)
        return sorted(
            self._issues.values(), key=lambda each: order.index(each.severity)
        )

    @property
    def is_valid(self) -> bool:
        """Whether there is no error."""
        return self.count(Severity.ERROR) == 0

    def count(self, severity: Severity) -> int:
        """How many issues are of ``severity``."""
        found = self._issues.values()
        return sum(issue.severity is severity for issue in found)

    def add(
        self,
        code: str,
        place: Place,
        message: str,
        severity: Severity | None = None,
    ) -> None:
        """Note an issue; the second of one code at one place is left out."""
        path = path_text(place)
        severity = severity or _MILD.get(code, Severity.ERROR)
        self._issues.setdefault(
            (code, path), Issue(code, severity, path, message)
        )


def path_text(place: Place) -> str:
    """The JSON path of the steps of a place."""
    text = ""
    for step in place:
        if isinstance(step, int):
            text += f"[{step}]"
        else:
            text += f".{step}" if text else step
    return text
