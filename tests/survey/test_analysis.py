"""From answers to verdicts, on ratings made up for the purpose."""

import csv
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from moka.cli.main import main
from moka.core.errors import OptionError
from moka.survey.analysis import Analysis, analyse
from moka.survey.answers import Answers, Rating, read_answers, read_key
from moka.survey.report import as_json, as_text, write_csv

RENDERERS = ("engine", "moka", "phong")


def answers_of(
    rate: Callable[[int, str, str], int],
    *,
    participants: int = 12,
    scenes: tuple[str, ...] = ("a", "b"),
    renderers: tuple[str, ...] = RENDERERS,
) -> Answers:
    """What ``rate(participant, scene, renderer)`` gives."""
    ratings = [
        Rating(person, position, 0, scene, name, rate(person, scene, name))
        for person in range(participants)
        for position, (scene, name) in enumerate(
            (scene, name) for scene in scenes for name in renderers
        )
    ]
    return Answers(ratings, participants, 0)


def shifted(shift: int, spread: int) -> Answers:
    """moka differs from the engine by ``shift``, give or take."""

    def rate(person: int, _: str, name: str) -> int:
        base = 5 + person % 2
        if name == "moka":
            return base + shift + (spread if person % 4 < 2 else -spread)
        return base if name == "engine" else 2

    return answers_of(rate)


def verdict(answers: Answers, margin: float = 1.0) -> str:
    found = analyse(answers, engines=["engine"], margin=margin)
    assert found.criterion is not None
    (each,) = found.criterion.verdicts
    accepted = each.verdict in ("equivalent", "not worse")
    assert found.criterion.met is accepted
    return each.verdict


def test_the_four_verdicts() -> None:
    assert verdict(shifted(0, 0)) == "equivalent"
    assert verdict(shifted(0, 1), margin=0.7) == "equivalent"
    assert verdict(shifted(2, 1)) == "not worse"
    assert verdict(shifted(-3, 1)) == "worse"
    assert verdict(shifted(0, 1), margin=0.3) == "undecided"
    assert verdict(shifted(-1, 1)) == "undecided"


def test_no_verdict_from_one_person() -> None:
    def rate(*_: object) -> int:
        return 5

    assert verdict(answers_of(rate, participants=1)) == "undecided"


def test_every_engine_counts() -> None:
    found = analyse(shifted(0, 0), engines=["engine", "phong"])
    assert found.criterion is not None
    assert [each.verdict for each in found.criterion.verdicts] == [
        "equivalent",
        "not worse",
    ]
    found = analyse(shifted(-4, 0), engines=["phong", "engine"])
    assert found.criterion is not None
    assert not found.criterion.met


def test_renderers_come_best_first_with_ranks() -> None:
    found = analyse(shifted(1, 0))
    assert [each.name for each in found.renderers] == [
        "moka", "engine", "phong"
    ]  # fmt: skip
    assert [each.rank for each in found.renderers] == [1.0, 2.0, 3.0]
    assert found.renderers[0].ratings.mean == 6.5
    assert found.criterion is None
    assert [(each.first, each.second) for each in found.pairs] == [
        ("moka", "engine"),
        ("moka", "phong"),
        ("engine", "phong"),
    ]
    assert found.pairs[0].difference.mean == 1.0
    assert found.pairs[0].p_t == 0.0


def test_the_unit_is_the_participant() -> None:
    # Many scenes do not make a few people into many.
    def rate(person: int, _: str, name: str) -> int:
        return 4 + person + (name == "moka")

    few = answers_of(rate, participants=4, scenes=("a",))
    many = answers_of(rate, participants=4, scenes=tuple("abcdefgh"))
    first, second = analyse(few), analyse(many)
    assert first.renderers == second.renderers
    assert first.renderers[0].ratings.count == 4


def test_a_picture_seen_twice_has_the_mean_of_its_ratings() -> None:
    ratings = [
        Rating(0, 0, 0, "a", "moka", 4),
        Rating(0, 1, 0, "a", "engine", 5),
        Rating(0, 2, 1, "a", "moka", 7),
        Rating(0, 3, 1, "a", "phong", 1),
    ]
    found = analyse(Answers(ratings, 1, 0))
    assert found.renderers[0].name == "moka"
    assert found.renderers[0].ratings.mean == 5.5


def test_pairs_are_compared_over_scenes_that_both_have() -> None:
    pictures = [("a", "moka", 5), ("a", "x", 4), ("b", "moka", 9)]
    pictures += [("b", "y", 3), ("c", "x", 2), ("c", "z", 2)]
    ratings = [
        Rating(person, place, 0, scene, name, rating)
        for person in range(3)
        for place, (scene, name, rating) in enumerate(pictures)
    ]
    found = analyse(Answers(ratings, 3, 0), engines=["x"])
    means = {
        (each.first, each.second): each.difference.mean for each in found.pairs
    }
    assert means[("moka", "x")] == 1.0
    assert ("moka", "z") not in means
    with pytest.raises(OptionError, match="z: shares no scene"):
        analyse(Answers(ratings, 3, 0), engines=["z"])


def test_unknown_names_are_an_error() -> None:
    for candidate, engines, message in (
        ("moka", ["unity"], "unity: is not a renderer of this survey"),
        ("filament", ["engine"], "it has engine, moka, phong"),
        ("moka", ["moka"], "cannot be its own engine"),
    ):
        with pytest.raises(OptionError, match=message):
            analyse(shifted(0, 0), candidate=candidate, engines=engines)


def noisy(engines: tuple[str, ...] = ("engine",)) -> Analysis:
    generator = np.random.default_rng(2)
    return analyse(
        answers_of(lambda *_: int(generator.integers(1, 11))), engines=engines
    )


