#!/usr/bin/env python3
"""Imports, replays and evaluates every recorded log and set it finds and two simulated ones, and prints tables.

    tools/benchmark.py [--build DIR] [--data DIR] [--keep DIR] [NAME ...]

Data: DIR/bench/NAME.clf.gz with NAME.relations, DIR/multi/NAME/ (r*.clf.gz, robots.csv, sightings*.csv,
outliers.csv, relations.csv), DIR/mrclam/NAME/, DIR/posegraph/NAME.g2o.gz; by default ${ISTHMUS_DATA:-../shared/data}. NAMEs select logs.
"""

import argparse
import csv
import glob
import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))

# Where a log's laser sits, for logs that do not say it themselves.
MOUNTS = {"fr079": ["--laser-x", "-0.04"]}

SCENARIOS = ["courtyards", "double_spiral"]


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

    def results(self, runs):
        """What each (name, function) returns; those that fail are told and left out."""
        found = []
        for name, run in runs:
            print(f"{name} ...", file=sys.stderr, flush=True)
            try:
                found.append(run())
            except RuntimeError as error:
                print(f"{name}: {error}", file=sys.stderr)
                self.failed = True
        return found

    def folder(self, name):
        return os.path.join(self.work, name)

    def replay(self, name, log, *truth):
        """Maps and evaluates one log, and removes it; returns (summary of the run, evaluation)."""
        summary = json.loads(self.run("replay", log, "--refine", "--output", self.folder(name), "--json"))
        os.remove(log)
        return summary, json.loads(self.run("evaluate", *truth, "--output", self.folder(name), "--json"))

    def map(self, name, import_arguments, relations):
        """Imports, replays and evaluates one log or set; returns (name, summary of the run, errors by kind)."""
        log = self.folder(name) + ".lcm"
        self.run("import", "carmen", *import_arguments, "-o", log)
        summary, evaluation = self.replay(name, log, "--relations", relations)
        return name, summary, evaluation["relations"]


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
        for ending, sightings in (("", "sightings.csv"), ("+false", "sightings_with_outliers.csv"), ("+unseen", None)):
            seen = ["--sightings", folder + sightings] if sightings else []
            yield name + ending, [*robots, *seen], folder + "relations.csv"


def false_sightings(folder, ending):
    """What tells a set's false sightings: stamp, observer and barcode; none in the other sets."""
    if ending != "false":
        return set()
    with open(os.path.join(folder, "outliers.csv"), newline="") as file:
        return {(row["utime_us"], row["observer"].upper(), row["barcode"]) for row in csv.DictReader(file)}


def accepted_sightings(output, false_ones):
    """Of the true and of the false sightings in a map's sightings.csv: "accepted / all"."""
    counts = {False: [0, 0], True: [0, 0]}
    with open(os.path.join(output, "sightings.csv"), newline="") as file:
        for row in csv.DictReader(file):
            count = counts[(row["utime_us"], row["observer"].upper(), row["barcode"]) in false_ones]
            count[0] += row["verdict"] == "accepted"
            count[1] += 1
    return [f"{accepted} / {total}" for accepted, total in (counts[False], counts[True])]


def meeting_cells(tools, name, summary, errors, false_ones):
    cells = [str(summary["islands"]), *accepted_sightings(tools.folder(name), false_ones)]
    for kind in ("intra", "inter"):
        found = errors.get(kind, {"count": 0})
        cells.append("–" if found["count"] == 0 else
                     f"{found['translation_m']['mean']:.4f} / {found['rotation_deg']['mean']:.3f}")
    return [name, *cells, *run_cells(summary)]


def run_cells(summary):
    """CPU time, and the slowest event by the clock and by CPU time."""
    return [f"{summary['cpu_s']:.1f}", f"{summary['event_latency_ms']['max']:.1f} / {summary['event_cpu_ms']['max']:.1f}"]


def meetings(tools, teams, data):
    for name, summary, errors in teams:
        folder, _, ending = name.partition("+")
        yield meeting_cells(tools, name, summary, errors, false_sightings(os.path.join(data, "multi", folder), ending))


