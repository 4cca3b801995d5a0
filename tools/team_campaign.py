#!/usr/bin/env python3
"""Many seeded runs of one simulated team: how far the robots are from the truth.

    tools/team_campaign.py --build .build/release --scenario courtyards --seeds 100

Every run is simulated, mapped and compared with the truth, the map laid on the truth at the first pose of the
first robot (Benedettelli et al. 2012, section 5: no alignment of the whole). Prints a line a seed and the mean over the runs.
"""

import argparse
import json
import math
import pathlib
import statistics
import subprocess
import tempfile


def read_tum(path):
    poses = {}
    for line in path.read_text().splitlines():
        if line and not line.startswith("#"):
            t, x, y, _, _, _, qz, qw = map(float, line.split()[:8])
            poses[round(t * 1e6)] = (x, y, 2 * math.atan2(qz, qw))
    return poses


def compose(a, b):
    c, s = math.cos(a[2]), math.sin(a[2])
    return a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], a[2] + b[2]


def inverse(a):
    c, s = math.cos(a[2]), math.sin(a[2])
    return -c * a[0] - s * a[1], s * a[0] - c * a[1], -a[2]


def errors(truth_directory, output_directory):
    """Mean distance (m) and turn (degrees) of all robots' poses from the truth, anchored at the first robot."""
    robots = sorted(path.stem for path in (output_directory / "trajectories").glob("*.tum"))
    truth = {robot: read_tum(truth_directory / f"{robot}.tum") for robot in robots}
    found = {robot: read_tum(output_directory / "trajectories" / f"{robot}.tum") for robot in robots}
    first = min(set(truth[robots[0]]) & set(found[robots[0]]))
    world_from_map = compose(truth[robots[0]][first], inverse(found[robots[0]][first]))
    metres, degrees = [], []
    for robot in robots:
        for utime in set(truth[robot]) & set(found[robot]):
            x, y, yaw = compose(world_from_map, found[robot][utime])
            true = truth[robot][utime]
            metres.append(math.hypot(x - true[0], y - true[1]))
            degrees.append(abs(math.degrees(math.remainder(yaw - true[2], 2 * math.pi))))
    return statistics.fmean(metres), statistics.fmean(degrees)


def run(binaries, scenario, overrides, seed, directory):
    log, truth, output = directory / "run.lcm", directory / "truth", directory / "map"
    sets = [word for override in overrides for word in ("--set", override)]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "check": True}
    subprocess.run([binaries / "isthmus-simulate", "--scenario", scenario, "--seed", str(seed), "-o", log,
                    "--truth", truth, *sets], **quiet)
    subprocess.run([binaries / "isthmus-replay", log, "--output", output], **quiet)
    report = json.loads((output / "report.json").read_text())
    return report["islands"], *errors(truth, output)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=pathlib.Path(".build/release"))
    parser.add_argument("--scenario", default="courtyards")
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--from", dest="first", type=int, default=1)
    parser.add_argument("--set", dest="overrides", action="append", default=[], metavar="KEY=VALUE")
    arguments = parser.parse_args()
    results = []
    print("seed  islands  mean m  mean deg")
    for seed in range(arguments.first, arguments.first + arguments.seeds):
        with tempfile.TemporaryDirectory() as directory:
            results.append(run(arguments.build.resolve() / "bin", arguments.scenario, arguments.overrides, seed,
                               pathlib.Path(directory)))
        print(f"{seed:4}  {results[-1][0]:7}  {results[-1][1]:6.4f}  {results[-1][2]:8.4f}", flush=True)
    metres, degrees = [r[1] for r in results], [r[2] for r in results]
    print(f"{len(results)} runs, {sum(r[0] == 1 for r in results)} on one island: "
          f"mean {statistics.fmean(metres):.4f} m, {statistics.fmean(degrees):.4f} deg; "
          f"worst run {max(metres):.4f} m, {max(degrees):.4f} deg")


if __name__ == "__main__":
    main()
