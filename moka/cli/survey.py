"""Make a blind survey of pictures, and analyse its answers."""

import argparse
import math
from collections.abc import Callable
from pathlib import Path

from moka.cli.diagnostics import add_diagnostics
from moka.core.errors import OptionError
from moka.survey.grouping import DEFAULT_PATTERN

__all__ = ["add_arguments", "execute"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the subcommands ``make`` and ``analyse``."""
    commands = parser.add_subparsers(
        title="commands", metavar="COMMAND", required=True
    )
    for name, summary, add, run in (
        ("make", "Write a survey to hand out, and its key.", _add_make, _make),
        (
            "analyse",
            "Means, intervals and paired tests of the answers.",
            _add_analyse,
            _analyse,
        ),
    ):
        command = commands.add_parser(
            name, help=summary, description=summary, allow_abbrev=False
        )
        add_diagnostics(command, nested=True)
        add(command)
        command.set_defaults(run=run)


def execute(arguments: argparse.Namespace) -> int:
    """Run the chosen subcommand; raises MokaError."""
    run: Callable[[argparse.Namespace], int] = arguments.run
    return run(arguments)


def _add_make(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add(
        "pictures",
        metavar="PICTURE",
        nargs="+",
        type=Path,
        help=".png, .jpg or .exr file, named SCENE@RENDERER (see --group)",
    )
    add(
        "-o",
        "--output",
        metavar="DIR",
        type=Path,
        required=True,
        help="the folder to hand out; must not exist",
    )
    add(
        "--key",
        metavar="PATH",
        type=Path,
        help="where the key goes that names the renderers; keep it to "
        "yourself (default: DIR.key.json)",
    )
    add(
        "--group",
        metavar="FORM",
        default=DEFAULT_PATTERN,
        help="the form of the names, such as {renderer}/{scene} for a "
        "folder per renderer (default: %(default)s)",
    )
    add(
        "--pairs",
        action="store_true",
        help="show the pictures of a scene two at a time, not all at once",
    )
    add(
        "--title",
        metavar="TEXT",
        default="How realistic are these pictures?",
        help="the title of the page (default: %(default)s)",
    )
    add(
        "--notice",
        metavar="FILE",
        type=Path,
        help="text about the study, shown before the consent",
    )
    add(
        "--contact",
        metavar="TEXT",
        default="",
        help="to whom the answers are to be handed",
    )
    add(
        "--credits",
        metavar="FILE",
        type=Path,
        action="append",
        default=[],
        help="text, or a .gltf or .glb with a copyright; shown at the end, "
        "beside what the pictures' metadata say; repeatable",
    )
    add(
        "--tone-map",
        metavar="NAME",
        default="neutral",
        help="for EXR files (default: neutral)",
    )
    add(
        "--exposure",
        metavar="EV",
        type=float,
        default=0.0,
        help="stops, for EXR files (default: 0)",
    )


def _make(arguments: argparse.Namespace) -> int:
    if not math.isfinite(arguments.exposure):
        raise OptionError("--exposure: must be finite")
    from moka.survey.make import SurveyOptions, make_survey

    folder = arguments.output
    key = arguments.key or folder.with_name(f"{folder.name}.key.json")
    options = SurveyOptions(
        title=arguments.title,
        pattern=arguments.group,
        pairs=arguments.pairs,
        notice=_text(arguments.notice) if arguments.notice else "",
        contact=arguments.contact,
        credits=arguments.credits,
        tone_map=arguments.tone_map,
        exposure=arguments.exposure,
    )
    count = make_survey(arguments.pictures, folder, key, options)
    pages = "page" if count == 1 else "pages"
    print(f"{folder}: {count} {pages}, to hand out; open index.html")
    print(f"{key}: the key, to keep")
    return 0


def _text(path: Path) -> str:
    try:
        return path.read_text("utf-8")
    except OSError as error:
        raise OptionError(
            f"{path}: cannot read the notice: {error.strerror}"
        ) from error
    except UnicodeDecodeError as error:
        raise OptionError(f"{path}: is not UTF-8 text: {error}") from error


def _add_analyse(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add(
        "answers",
        metavar="ANSWERS",
        nargs="+",
        type=Path,
        help="the files that people saved",
    )
    add(
        "--key",
        metavar="PATH",
        type=Path,
        required=True,
        help="the key that was written with the survey",
    )
    add(
        "--candidate",
        metavar="NAME",
        default="moka",
        help="the renderer in question (default: moka)",
    )
    add(
        "--engines",
        metavar="NAME,...",
        type=lambda text: tuple(text.split(",")),
        default=(),
        help="the renderers that it should be rated like",
    )
    add(
        "--margin",
        metavar="POINTS",
        type=float,
        default=1.0,
        help="how much lower a mean may be and still count as alike "
        "(default: 1)",
    )
    add("--csv", metavar="PATH", type=Path, help="write every rating")
    add(
        "--plot",
        metavar="PATH",
        type=Path,
        help="draw means and differences (.png, .svg or .pdf)",
    )
    add("--json", action="store_true", help="print JSON instead of text")


def _analyse(arguments: argparse.Namespace) -> int:
    if not 0 < arguments.margin < math.inf:
        raise OptionError("--margin: must be positive and finite")
    from moka.survey.analysis import analyse
    from moka.survey.answers import read_answers, read_key
    from moka.survey.report import as_json, as_text, write_csv

    key = read_key(arguments.key)
    answers = read_answers(arguments.answers, key)
    found = analyse(
        answers,
        candidate=arguments.candidate,
        engines=arguments.engines,
        margin=arguments.margin,
    )
    if arguments.csv:
        write_csv(answers, arguments.csv)
    if arguments.plot:
        from moka.survey.plot import plot

        plot(found, arguments.plot)
    print(as_json(found) if arguments.json else as_text(found))
    return 0
