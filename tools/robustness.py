#!/usr/bin/env python3
"""Maps recorded drives as slightly different robots would have recorded them, and tells which runs fail.

    tools/robustness.py [--kinds K ...] [--seeds 1 2 3] [--refine] [--jobs 2] [--most-failures 3] [LOG ...]
    tools/robustness.py --teams [the same] [SET ...]
    tools/robustness.py --list

With --teams it is the sets DIR/multi/SET, each robot's log changed by itself, its sightings as they are, but for the kinds
that would have been seen otherwise (mirror, late). Each log DIR/bench/LOG.clf.gz (CARMEN, FLASER) with LOG.relations is changed in each kind of way with each seed, imported,
mapped and evaluated. A run fails when a relation is off by more than 1 m, when the robot ends on more than one island or
when no map comes of it; a table has the mean error, of teams that between robots. The exit code is 1 where more than --most-failures runs fail.
"""

import argparse
import bisect
import concurrent.futures
import csv
import dataclasses
import glob
import gzip
import json
import math
import os
import random
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
MOUNTS = {"fr079": ["--laser-x", "-0.04"]}  # of lasers whose logs do not tell
FAILED_M = 1.0


@dataclasses.dataclass
class Reading:
    """One line of odometry (no ranges) or of a scan, with the odometry's pose of that moment."""

    ranges: list
    pose: tuple  # x, y (m), yaw (rad)
    stamp: float  # s
    rest: list  # the words of the line behind the pose

    @staticmethod
    def parse(line):
        words = line.split()
        if words[0] == "ODOM":
            return Reading([], tuple(map(float, words[1:4])), float(words[7]), words[4:])
        beams = int(words[1])
        at = 2 + beams + 3  # behind the ranges stands the pose of the laser, then that of the robot
        return Reading(list(map(float, words[2:2 + beams])), tuple(map(float, words[at:at + 3])),
                       float(words[at + 3]), words[at + 3:])

    def line(self):
        pose = [f"{value:.6f}" for value in self.pose]
        if not self.ranges:
            return " ".join(["ODOM", *pose, *self.rest[:3], f"{self.stamp:.6f}", *self.rest[4:]])
        ranges = [f"{value:.3f}" for value in self.ranges]
        return " ".join(["FLASER", str(len(ranges)), *ranges, *pose, *pose, f"{self.stamp:.6f}", *self.rest[1:]])


@dataclasses.dataclass
class Relation:
    """What is true of two scans, whatever becomes of their stamps: where one is missing there is nothing to compare."""

    first: Reading
    second: Reading
    motion: list  # words: x y z roll pitch yaw of the second in the first; of a team what its table has behind the times

    def line(self):
        return " ".join([f"{self.first.stamp:.6f}", f"{self.second.stamp:.6f}", *self.motion])


@dataclasses.dataclass
class Drive:
    readings: list
    relations: list
    no_return_m: float  # what this laser writes where nothing comes back

    @staticmethod
    def load(log, relations=os.devnull):
        with gzip.open(log, "rt", encoding="ascii", errors="replace") as file:
            readings = [Reading.parse(line) for line in file if line.startswith(("ODOM ", "FLASER "))]
        drive = Drive(readings, [], max(max(reading.ranges) for reading in readings if reading.ranges))
        scan_at = drive.finder()
        with open(relations, encoding="ascii") as file:
            rows = [line.split() for line in file if line.strip() and not line.startswith("#")]
        drive.relations = [Relation(scan_at(float(words[0])), scan_at(float(words[1])), words[2:]) for words in rows]
        return drive

    def finder(self):
        """Which scan is nearest to a time, by stamps as they are now."""
        scans = sorted(self.scans(), key=lambda scan: scan.stamp)
        stamps = [scan.stamp for scan in scans]

        def scan_at(stamp):
            after = bisect.bisect_left(stamps, stamp)
            return min(scans[max(after - 1, 0):after + 1], key=lambda scan: abs(scan.stamp - stamp))

        return scan_at

    def save(self, log, relations=os.devnull):
        with gzip.open(log, "wt", compresslevel=1, encoding="ascii") as file:
            file.writelines(reading.line() + "\n" for reading in self.readings)
        with open(relations, "w", encoding="ascii") as file:
            kept = {id(reading) for reading in self.readings}
            file.writelines(relation.line() + "\n" for relation in self.relations
                            if id(relation.first) in kept and id(relation.second) in kept)

    def scans(self):
        return (reading for reading in self.readings if reading.ranges)


def mirror(drive, _):
    """left and right exchanged: the same problem with other rounding and other tie-breaks"""
    for reading in drive.readings:
        reading.ranges.reverse()
        x, y, yaw = reading.pose
        reading.pose = (x, -y, -yaw)
    for relation in drive.relations:
        for place in (1, 5):
            relation.motion[place] = f"{-float(relation.motion[place]):.6f}"


def late(drive, chance):
    """begun when 5 to 40 % of the log have passed"""
    stamps = [reading.stamp for reading in drive.readings]
    begin = min(stamps) + chance.uniform(0.05, 0.4) * (max(stamps) - min(stamps))
    drive.readings = [reading for reading in drive.readings if reading.stamp >= begin]


