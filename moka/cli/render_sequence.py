"""The part of ``moka render`` that makes more than one picture."""

import argparse
import time
from collections.abc import Collection
from pathlib import Path

from moka.app.frame_files import FrameFiles, is_moving, numbers_written
from moka.app.render_frames import FramesRequest, request_frames
from moka.app.render_request import RenderRequest
from moka.core.errors import OptionError
from moka.core.moving_picture import check_moving_picture
from moka.core.progress import Progress
from moka.core.statistics import Statistics, write_statistics

__all__ = ["render_sequence"]

DEFAULT_FPS = 30.0


def render_sequence(
    arguments: argparse.Namespace,
    request: RenderRequest,
    outputs: list[Path],
) -> int:
    """Render the frames into every output; returns the exit code.

    What has been written when an error comes stays if it is whole. Raises
    MokaError.
    """
    rate = DEFAULT_FPS if arguments.fps is None else arguments.fps
    wanted = FramesRequest(arguments.frames, arguments.turntable, rate)
    wanted.check()
    moving = [path for path in outputs if is_moving(path)]
    if arguments.resume and moving:
        raise OptionError(
            f"{moving[0]}: a moving picture cannot be resumed; write "
            "numbered .png files"
        )
    for path in moving:
        check_moving_picture(
            path,
            request.size,
            rate,
            transparent=request.background == "transparent",
        )
    statistics = Statistics(arguments.started)
    statistics.add_time("import", time.perf_counter() - arguments.started)
    suffixes = {path.suffix.lower() for path in outputs}
    with Progress("frame", 0, is_shown=not arguments.quiet) as progress:

        def announce(count: int) -> Collection[int]:
            there = (
                numbers_written(outputs, count)
                if arguments.resume
                else frozenset[int]()
            )
            progress.total = count - len(there)
            return there

        frames = request_frames(
            request,
            wanted,
            statistics,
            want_pixels=".exr" in suffixes,
            want_display=bool(suffixes - {".exr"}),
            debug=arguments.debug,
            cache=not arguments.no_cache,
            announce=announce,
        )
        with FrameFiles(outputs, rate, half=arguments.half) as files:
            for number, image in frames:
                with statistics.stage("encode"):
                    files.write(number, image)
                progress.step()
    if arguments.stats:
        write_statistics(statistics, arguments.stats)
    return 0