def simulated(tools, name):
    log, truth = tools.folder(name) + ".lcm", tools.folder(name) + "-truth"
    tools.run("simulate", "--scenario", name, "--seed", "1", "-o", log, "--truth", truth)
    summary, evaluation = tools.replay(name, log, "--truth", truth)
    return meeting_cells(tools, name, summary, evaluation["relations"], false_sightings(truth, "false"))


def mrclam_sets(data):
    for folder in sorted(glob.glob(os.path.join(data, "mrclam", "*", ""))):
        name = os.path.basename(os.path.dirname(folder))
        yield name, folder, []
        yield name + "+landmarks-only", folder, ["--without-robot-sightings"]


def mrclam(tools, name, folder, options):
    log, truth = tools.folder(name) + ".lcm", tools.folder(name) + "-truth"
    tools.run("import", "mrclam", folder, *options, "-o", log, "--truth", truth)
    summary, evaluation = tools.replay(name, log, "--truth", truth)
    return [name, str(summary["islands"]), *absolute_cells(evaluation), *run_cells(summary)]


def absolute_cells(evaluation):
    """Mean errors of robots and of landmarks, each island aligned with the truth as a whole."""
    islands = evaluation["absolute_islands"]

    def mean(count, value):
        total = sum(island[count] for island in islands)
        return sum(island[count] * value(island) for island in islands if island[count]) / total if total else None

    def cell(value):
        return "–" if value is None else f"{value:.3f}"

    tags = sum(island["tags"] for island in islands)
    return [cell(mean("count", lambda island: island["translation_m"]["mean"])),
            cell(mean("count", lambda island: island["rotation_deg"]["mean"])),
            f"{tags} / {tags + evaluation['missing_tags']}",
            cell(mean("tags", lambda island: island["tag_translation_m"]["mean"]))]


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
        return not arguments.names or any(part.lower() in name.lower() for part in arguments.names)

    with tempfile.TemporaryDirectory() as scratch:
        work = arguments.keep or scratch
        os.makedirs(work, exist_ok=True)
        tools = Tools(arguments.build, work)
        tools.failed = False

        def run(one_of, logs):
            return tools.results((log[0], lambda log=log: one_of(*log)) for log in logs if wanted(log[0]))

        singles = run(tools.map, single_logs(arguments.data))
        teams = run(tools.map, team_sets(arguments.data))
        scenarios = run(lambda name: simulated(tools, name), ((name,) for name in SCENARIOS))
        landmarks = run(lambda *log: mrclam(tools, *log), mrclam_sets(arguments.data))
        error_header = ["relations (missing)", "translation m", "median m", "rotation °"]
        table("Accuracy, one robot", ["log", *error_header],
              [[name, *error_cells(errors.get("intra"))] for name, _, errors in singles])
        table("Accuracy, several robots", ["set", "kind", *error_header],
              [[name, kind, *error_cells(errors.get(kind))] for name, _, errors in teams for kind in ("intra", "inter")])
        meeting_header = ["islands", "true accepted", "false accepted", "intra m / °", "inter m / °", "CPU s",
                          "slowest event ms, CPU ms"]
        table("Meetings, recorded sets (mean errors)", ["set", *meeting_header],
              list(meetings(tools, teams, arguments.data)))
        table("Meetings, simulated (mean errors)", ["scenario", *meeting_header], scenarios)
        table("Robots without lasers (mean errors)",
              ["set", "islands", "robots m", "robots °", "landmarks placed", "landmarks m", "CPU s",
               "slowest event ms, CPU ms"], landmarks)
        table("Cost", ["log", "scans", "matched", "CPU s", "peak MB", "event ms p50 / p99 / max", "CPU ms p99 / max",
                       "per scan, last : second tenth", "patches", "islands", "map_sha256"],
              [[name, *cost_cells(summary)] for name, summary, _ in singles + teams])
        table("Pose graphs, one batch", ["graph", "patches", "relations", "F before", "F", "CPU ms"],
              list(pose_graphs(tools, arguments.data, wanted)))
    return 1 if tools.failed else 0


if __name__ == "__main__":
    sys.exit(main())