def thin(drive, _):
    """two of three scans missing"""
    missing = {id(scan) for number, scan in enumerate(drive.scans()) if number % 3 != 2}
    drive.readings = [reading for reading in drive.readings if id(reading) not in missing]


def short(drive, _):
    """a laser that sees 8 m"""
    for scan in drive.scans():
        scan.ranges = [drive.no_return_m if value > 8 else value for value in scan.ranges]


def coarse(drive, _):
    """every second beam"""
    for scan in drive.scans():
        scan.ranges = scan.ranges[::2]


def noisy(drive, chance):
    """2 cm of noise on each range, and 3 % of the beams without a return"""
    def spoilt(value):
        if chance.random() < 0.03:
            return drive.no_return_m
        return value if value > drive.no_return_m - 1 else max(0.02, value + chance.gauss(0, 0.02))

    for scan in drive.scans():
        scan.ranges = [spoilt(value) for value in scan.ranges]


def odometry(drive, chance):
    """wheels 3 % off in scale that drift by half a degree a metre, with 5 % of noise"""
    scale = 1 + chance.choice([-1, 1]) * 0.03
    drift = chance.choice([-1, 1]) * math.radians(0.5)
    last = made = drive.readings[0].pose
    for reading in drive.readings:
        dx, dy = reading.pose[0] - last[0], reading.pose[1] - last[1]
        turn = math.remainder(reading.pose[2] - last[2], 2 * math.pi)
        last_cos, last_sin = math.cos(last[2]), math.sin(last[2])
        factor = scale * (1 + chance.gauss(0, 0.05))
        along, across = factor * (last_cos * dx + last_sin * dy), factor * (-last_sin * dx + last_cos * dy)
        last = reading.pose
        cos, sin = math.cos(made[2]), math.sin(made[2])
        made = (made[0] + cos * along - sin * across, made[1] + sin * along + cos * across,
                made[2] + turn + drift * math.hypot(dx, dy) + chance.gauss(0, 0.05) * abs(turn))
        reading.pose = made


def jitter(drive, chance):
    """each stamp off by up to 10 ms"""
    for reading in drive.readings:
        reading.stamp += chance.uniform(-0.01, 0.01)


ALONE = ("mirror", "late")  # other handedness, another begin: not what the others of a team saw
KINDS = {change.__name__: change for change in (mirror, late, thin, short, coarse, noisy, odometry, jitter)}


@dataclasses.dataclass
class Result:
    mean_m: float = math.nan
    largest_m: float = math.nan
    islands: int = 0
    error: str = ""

    @property
    def failed(self):
        return bool(self.error) or self.islands != 1 or not self.largest_m <= FAILED_M

    def cell(self):
        if self.error:
            return f"**{self.error}**"
        text = f"{self.mean_m:.4f} ({self.largest_m:.1f} m)" if self.failed else f"{self.mean_m:.4f}"
        text += f", {self.islands} islands" if self.islands != 1 else ""
        return f"**{text}**" if self.failed else text


def command(arguments, name, *words):
    result = subprocess.run([os.path.join(arguments.build, "bin", "isthmus-" + name), *words], capture_output=True, text=True)
    if result.returncode != 0:
        raise RuntimeError(f"isthmus-{name}: {result.stderr.strip() or result.returncode}")
    return result.stdout


def import_log(arguments, name, kind, seed, work):
    """A log, changed, as an event log; and its relations."""
    folder = os.path.join(arguments.data, "bench", name)
    drive = Drive.load(folder + ".clf.gz", folder + ".relations")
    if kind:
        KINDS[kind](drive, random.Random(f"{kind} {seed}"))
    log, relations, events = (os.path.join(work, file) for file in ("log.clf.gz", "relations", "log.lcm"))
    drive.save(log, relations)
    command(arguments, "import", "carmen", "--robot", "R1=" + log, *MOUNTS.get(name, []), "-o", events)
    return events, relations


