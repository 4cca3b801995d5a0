#!/usr/bin/env python3
"""Multiplies each tuning value of the engine by given factors, one at a time, and tells what that changes.

    tools/sensitivity.py [--factors 0.67 1.33] [--only localise trial.min_way_m ...] [--logs intel fr079 office run.lcm]
                         [--at-once DRAWS] [--first-draw N] [--jobs N] [--build DIR] [--data DIR] [--cache DIR]

The values are those of `isthmus-replay --list-tuning` and of [engine] in isthmus.example.toml. A log is a recorded log
or set of the data (see benchmark.py), a scenario of isthmus-simulate, which is run with seed 1, or an LCM event log;
what is imported or simulated is kept in the cache for the next run. Integers are rounded, and left out where a factor
leaves them as they are; of a probability above one half it is the rest to 1 that is multiplied.

A row of the table is a value, a factor and a log of which another map came out: islands, mean errors and CPU time, each
after the same of the defaults. The largest changes of errors and islands come first.

With --at-once all values move together, each by a factor drawn at random, in so many draws. A run fails that ends on more
islands than the defaults do, or with a relation more than 1 m off (and more than the defaults'). Of a run that fails,
values are set back by halves as long as it still fails: what is left is what broke it.
"""

import argparse
import concurrent.futures
import json
import math
import os
import random
import re
import subprocess
import sys
import tempfile

import benchmark

ROOT = benchmark.ROOT
ERRORS = [(kind, part, unit) for kind in ("intra", "inter")
          for part, unit in (("translation_m", "m"), ("rotation_deg", "°"))]
FAILED_M = 1.0


class Value:
    """A number of the configuration: the table and key that set it, its default as written, and its unit."""

    def __init__(self, table, key, default, unit):
        self.table, self.key, self.default, self.unit = table, key, default, unit

    @property
    def name(self):
        return self.key if self.table == "tuning" else f"{self.table}.{self.key}"

    def times(self, factor):
        """As it is to be written; nothing where it stays as it is."""
        if re.fullmatch(r"-?\d+", self.default):
            changed = str(round(int(self.default) * factor))
        elif self.unit.startswith("probability") and float(self.default) > 0.5:
            changed = repr(1 - (1 - float(self.default)) * factor)
        elif self.unit == "share":
            changed = repr(min(1.0, float(self.default) * factor))
        else:
            changed = repr(float(self.default) * factor)
        return None if float(changed) == float(self.default) else changed

    def configuration(self, changed):
        return f"[{self.table}]\n{self.key} = {changed}\n"


def values_of(tools):
    """All that can be set, in the order of the listing."""
    with open(os.path.join(ROOT, "server", "isthmus.example.toml"), encoding="utf-8") as file:
        engine = file.read().split("#[engine]")[1].split("#[")[0]
    for key, default in re.findall(r"^#(\w+) = (\S+)$", engine, re.MULTILINE):
        yield Value("engine", key, default if "." in default else default + ".0", "share" if "share" in key else "")
    unit = ""
    for line in tools.run("replay", "--list-tuning").splitlines():
        if line.startswith("# "):
            unit = line[2:].split(":")[0]
        elif " = " in line:
            yield Value("tuning", *line.split(" = "), unit)


class Log:
    """An LCM event log and what isthmus-evaluate needs to know of the truth; nothing of a log without."""

    def __init__(self, name, path, truth):
        self.name, self.path, self.truth = name, path, truth


def log_of(tools, data, cache, name):
    if os.path.exists(name):
        return Log(os.path.basename(name), name, [])
    path = os.path.join(cache, name + ".lcm")
    for found, arguments, relations in [*benchmark.single_logs(data), *benchmark.team_sets(data)]:
        if found == name:
            if not os.path.exists(path):
                tools.run("import", "carmen", *arguments, "-o", path)
            return Log(name, path, ["--relations", relations])
    truth = os.path.join(cache, name + "-truth")
    if not os.path.exists(path):
        tools.run("simulate", "--scenario", name, "--seed", "1", "-o", path, "--truth", truth)
    return Log(name, path, ["--truth", truth])


def outcome(tools, log, configuration):
    """What a configuration makes of a log: map_sha256, islands, CPU time and mean errors by kind; or the failure."""
    with tempfile.TemporaryDirectory() as work:
        config, output = os.path.join(work, "configuration.toml"), os.path.join(work, "map")
        with open(config, "w", encoding="utf-8") as file:
            file.write(configuration)
        try:
            summary = json.loads(tools.run("replay", log.path, "--config", config, "--output", output, "--json"))
            truth = json.loads(tools.run("evaluate", *log.truth, "--output", output, "--json")) if log.truth else {}
        except RuntimeError as error:
            return {"failed": str(error)}
    errors = truth.get("relations", {})
    found = {name: summary[name] for name in ("map_sha256", "islands", "cpu_s")}
    for kind, part, _ in ERRORS:
        if errors.get(kind, {}).get("count"):
            found[kind, part] = errors[kind][part]["mean"]
            found["largest_m"] = max(found.get("largest_m", 0), errors[kind]["translation_m"]["max"])
    return found


def fails(before, after):
    return ("failed" in after or after["islands"] > before["islands"]
            or after.get("largest_m", 0) > max(FAILED_M, before.get("largest_m", 0)))


def effect(before, after):
    """How much another map differs: the largest logarithm of a ratio of errors, and one for each island."""
    if "failed" in after:
        return math.inf
    ratios = [abs(math.log(max(after[name], 1e-9) / max(before[name], 1e-9)))
              for name in before.keys() & after.keys() if isinstance(name, tuple)]
    return max(ratios, default=0) + abs(after["islands"] - before["islands"])