def test_the_text_has_a_row_each() -> None:
    text = as_text(noisy())
    lines = text.splitlines()
    assert lines[0] == "12 participants, 2 scenes"
    assert [line.split()[0] for line in lines[3:6]] == [
        each.name for each in noisy().renderers
    ]
    assert "moka - engine: " in text
    assert "rated like engine with a margin of 1: " in text
    assert len({len(line) for line in lines[2:6]}) == 1


def test_json_has_null_for_what_is_not_known() -> None:
    found = json.loads(as_json(analyse(answers_of(lambda *_: 5))))
    assert found["criterion"] is None
    one = answers_of(lambda *_: 5, participants=1)
    found = json.loads(as_json(analyse(one, engines=["engine"])))
    assert found["renderers"][0]["ratings"]["low"] is None
    assert found["criterion"]["met"] is False


def test_the_table_has_a_row_per_rating(tmp_path: Path) -> None:
    path = tmp_path / "ratings.csv"
    write_csv(shifted(0, 1), path)
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 12 * 6
    assert rows[0] == {
        "participant": "1", "position": "1", "set": "1", "scene": "a",
        "renderer": "engine", "rating": "5",
    }  # fmt: skip
    with pytest.raises(OptionError, match="cannot write the table"):
        write_csv(shifted(0, 1), tmp_path / "no" / "ratings.csv")


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_a_plot_is_drawn(suffix: str, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from moka.survey.plot import plot

    path = tmp_path / f"plot{suffix}"
    plot(noisy(), path)
    assert path.stat().st_size > 1000


def test_a_plot_of_one_person_has_no_intervals(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    from moka.survey.plot import plot

    one = analyse(answers_of(lambda *_: 5, participants=1))
    plot(one, tmp_path / "plot.png")
    with pytest.raises(OptionError, match="needs the ending"):
        plot(one, tmp_path / "plot.gif")
    with pytest.raises(OptionError, match="cannot write the plot"):
        plot(one, tmp_path / "no" / "plot.png")


KEY = {
    "survey_key": 1,
    "survey": "abc",
    "pictures": {
        "1.png": {"scene": "a", "renderer": "moka", "file": "x"},
        "2.png": {"scene": "a", "renderer": "engine", "file": "y"},
    },
    "sets": [["1.png", "2.png"]],
}


def ratings_file(path: Path, first: int = 7, second: int = 5) -> Path:
    ratings = [
        {"set": 0, "picture": "2.png", "rating": second},
        {"set": 0, "picture": "1.png", "rating": first},
    ]
    data = {
        "survey_answers": 1, "survey": "abc", "consent": True,
        "ratings": ratings,
    }  # fmt: skip
    path.write_text(json.dumps(data))
    return path


@pytest.fixture
def key_file(tmp_path: Path) -> Path:
    path = tmp_path / "key.json"
    path.write_text(json.dumps(KEY))
    return path


def test_files_are_read_in_the_order_shown(
    tmp_path: Path, key_file: Path
) -> None:
    answers = read_answers(
        [ratings_file(tmp_path / "one.json")], read_key(key_file)
    )
    assert answers.ratings == [
        Rating(0, 0, 0, "a", "engine", 5),
        Rating(0, 1, 0, "a", "moka", 7),
    ]


def test_a_file_counts_once_and_in_no_order_of_files(
    tmp_path: Path, key_file: Path
) -> None:
    key = read_key(key_file)
    one = ratings_file(tmp_path / "one.json", 7)
    two = ratings_file(tmp_path / "two.json", 8)
    copy = ratings_file(tmp_path / "copy.json", 7)
    answers = read_answers([one, two, copy], key)
    assert (answers.participants, answers.repeated) == (2, 1)
    assert answers.ratings == read_answers([two, one], key).ratings


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"survey": "other"}, "survey: these answers belong to another"),
        ({"consent": False}, "consent: was not given"),
        ({"ratings": None}, "ratings: is missing or no list"),
        ({"ratings": []}, "not one of each of the 2 pictures"),
        ({"ratings": [3]}, "ratings[0]: does not name a set and a picture"),
        ({"survey_answers": 2}, "version 2 is not 1"),
        *(
            (
                {"ratings": [{"set": 0, "picture": "1.png", "rating": value}]},
                f"ratings[0].rating: {value!r} is no whole number",
            )
            for value in (0, 11, 5.5, True, None, "5")
        ),
        (
            {"ratings": [{"set": 0, "picture": "1.png", "rating": 5}] * 2},
            "not one of each of the 2 pictures",
        ),
    ],
)
def test_a_broken_file_is_one_line(
    change: dict[str, object],
    message: str,
    tmp_path: Path,
    key_file: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = ratings_file(tmp_path / "one.json")
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    arguments = ["survey", "analyse", str(path), "--key", str(key_file)]
    assert main(arguments) == 2
    printed = capsys.readouterr().err
    assert printed.startswith(f"moka: error: {path}: ")
    assert message in printed
    assert printed.count("\n") == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "not valid JSON"),
        ("[" * 100000, "not valid JSON"),
        ("[]", "has no survey_key: a file of another kind"),
        ('{"survey_answers": 1}', "has no survey_key"),
        ('{"survey_key": 1}', "is not a whole key"),
        (
            '{"survey_key": 1, "survey": "", "pictures": {}, "sets": [["x"]]}',
            "sets[0]: x is not among the pictures",
        ),
        (None, "cannot read: No such file"),
    ],
)
def test_a_broken_key_is_one_line(
    text: str | None, message: str, tmp_path: Path
) -> None:
    path = tmp_path / "key.json"
    if text is not None:
        path.write_text(text)
    with pytest.raises(OptionError) as caught:
        read_key(path)
    assert message in str(caught.value)