@dataclasses.dataclass
class TeamRelations:
    """relations.csv of a set: scans of two robots, whatever becomes of their stamps."""

    columns: list
    related: list  # (robot, robot, Relation)

    @staticmethod
    def load(path, drives):
        scan_at = {robot: drive.finder() for robot, drive in drives.items()}
        with open(path, encoding="ascii", newline="") as file:
            columns, *rows = csv.reader(file)

        def scan(robot, utime_us):
            return scan_at[robot](1e-6 * int(utime_us))

        return TeamRelations(columns, [(row[0], row[2], Relation(scan(*row[:2]), scan(*row[2:4]), row[4:]))
                                       for row in rows])

    def save(self, path, drives):
        kept = {id(reading) for drive in drives.values() for reading in drive.readings}
        with open(path, "w", encoding="ascii", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(self.columns)
            for one, other, relation in self.related:
                if id(relation.first) in kept and id(relation.second) in kept:
                    rows.writerow([one, round(1e6 * relation.first.stamp), other, round(1e6 * relation.second.stamp),
                                   *relation.motion])


def import_team(arguments, name, kind, seed, work):
    """The same of a set of logs, each robot's changed in its own way."""
    folder = os.path.join(arguments.data, "multi", name, "")
    robots = []
    drives = {os.path.basename(log)[:-len(".clf.gz")]: Drive.load(log) for log in sorted(glob.glob(folder + "*.clf.gz"))}
    relations = TeamRelations.load(folder + "relations.csv", drives)
    for robot, drive in drives.items():
        if kind:
            KINDS[kind](drive, random.Random(f"{kind} {seed} {robot}"))
        changed = os.path.join(work, robot + ".clf.gz")
        drive.save(changed)
        robots += ["--robot", f"{robot}={changed}"]
    events = os.path.join(work, "log.lcm")
    command(arguments, "import", "carmen", "--robots", folder + "robots.csv", *robots, "--sightings",
            folder + "sightings.csv", "-o", events)
    changed = os.path.join(work, "relations.csv")
    relations.save(changed, drives)
    return events, changed


def run(arguments, name, kind, seed):
    """One log or set in one variant; as it was recorded where there is no kind."""
    bring = import_team if arguments.teams else import_log
    try:
        with tempfile.TemporaryDirectory() as work:
            events, relations = bring(arguments, name, kind, seed, work)
            output = os.path.join(work, "map")
            refine = ["--refine"] if arguments.refine else []
            summary = json.loads(command(arguments, "replay", events, *refine, "--output", output, "--json"))
            errors = json.loads(command(arguments, "evaluate", "--relations", relations, "--output", output, "--json"))
            metres = {kind: found["translation_m"] for kind, found in errors["relations"].items() if found["count"] > 0}
            largest = max(found["max"] for found in metres.values())
            return Result(metres["inter" if arguments.teams else "intra"]["mean"], largest, summary["islands"])
    except (RuntimeError, OSError, KeyError, ValueError) as error:
        return Result(error=str(error))


def table(name, arguments, recorded, results):
    print(f"\n## {name}: {recorded.cell()} m as recorded\n")
    print("| kind | " + " | ".join(f"seed {seed}" for seed in arguments.seeds) + " |")
    print("|---" * (1 + len(arguments.seeds)) + "|")
    for kind in arguments.kinds:
        print(f"| {kind} | " + " | ".join(results[kind, seed].cell() for seed in arguments.seeds) + " |", flush=True)


def logs_of(arguments):
    if arguments.teams:
        found = sorted(os.listdir(os.path.join(arguments.data, "multi")))
    else:
        bench = os.path.join(arguments.data, "bench")
        found = sorted(file[:-len(".clf.gz")] for file in os.listdir(bench) if file.endswith(".clf.gz"))
    unknown = set(arguments.logs) - set(found)
    if unknown:
        print(f"no such log: {', '.join(sorted(unknown))}; there are {', '.join(found)}", file=sys.stderr)
        raise SystemExit(2)
    return arguments.logs or found


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("logs", nargs="*", metavar="LOG", help="those of the data that are run; all of them without")
    parser.add_argument("--teams", action="store_true", help="sets of several robots, instead of logs of one")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, metavar="KIND")
    parser.add_argument("--seeds", nargs="+", type=int, default=[1, 2, 3], metavar="SEED")
    parser.add_argument("--refine", action="store_true", help="with the last pass of isthmus-replay")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs at a time")
    parser.add_argument("--most-failures", type=int, default=3)
    parser.add_argument("--build", default=os.path.join(ROOT, ".build", "release"))
    parser.add_argument("--data", default=os.environ.get("ISTHMUS_DATA", os.path.join(ROOT, "..", "shared", "data")))
    parser.add_argument("--list", action="store_true", help="what the kinds change")
    arguments = parser.parse_args()
    if arguments.list:
        for kind, change in KINDS.items():
            print(f"{kind:10}{change.__doc__}")
        return 0
    if not os.path.isdir(os.path.join(arguments.data, "multi" if arguments.teams else "bench")):
        print(f"no recorded data at {arguments.data}: set ISTHMUS_DATA", file=sys.stderr)
        return 1
    possible = [kind for kind in KINDS if not (arguments.teams and kind in ALONE)]
    arguments.kinds = arguments.kinds or possible
    if not set(arguments.kinds) <= set(possible):
        print(f"not of teams: {', '.join(sorted(set(arguments.kinds) - set(possible)))}", file=sys.stderr)
        return 2
    runs = failures = 0
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for name in logs_of(arguments):
            recorded = pool.submit(run, arguments, name, None, 0)
            pending = {(kind, seed): pool.submit(run, arguments, name, kind, seed)
                       for kind in arguments.kinds for seed in arguments.seeds}
            results = {key: future.result() for key, future in pending.items()}
            table(name, arguments, recorded.result(), results)
            runs += len(results)
            failures += sum(result.failed for result in results.values())
    print(f"\n{failures} of {runs} runs failed: a relation more than {FAILED_M:g} m off, or more than one island")
    return 1 if failures > arguments.most_failures else 0


if __name__ == "__main__":
    sys.exit(main())
