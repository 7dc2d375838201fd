"""A file is there whole or not at all, and nothing is left beside it."""

import os
import stat
from pathlib import Path

import pytest

from moka.core.atomic_file import atomic_file


def test_file_appears_at_the_end(tmp_path: Path) -> None:
    target = tmp_path / "a.txt"
    with atomic_file(target) as temporary:
        temporary.write_text("new")
        assert temporary.parent == tmp_path
        assert not target.exists()
    assert target.read_text() == "new"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_error_leaves_the_old_file(tmp_path: Path) -> None:
    target = tmp_path / "a.txt"
    target.write_text("old")

    def interrupted() -> None:
        with atomic_file(target) as temporary:
            temporary.write_text("half of the n")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert target.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_file_has_the_usual_permissions(tmp_path: Path) -> None:
    (tmp_path / "usual").touch()
    with atomic_file(tmp_path / "a") as temporary:
        temporary.write_text("")
    modes = [stat.S_IMODE(f.stat().st_mode) for f in tmp_path.iterdir()]
    assert modes[0] == modes[1]


def test_link_stays_a_link(tmp_path: Path) -> None:
    target = tmp_path / "folder" / "a"
    target.parent.mkdir()
    link = tmp_path / "link"
    link.symlink_to(target)
    with atomic_file(link) as temporary:
        temporary.write_text("new")
    assert link.is_symlink()
    assert target.read_text() == "new"


def test_device_is_written_to_and_not_replaced() -> None:
    with atomic_file(os.devnull) as temporary:
        temporary.write_text("gone")
    assert stat.S_ISCHR(os.stat(os.devnull).st_mode)


@pytest.mark.parametrize("name", ["missing/a.png", "."])
def test_what_cannot_be_written_is_an_error_at_once(
    tmp_path: Path, name: str
) -> None:
    with (
        pytest.raises(OSError, match="directory"),
        atomic_file(tmp_path / name),
    ):
        pytest.fail("the block ran")