def cells(before, after):
    if "failed" in after:
        return [after["failed"]] + [""] * (len(ERRORS) + 1)
    errors = [f"{before[name]:.4g} → {after[name]:.4g}" if name in before and name in after else "–"
              for name in ((kind, part) for kind, part, _ in ERRORS)]
    return [f"{before['islands']} → {after['islands']}", *errors, f"{before['cpu_s']:.1f} → {after['cpu_s']:.1f}"]


def runs_of(tools, arguments, logs):
    """(value, factor, changed, log) of all that is to be run."""
    for value in values_of(tools):
        if not wanted(value, arguments):
            continue
        for factor in arguments.factors:
            changed = value.times(factor)
            for log in logs if changed is not None else []:
                yield value, factor, changed, log


def wanted(value, arguments):
    return not arguments.only or any(value.name == only or value.name.startswith(only + ".") for only in arguments.only)


def drawn(values, factors, seed):
    """{value: as it is to be written}, each moved by one of the factors."""
    chance = random.Random(seed)
    moved = {value: value.times(chance.choice(factors)) for value in values}
    return {value: changed for value, changed in moved.items() if changed is not None}


def configuration_of(moved):
    """Of several values, a table each once."""
    tables = {}
    for value, changed in moved.items():
        tables.setdefault(value.table, []).append(f"{value.key} = {changed}\n")
    return "".join(f"[{table}]\n{''.join(lines)}" for table, lines in tables.items())


def culprits(moved, still_fails):
    """The smallest set of values found by which a run still fails (Zeller and Hildebrandt 2002, ddmin)."""
    names, parts = list(moved), 2
    while len(names) > 1:
        size = math.ceil(len(names) / parts)
        pieces = [names[begin:begin + size] for begin in range(0, len(names), size)]
        rests = [[name for name in names if name not in piece] for piece in pieces] if parts > 2 else []
        smaller = next((part for part in pieces + rests if still_fails({name: moved[name] for name in part})), None)
        if smaller is not None:
            parts = 2 if smaller in pieces else max(parts - 1, 2)
            names = smaller
        elif parts >= len(names):
            break
        else:
            parts = min(2 * parts, len(names))
    return names


def at_once(tools, arguments, logs, defaults, pool):
    """Table and causes of draws in which all values move."""
    values = [value for value in values_of(tools) if wanted(value, arguments)]
    draws = [(seed, log, drawn(values, arguments.factors, seed))
             for seed in range(arguments.first_draw, arguments.first_draw + arguments.at_once) for log in logs]
    outcomes = list(pool.map(lambda draw: outcome(tools, draw[1], configuration_of(draw[2])), draws))
    header = ["draw", "log", "islands", *(f"{kind} {unit}" for kind, _, unit in ERRORS), "CPU s", "largest m"]
    benchmark.table(f"{len(values)} values at once", header,
                    [[str(seed), log.name, *cells(defaults[log], after), f"{after.get('largest_m', math.nan):.2f}"]
                     for (seed, log, _), after in zip(draws, outcomes)])
    failed = [draw for draw, after in zip(draws, outcomes) if fails(defaults[draw[1]], after)]
    print(f"\n{len(failed)} of {len(draws)} runs failed", flush=True)

    def cause(draw):
        _, log, moved = draw
        return culprits(moved, lambda part: fails(defaults[log], outcome(tools, log, configuration_of(part))))

    for (seed, log, moved), names in zip(failed, pool.map(cause, failed)):
        print(f"- {seed} {log.name}: " + ", ".join(f"{value.name} {value.default} → {moved[value]}" for value in names), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--factors", type=float, nargs="+", default=[0.67, 1.33])
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="groups, or single values as GROUP.NAME")
    parser.add_argument("--logs", nargs="+", default=["meeting"], metavar="LOG")
    parser.add_argument("--at-once", type=int, default=0, metavar="DRAWS", help="all values together, so often")
    parser.add_argument("--first-draw", type=int, default=1, metavar="N")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--build", default=os.path.join(ROOT, ".build", "release"))
    parser.add_argument("--data", default=os.environ.get("ISTHMUS_DATA", os.path.join(ROOT, "..", "shared", "data")))
    parser.add_argument("--cache", default=os.path.join(ROOT, ".build", "sensitivity"))
    arguments = parser.parse_args()
    os.makedirs(arguments.cache, exist_ok=True)
    tools = benchmark.Tools(arguments.build, arguments.cache)
    logs = [log_of(tools, arguments.data, arguments.cache, name) for name in arguments.logs]
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        defaults = dict(zip(logs, pool.map(lambda log: outcome(tools, log, ""), logs)))
        for log, before in defaults.items():
            if "failed" in before:
                print(f"{log.name}: {before['failed']}", file=sys.stderr)
                return 1
        if arguments.at_once:
            at_once(tools, arguments, logs, defaults, pool)
            return 0
        runs = list(runs_of(tools, arguments, logs))
        outcomes = list(pool.map(lambda run: outcome(tools, run[3], run[0].configuration(run[2])), runs))
    others = [(run, after) for run, after in zip(runs, outcomes)
              if after.get("map_sha256") != defaults[run[3]]["map_sha256"]]
    others.sort(key=lambda row: -effect(defaults[row[0][3]], row[1]))
    header = ["value", "default", "factor", "log", "islands", *(f"{kind} {unit}" for kind, _, unit in ERRORS), "CPU s"]
    benchmark.table("Other maps", header,
                    [[value.name, value.default, f"{factor:g}", log.name, *cells(defaults[log], after)]
                     for (value, factor, _, log), after in others])
    changing = {run[0].name for run, _ in others}
    same = sorted({run[0].name for run in runs} - changing)
    print(f"\n{len(runs)} runs of {len(same) + len(changing)} values; the same map with: {', '.join(same) or 'none'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
