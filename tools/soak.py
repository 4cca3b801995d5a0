#!/usr/bin/env python3
"""Maps hours of robots that drive about in a fixed building, and tells how resident memory grows.

    tools/soak.py [--robots 10] [--hours 6] [--restarts 0] [--most 1.0] [--build DIR] [--keep DIR]

The run is simulated (isthmus-simulate --scenario floor) and replayed with the memory sampled by
minutes of event time (isthmus-replay --memory). The growth is the slope of a line through the last half.

With --restarts N the log is cut into N + 1 parts of equal event time. isthmus-server maps each part from file and is
started again on the same journal for the next one, so that it goes on from snapshots. Its peak memory is taken at each
stop, and its last map must be the one that isthmus-replay makes of the journal, byte for byte.
"""

import argparse
import csv
import json
import os
import struct
import subprocess
import sys
import tempfile

HEADER = struct.Struct(">IqqII")  # of an event in an LCM log: sync word, number, microseconds, lengths
ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


def simulate(arguments, log):
    seconds = 3600 * arguments.hours  # at 0.5 m/s at most, the tours are long enough
    settings = [f"floor.robots={arguments.robots}", f"floor.area_m2={arguments.area}", f"floor.tour_m={seconds}",
                f"laser.rate_hz={arguments.scan_rate}", "odometry.rate_hz=4", f"camera.rate_hz={arguments.camera_rate}",
                f"duration_s={seconds}"]
    overrides = [word for setting in settings for word in ("--set", setting)]
    subprocess.run([program(arguments, "simulate"), "--scenario", "floor", "--seed",
                    str(arguments.seed), "-o", log, *overrides], check=True)


def slope(points):
    """Of the line through points (x, y) with the least squares."""
    mean_x, mean_y = (sum(values) / len(points) for values in zip(*points))
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, _ in points)


def frames(log):
    """(receive time in microseconds, bytes) of each event of a log."""
    with open(log, "rb") as file:
        while len(header := file.read(HEADER.size)) == HEADER.size:
            _, _, utime, channel_size, data_size = HEADER.unpack(header)
            yield utime, header + file.read(channel_size + data_size)


def cut(log, hours, parts, work):
    """Files of equal event time, in order."""
    first = next(frames(log))[0]
    names = [os.path.join(work, f"part-{k + 1:03d}.lcm") for k in range(parts)]
    files = [open(name, "wb") for name in names]
    for utime, frame in frames(log):
        part = int((utime - first) / (3.6e9 * hours) * parts)
        files[min(part, parts - 1)].write(frame)
    for file in files:
        file.close()
    return names


def program(arguments, name):
    return os.path.join(arguments.build, "bin", "isthmus-" + name)


def report_of(output):
    with open(os.path.join(output, "report.json"), encoding="utf-8") as file:
        return json.load(file)


def with_restarts(arguments, log, work):
    """Whether memory stayed within bounds and the last map is the journal's."""
    journal, output = os.path.join(work, "journal"), os.path.join(work, "map")
    parts = cut(log, arguments.hours, arguments.restarts + 1, work)
    points = []
    print("hour  peak MB  patches  relations  CPU s of the part")
    for k, part in enumerate(parts):
        subprocess.run([program(arguments, "server"), "--lcm-url", "file://" + part, "--journal", journal, "--output",
                        output, "--segment-mb", "16", "--log-level", "warning"], check=True)
        os.remove(part)
        # All that is closed is in a snapshot before the next start, as on a machine that had time for it.
        subprocess.run([program(arguments, "snapshot"), "--wait", journal], check=True, stdout=subprocess.DEVNULL)
        report = report_of(output)
        hour = arguments.hours * (k + 1) / len(parts)
        points.append((hour, report["peak_rss_mb"]))
        print(f"{hour:4.1f}  {report['peak_rss_mb']:7.1f}  {report['patches']:7d}  {report['relations']:9d}  "
              f"{report['cpu_s']:.1f}", flush=True)
    replayed = os.path.join(work, "replayed")
    subprocess.run([program(arguments, "replay"), journal, "--output", replayed], check=True)
    same = report_of(replayed)["map_sha256"] == report_of(output)["map_sha256"]
    growth = slope(points[len(points) // 2:])
    print(f"last half: {growth:.2f} MB an hour; the replay of the journal gives "
          f"{'the same' if same else 'ANOTHER'} map")
    return same and growth <= arguments.most


def without_restarts(arguments, log, work):
    """Whether memory stayed within bounds."""
    samples = os.path.join(work, "memory.csv")
    subprocess.run([program(arguments, "replay"), log, "--output", os.path.join(work, "map"), "--memory", samples],
                   check=True)
    with open(samples, encoding="utf-8") as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    half = [row for row in rows if row["event_s"] >= 1800 * arguments.hours]
    print("hour  resident MB  patches  relations  sightings")
    for row in rows[:: max(1, len(rows) // 12)]:
        print(f"{row['event_s'] / 3600:4.1f}  {row['resident_mb']:11.1f}  {row['patches']:7.0f}  "
              f"{row['relations']:9.0f}  {row['sightings']:9.0f}")
    growth = slope([(row["event_s"] / 3600, row["resident_mb"]) for row in half])
    print(f"last half: {growth:.2f} MB an hour; "
          f"{half[-1]['patches'] - half[0]['patches']:.0f} patches, "
          f"{half[-1]['sightings'] - half[0]['sightings']:.0f} sightings more")
    return growth <= arguments.most


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=int, default=10)
    parser.add_argument("--hours", type=float, default=6)
    parser.add_argument("--restarts", type=int, default=0, help="of the server, evenly spread")
    parser.add_argument("--area", type=float, default=1000, help="of the building, square metres")
    parser.add_argument("--scan-rate", type=float, default=1, help="scans of each robot a second")
    parser.add_argument("--camera-rate", type=float, default=0.2, help="looks for barcodes a second")
    parser.add_argument("--most", type=float, default=1.0, help="MB an hour; more is a failure")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--build", default=os.path.join(ROOT, ".build", "release"))
    parser.add_argument("--keep", metavar="DIR", help="keep log, map and samples in this directory")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        work = arguments.keep or scratch
        os.makedirs(work, exist_ok=True)
        log = os.path.join(work, "soak.lcm")
        simulate(arguments, log)
        run = with_restarts if arguments.restarts else without_restarts
        return 0 if run(arguments, log, work) else 1


if __name__ == "__main__":
    sys.exit(main())
