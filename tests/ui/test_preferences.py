"""What the viewer remembers."""

from pathlib import Path

import pytest

from moka.ui.preferences import (
    MOST_RECENT,
    Preferences,
    load_preferences,
    preferences_file,
    save_preferences,
    with_recent,
)

CHOSEN = Preferences(
    size=(800, 600),
    shows_panels=False,
    open_panels=("Picture", "Profiler"),
    environment="/maps/a.hdr",
    recent_environments=("/maps/a.hdr",),
    exposure=-1.5,
    tone_map="agx",
    gamma=2.2,
    background_blur=0.25,
    auto_rotates=True,
)


def test_what_is_saved_is_remembered(tmp_path: Path) -> None:
    path = tmp_path / "not there yet" / "viewer.json"
    assert load_preferences(path) == Preferences()
    save_preferences(CHOSEN, path)
    assert load_preferences(path) == CHOSEN
    assert [each.name for each in path.parent.iterdir()] == ["viewer.json"]


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"{",
        b"\xff\xfe",
        b"[]",
        b'{"size": "large"}',
        b'{"size": [1, 1]}',
        b'{"size": [100000, 720]}',
        b'{"exposure": 1e9}',
        b'{"tone_map": "sepia"}',
        b'{"gamma": 0}',
        b'{"background_blur": 7}',
        b'{"environment_intensity": -1}',
    ],
)
def test_a_broken_file_is_ignored(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "viewer.json"
    path.write_bytes(content)
    assert load_preferences(path) == Preferences()


def test_what_another_version_wrote_is_kept_as_far_as_it_is_known(
    tmp_path: Path,
) -> None:
    path = tmp_path / "viewer.json"
    path.write_bytes(b'{"exposure": 2, "of the future": {}}')
    assert load_preferences(path) == Preferences(exposure=2.0)


def test_a_folder_that_cannot_be_made_is_no_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    save_preferences(CHOSEN, tmp_path / "file" / "viewer.json")


def test_the_folder_is_that_of_the_system(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("MOKA_CONFIG_DIR", str(tmp_path))
    assert preferences_file() == tmp_path / "viewer.json"
    monkeypatch.delenv("MOKA_CONFIG_DIR")
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    assert preferences_file() == tmp_path / "config" / "moka" / "viewer.json"
    monkeypatch.setenv("XDG_CONFIG_HOME", "relative")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert preferences_file() == tmp_path / ".config" / "moka" / "viewer.json"


def test_recent_files_are_listed_once_the_last_one_first() -> None:
    known: tuple[str, ...] = ()
    for number in range(MOST_RECENT + 3):
        known = with_recent(known, f"/maps/{number}.hdr")
    assert len(known) == MOST_RECENT
    known = with_recent(known, known[4])
    assert len(known) == len(set(known)) == MOST_RECENT
    assert known[0] == f"/maps/{MOST_RECENT + 2 - 4}.hdr"
