"""The JSON against the table of rules: types, ranges, references."""

import re
from typing import Any

from moka.model.validation.issues import Place, Report
from moka.model.validation.rules import OBJECTS, Rule

__all__ = ["check_structure"]

_TYPES: dict[str, tuple[type, ...]] = {
    "number": (int, float),
    "integer": (int,),
    "index": (int,),
    "string": (str,),
    "boolean": (bool,),
    "object": (dict,),
    "list": (list,),
}
_NUMBERS = {int, float}
_NAMES = {"list": "array", "index": "integer"}
_INDEX = "an index must be an integer of at least 0"


def check_structure(document: dict[str, Any], report: Report) -> None:
    """Check every object of the document, and what indices point at."""
    _Checker(document, report).object(document, "glTF", ())


class _Checker:
    def __init__(self, document: dict[str, Any], report: Report) -> None:
        self._report = report
        self._counts = {
            name: len(value)
            for name, value in document.items()
            if isinstance(value, list)
        }

    def object(self, value: dict[str, Any], name: str, place: Place) -> None:
        """An object of the kind ``name``."""
        if name == "attributes":
            self._attributes(value, place)
            return
        rules = OBJECTS[name]
        for key, each in value.items():
            rule = rules.get(key)
            if rule is not None:
                self.value(each, rule, (*place, key))
            elif key == "extensions":
                if not isinstance(each, dict):
                    self._mismatch(each, "object", (*place, key))
            elif key != "extras":
                self._report.add(
                    "UNEXPECTED_PROPERTY",
                    (*place, key),
                    "is no property that glTF knows here",
                )
        for key, rule in rules.items():
            if rule.required and key not in value:
                self._report.add(
                    "UNDEFINED_PROPERTY", place, f"needs the property {key!r}"
                )

    def value(self, value: Any, rule: Rule, place: Place) -> None:
        """A value of any kind."""
        is_index = rule.kind == "index"
        if not _is(value, rule.kind):
            self._mismatch(value, rule.kind, place)
        elif rule.kind == "object":
            self.object(value, rule.name, place)
        elif rule.kind == "list":
            self._list(value, rule, place)
        elif is_index and value < 0:
            self._report.add("INVALID_INDEX", place, _INDEX)
        elif is_index:
            count = self._counts.get(rule.to, 0)
            if rule.to and value >= count:
                self._unresolved(place, rule.to, value, count)
        else:
            self._plain(value, rule, place)

    def _attributes(self, value: dict[str, Any], place: Place) -> None:
        if not value:
            self._report.add("EMPTY_ENTITY", place, "must not be empty")
        accessor = Rule("index", to="accessors")
        for name, index in value.items():
            self.value(index, accessor, (*place, name))

    def _list(self, value: list[Any], rule: Rule, place: Place) -> None:
        assert rule.of is not None
        if not value:
            self._report.add("EMPTY_ENTITY", place, "must not be empty")
            return
        if rule.lengths and len(value) not in rule.lengths:
            lengths = " or ".join(map(str, rule.lengths))
            self._report.add(
                "ARRAY_LENGTH_NOT_IN_LIST",
                place,
                f"has {len(value)} elements, not {lengths}",
            )
            return
        of = rule.of
        # Most of a file is lists of numbers, which are taken as a whole.
        if (
            of.kind == "number"
            and {*map(type, value)} <= _NUMBERS
            and (of.least is None or min(value) >= of.least)
            and (of.greatest is None or max(value) <= of.greatest)
        ):
            return
        seen = set()
        for number, each in enumerate(value):
            here = (*place, number)
            if of.kind in ("number", "string") and not _is(each, of.kind):
                self._report.add(
                    "ARRAY_TYPE_MISMATCH",
                    place,
                    f"element {number} is not a {of.kind}",
                )
                continue
            self.value(each, of, here)
            if rule.unique and not isinstance(each, dict | list):
                if each in seen:
                    self._report.add(
                        "DUPLICATE_ELEMENTS", here, f"{each!r} is there twice"
                    )
                seen.add(each)

    def _plain(self, value: Any, rule: Rule, place: Place) -> None:
        """A number, text or truth value of the right type."""
        if rule.choices:
            if value not in rule.choices:
                choices = ", ".join(map(str, rule.choices))
                self._report.add(
                    "VALUE_NOT_IN_LIST",
                    place,
                    f"is {value!r}, not one of {choices}",
                )
            return
        if rule.pattern and not re.fullmatch(rule.pattern, value):
            self._report.add(
                "PATTERN_MISMATCH", place, f"is {value!r}, not like 2.0"
            )
        if rule.multiple and value % rule.multiple:
            self._report.add(
                "VALUE_MULTIPLE_OF",
                place,
                f"is {value}, not a multiple of {rule.multiple}",
            )
        if (
            (rule.least is not None and value < rule.least)
            or (rule.greatest is not None and value > rule.greatest)
            or (rule.above is not None and value <= rule.above)
        ):
            self._report.add(
                "VALUE_NOT_IN_RANGE",
                place,
                f"is {value}, which is out of range",
            )

    def _unresolved(
        self, place: Place, kind: str, value: int, count: int
    ) -> None:
        self._report.add(
            "UNRESOLVED_REFERENCE",
            place,
            f"there is no {kind}[{value}], the file has {count}",
        )

    def _mismatch(self, value: Any, kind: str, place: Place) -> None:
        self._report.add(
            "TYPE_MISMATCH",
            place,
            f"is {_brief(value)}, not of type {_NAMES.get(kind, kind)}",
        )


def _is(value: Any, kind: str) -> bool:
    if isinstance(value, bool):
        return kind == "boolean"
    return isinstance(value, _TYPES[kind])


def _brief(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."
