"""``moka survey``: options, what is printed, exit codes."""

import json
from pathlib import Path

import pytest

from moka.cli.main import main
from tests.survey.pictures import write_answers, write_pictures


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_pictures(tmp_path / "pictures")
    return tmp_path


def make(*options: str) -> int:
    pictures = map(str, sorted(Path("pictures").iterdir()))
    return main(["survey", "make", *pictures, "-o", "out", *options])


def test_the_key_lies_beside_the_folder(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert make() == 0
    assert capsys.readouterr().out == (
        "out: 2 pages, to hand out; open index.html\n"
        "out.key.json: the key, to keep\n"
    )
    assert (folder / "out" / "index.html").is_file()
    assert json.loads((folder / "out.key.json").read_text())["survey_key"] == 1


def test_options_reach_the_page(folder: Path) -> None:
    (folder / "notice.txt").write_text("For a thesis.")
    options = ["--title", "T!", "--notice", "notice.txt", "--contact", "C!"]
    assert make(*options, "--pairs", "--key", "k.json") == 0
    page = (folder / "out" / "index.html").read_text()
    for text in ("<title>T!</title>", "<p>For a thesis.</p>", "C!", "6 pages"):
        assert text in page
    assert (folder / "k.json").is_file()


def test_answers_are_analysed_into_files(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("scipy")
    pytest.importorskip("matplotlib")
    assert make() == 0
    write_answers(folder / "out.key.json", folder)
    capsys.readouterr()
    arguments = [
        "survey", "analyse", "0.json", "1.json", "2.json",
        "--key", "out.key.json", "--engines", "unity,frostbite",
        "--csv", "ratings.csv", "--plot", "plot.png",
    ]  # fmt: skip
    assert main(arguments) == 0
    assert capsys.readouterr().out.endswith(
        "moka - unity: +0.00, 90 % interval 0.00 to 0.00: equivalent\n"
        "moka - frostbite: +0.00, 90 % interval 0.00 to 0.00: equivalent\n"
        "rated like unity, frostbite with a margin of 1: yes\n"
    )
    assert (folder / "ratings.csv").read_text().count("\n") == 19
    assert (folder / "plot.png").stat().st_size > 1000
    assert main([*arguments, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["participants"] == 3
    assert found["criterion"]["met"] is True


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--group", "{scene}"], "--group {scene}: needs {scene} and"),
        (["--notice", "no.txt"], "no.txt: cannot read the notice: No such"),
        (["--exposure", "inf"], "--exposure: must be finite"),
        (["--key", "out/key.json"], "the folder out is missing"),
        (["--nonsense"], "unrecognized arguments: --nonsense"),
    ],
)
@pytest.mark.usefixtures("folder")
def test_a_mistake_is_one_line(
    options: list[str],
    message: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert make(*options) == 2
    printed = capsys.readouterr().err
    assert printed.startswith("moka: error: ")
    assert message in printed
    assert printed.count("\n") == 1
    assert not Path("out").exists()


def test_the_margin_is_positive(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["survey", "analyse", "a.json", "--key", "k", "--margin", "0"]
    assert main(arguments) == 2
    assert "--margin: must be positive" in capsys.readouterr().err
