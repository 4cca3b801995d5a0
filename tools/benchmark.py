#!/usr/bin/env python3
"""Imports, replays and evaluates every recorded log and set it finds, and prints tables.

    tools/benchmark.py [--build DIR] [--data DIR] [--keep DIR] [NAME ...]

Data: DIR/bench/NAME.clf.gz with NAME.relations, DIR/multi/NAME/ (r*.clf.gz, robots.csv, sightings*.csv,
relations.csv), DIR/posegraph/NAME.g2o.gz; by default ${ISTHMUS_DATA:-../shared/data}. NAMEs select logs.
"""

import argparse
import glob
import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

# Where a log's laser sits, for logs that do not say it themselves.
MOUNTS = {"fr079": ["--laser-x", "-0.04"]}


class Tools:
    def __init__(self, build, work):
        self.bin = os.path.join(build, "bin")
        self.work = work

    def run(self, command, *arguments):
        program = os.path.join(self.bin, "isthmus-" + command)
        result = subprocess.run([program, *arguments], capture_output=True, text=True)
        if result.returncode != 0:
            raise RuntimeError(f"isthmus-{command} failed: {result.stderr.strip()}")
        return result.stdout

    def map(self, name, import_arguments, relations):
        """Imports, replays and evaluates one log or set; returns (summary of the run, errors by kind)."""
        log = os.path.join(self.work, name + ".lcm")
        output = os.path.join(self.work, name)
        self.run("import", "carmen", *import_arguments, "-o", log)
        summary = json.loads(self.run("replay", log, "--output", output, "--json"))
        errors = self.run("evaluate", "--relations", relations, "--output", output, "--json")
        os.remove(log)
        return summary, json.loads(errors)["relations"]


def name_of(path, ending):
    return os.path.basename(path)[: -len(ending)]


def single_logs(data):
    for log in sorted(glob.glob(os.path.join(data, "bench", "*.clf.gz"))):
        name = name_of(log, ".clf.gz")
        yield name, ["--robot", "R1=" + log, *MOUNTS.get(name, [])], log.replace(".clf.gz", ".relations")


def team_sets(data):
    for folder in sorted(glob.glob(os.path.join(data, "multi", "*", ""))):
        name = os.path.basename(os.path.dirname(folder))
        robots = ["--robots", folder + "robots.csv"]
        for log in sorted(glob.glob(folder + "*.clf.gz")):
            robots += ["--robot", name_of(log, ".clf.gz") + "=" + log]
        for ending, sightings in (("", "sightings.csv"), ("+false", "sightings_with_outliers.csv")):
            yield name + ending, [*robots, "--sightings", folder + sightings], folder + "relations.csv"


def table(title, header, rows):
    if not rows:
        return
    print(f"\n## {title}\n")
    print("| " + " | ".join(header) + " |")
    print("|" + "---|" * len(header))
    for row in rows:
        print("| " + " | ".join(row) + " |", flush=True)


def error_cells(errors):
    if errors is None:
        return ["–"] * 4
    relations = f"{errors['count']} ({errors['missing']})"
    if errors["count"] == 0:
        return [relations, "–", "–", "–"]
    t, r = errors["translation_m"], errors["rotation_deg"]
    return [relations, f"{t['mean']:.4f} ± {t['std']:.4f}",
            f"{t['median']:.4f}", f"{r['mean']:.3f} ± {r['std']:.3f}"]


def cost_cells(summary):
    latency, cpu, per_scan = summary["event_latency_ms"], summary["event_cpu_ms"], summary["scan_cost_ms"]
    growth = per_scan["last_tenth"] / per_scan["second_tenth"] if per_scan["second_tenth"] > 0 else 0
    return [str(summary["scans"]), f"{100 * summary['matched_share']:.2f} %", f"{summary['cpu_s']:.1f}",
            f"{summary['peak_rss_mb']:.0f}", f"{latency['p50']:.2f} / {latency['p99']:.2f} / {latency['max']:.1f}",
            f"{cpu['p99']:.2f} / {cpu['max']:.1f}",
            f"{growth:.2f}", str(summary["patches"]), str(summary["islands"]), summary["map_sha256"][:12]]


def run_all(tools, logs):
    results = []
    for name, arguments, relations in logs:
        print(f"{name} ...", file=sys.stderr, flush=True)
        try:
            results.append((name, *tools.map(name, arguments, relations)))
        except RuntimeError as error:
            print(f"{name}: {error}", file=sys.stderr)
            tools.failed = True
    return results


def pose_graphs(tools, data, wanted):
    for graph in sorted(glob.glob(os.path.join(data, "posegraph", "*.g2o*"))):
        name = os.path.basename(graph).split(".")[0]
        if not wanted("posegraph/" + name):
            continue
        fit = json.loads(tools.run("evaluate", "--g2o", graph, "--json"))["pose_graph"]
        yield [name, str(fit["patches"]), str(fit["relations"]), f"{fit['f_before']:.6g}", f"{fit['f_after']:.8g}",
               f"{fit['cpu_ms']:.0f}"]


def main():
    parser = argparse.ArgumentParser(description="Runs every recorded log and prints tables of accuracy and cost.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="logs, sets (or parts of their names) to run")
    parser.add_argument("--build", default=os.path.join(ROOT, ".build", "release"))
    parser.add_argument("--data", default=os.environ.get("ISTHMUS_DATA", os.path.join(ROOT, "..", "shared", "data")))
    parser.add_argument("--keep", metavar="DIR", help="keep the maps in this directory")
    arguments = parser.parse_args()
    if not os.path.isdir(arguments.data):
        print(f"no recorded data at {arguments.data}: set ISTHMUS_DATA", file=sys.stderr)
        return 1

    def wanted(name):
        return not arguments.names or any(part in name for part in arguments.names)

    with tempfile.TemporaryDirectory() as scratch:
        work = arguments.keep or scratch
        os.makedirs(work, exist_ok=True)
        tools = Tools(arguments.build, work)
        tools.failed = False
        singles = run_all(tools, [log for log in single_logs(arguments.data) if wanted(log[0])])
        teams = run_all(tools, [log for log in team_sets(arguments.data) if wanted(log[0])])
        error_header = ["relations (missing)", "translation m", "median m", "rotation °"]
        table("Accuracy, one robot", ["log", *error_header],
              [[name, *error_cells(errors.get("intra"))] for name, _, errors in singles])
        table("Accuracy, several robots", ["set", "kind", *error_header],
              [[name, kind, *error_cells(errors.get(kind))] for name, _, errors in teams for kind in ("intra", "inter")])
        table("Cost", ["log", "scans", "matched", "CPU s", "peak MB", "event ms p50 / p99 / max", "CPU ms p99 / max",
                       "per scan, last : second tenth", "patches", "islands", "map_sha256"],
              [[name, *cost_cells(summary)] for name, summary, _ in singles + teams])
        table("Pose graphs, one batch", ["graph", "patches", "relations", "F before", "F", "CPU ms"],
              list(pose_graphs(tools, arguments.data, wanted)))
    return 1 if tools.failed else 0


if __name__ == "__main__":
    sys.exit(main())
