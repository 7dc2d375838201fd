"""Broken JSON is found by line and column."""

import pytest

from moka.core.errors import ModelError
from moka.model import load_model
from moka.model.validation.validate import validate


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            b'{"asset": {"version": "2.0"},\n "nodes": [{},]\n}',
            "line 2, column 15: the JSON is malformed: trailing comma",
        ),
        (
            b'{"asset": ?}',
            "line 1, column 11: the JSON is malformed: invalid character",
        ),
        (b'{"asset":\n{', "line 2: the JSON ends before it is complete"),
        (b'{"asset":\n"2', "line 2: the JSON ends before it is complete"),
    ],
)
def test_a_fault_has_its_place(text: bytes, message: str) -> None:
    with pytest.raises(ModelError) as caught:
        load_model(text)
    assert str(caught.value).startswith(f"<bytes>: {message}")
    assert "\n" not in str(caught.value)
    (issue,) = validate(text).issues
    assert issue.code == "INVALID_JSON"
    assert issue.message.startswith(message)
