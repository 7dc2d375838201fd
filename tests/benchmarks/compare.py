"""Run command lines alternately and compare their time and memory.

    python tests/benchmarks/compare.py -n 9 \\
        --name moka 'moka render MODEL --environment SKY --no-cache' \\
        --name bare 'python tests/benchmarks/bare_moderngl.py MODEL SKY'

Every run is a fresh process, in the order A B A B, so that a machine that
grows slower does so for all of them. The first command is the base of the
ratios. On a shared machine the CPU time (user and system, of the process and
its children) is steadier than the wall time; memory is the peak of the
resident set.
"""

import argparse
import json
import os
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median, quantiles

MEASURES = ("wall_ms", "cpu_ms", "peak_rss_mb")


def run(command: str, environment: dict[str, str]) -> dict[str, float]:
    """The measures of one process; exits with its output if it fails."""
    with tempfile.TemporaryFile() as output:
        start = time.perf_counter()
        process = subprocess.Popen(
            shlex.split(command),
            stdout=output,
            stderr=subprocess.STDOUT,
            env=environment,
        )
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            output.seek(0)
            sys.stderr.write(output.read().decode(errors="replace"))
            sys.exit(f"exit code {process.returncode}: {command}")
    return {
        "wall_ms": wall * 1e3,
        "cpu_ms": (usage.ru_utime + usage.ru_stime) * 1e3,
        "peak_rss_mb": usage.ru_maxrss / 1024,
    }


def measure(
    commands: dict[str, str], runs: int, warm_up: int, cold: bool
) -> dict[str, list[dict[str, float]]]:
    """The runs of each named command, taken in turn.

    With ``cold`` each run, of the warm-up too, gets an empty shader cache.
    """
    results: dict[str, list[dict[str, float]]] = {name: [] for name in commands}
    for index in range(warm_up + runs):
        for name, command in commands.items():
            environment = dict(os.environ)
            with tempfile.TemporaryDirectory() as cache:
                if cold:
                    environment["MESA_SHADER_CACHE_DIR"] = cache
                result = run(command, environment)
            if index >= warm_up:
                results[name].append(result)
    return results


def summary(
    results: dict[str, list[dict[str, float]]],
) -> dict[str, dict[str, dict[str, float]]]:
    """Median, minimum, quartiles and ratio of medians per measure."""
    table: dict[str, dict[str, dict[str, float]]] = {}
    base = next(iter(results))
    for name, runs in results.items():
        table[name] = {}
        for key in MEASURES:
            values = [run[key] for run in runs]
            low, _, high = (
                quantiles(values, method="inclusive")
                if len(values) > 1
                else values * 3
            )
            middle = median(values)
            table[name][key] = {
                "median": round(middle, 2),
                "minimum": round(min(values), 2),
                "quartile_1": round(low, 2),
                "quartile_3": round(high, 2),
                "ratio": round(
                    middle / median(run[key] for run in results[base]), 3
                ),
            }
    return table


def print_table(table: dict[str, dict[str, dict[str, float]]]) -> None:
    """The summary for a person."""
    width = max(map(len, table))
    print(
        f"{'':{width}}  {'wall ms':>8} {'min':>7} {'quartiles':>15} "
        f"{'ratio':>6}  {'CPU ms':>8} {'ratio':>6}  {'MiB':>6} {'ratio':>6}"
    )
    for name, row in table.items():
        wall, cpu, rss = (row[key] for key in MEASURES)
        spread = f"{wall['quartile_1']:.0f} to {wall['quartile_3']:.0f}"
        print(
            f"{name:{width}}  {wall['median']:8.0f} {wall['minimum']:7.0f} "
            f"{spread:>15} {wall['ratio']:6.2f}  {cpu['median']:8.0f} "
            f"{cpu['ratio']:6.2f}  {rss['median']:6.0f} {rss['ratio']:6.2f}"
        )


def main() -> None:
    """Read the arguments, run, print the table and the JSON."""
    parser = argparse.ArgumentParser(
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--name",
        nargs=2,
        action="append",
        required=True,
        metavar=("NAME", "COMMAND"),
        help="a command line and what to call it; repeat for each rival",
    )
    parser.add_argument("-n", "--runs", type=int, default=5)
    parser.add_argument("--warm-up", type=int, default=1, metavar="RUNS")
    parser.add_argument(
        "--cold-shader-cache",
        action="store_true",
        help="give each run an empty MESA_SHADER_CACHE_DIR",
    )
    parser.add_argument("--json", type=Path, help="also write it to a file")
    options = parser.parse_args()
    commands = dict(options.name)
    if len(commands) < len(options.name):
        parser.error("two commands have the same name")
    if options.runs < 1:
        parser.error("--runs must be at least 1")
    results = measure(
        commands, options.runs, options.warm_up, options.cold_shader_cache
    )
    table = summary(results)
    print_table(table)
    text = json.dumps({"commands": commands, "summary": table, "runs": results})
    print(text)
    if options.json:
        options.json.write_text(text + "\n")


if __name__ == "__main__":
    main()
