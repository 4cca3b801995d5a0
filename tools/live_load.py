#!/usr/bin/env python3
"""Plays a team to a live isthmus-server over UDP on this machine, and tells what was lost and how long poses took.

    tools/live_load.py [--robots 14] [--rate 10] [--seconds 150] [--build DIR] [--keep DIR]
    tools/live_load.py --log run.lcm

Without --log a team is simulated first, on a floor made for so many (isthmus-simulate --scenario floor). The log is
played at its own speed (lcm-logplayer, ttl=0) while lcm-logger hears scans and poses.

    lost      messages sent that are not in the server's journal
    latency   from when a scan was heard to when the pose that answers it was, both by the logger
"""

import argparse
import collections
import json
import os
import re
import signal
import struct
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
INPUT = re.compile(r".+_(ROBOT|ODOMETRY|SCAN|SIGHTING)|ISTHMUS_(TAG|COMMAND)")
RECEIVE_BUFFER = 4 * 1024 * 1024
HEADER = struct.Struct(">IqqII")  # of an event: sync word, number, receive time, lengths of channel and data
SYNC_WORD = 0xEDA1DA01


def events(path):
    """(receive time in microseconds, channel, data) of a log of liblcm."""
    with open(path, "rb") as file:
        while len(header := file.read(HEADER.size)) == HEADER.size:
            sync, _, utime, channel_size, data_size = HEADER.unpack(header)
            if sync != SYNC_WORD:
                raise RuntimeError(f"{path}: damaged")
            yield utime, file.read(channel_size).decode(), file.read(data_size)


def count_input(paths):
    counts = collections.Counter()
    for path in paths:
        counts.update(channel for _, channel, _ in events(path) if INPUT.fullmatch(channel))
    return counts


def stamp(data):
    """The utime that scans and poses begin with, behind the type's fingerprint."""
    return struct.unpack_from(">q", data, 8)[0]


def latencies_ms(path):
    """Of all scans heard that were answered, sorted; and how many were heard."""
    scans, latencies = {}, []
    for utime, channel, data in events(path):
        if channel.endswith("_SCAN"):
            scans[channel.removesuffix("_SCAN"), stamp(data)] = utime
        elif channel.endswith("_POSE"):
            heard = scans.get((channel.removesuffix("_POSE"), stamp(data)))
            if heard is not None:
                latencies.append(1e-3 * (utime - heard))
    return sorted(latencies), len(scans)


def quantile(values, share):
    return values[min(len(values) - 1, int(share * len(values)))] if values else float("nan")


def simulate(arguments, path):
    settings = [f"floor.robots={arguments.robots}", "floor.area_m2=1500", f"floor.tour_m={arguments.seconds}",
                f"laser.rate_hz={arguments.rate}", f"duration_s={arguments.seconds}"]
    overrides = [word for setting in settings for word in ("--set", setting)]
    subprocess.run([os.path.join(arguments.build, "bin", "isthmus-simulate"), "--scenario", "floor", "--seed",
                    str(arguments.seed), "-o", path, *overrides], check=True)


def warn_of_small_buffer():
    with open("/proc/sys/net/core/rmem_max", encoding="ascii") as file:
        if int(file.read()) < RECEIVE_BUFFER:
            print(f"the kernel clips the receive buffer: sysctl -w net.core.rmem_max={RECEIVE_BUFFER}")


def play(arguments, log, work):
    """Runs server and logger while the log is played; returns journal, heard log and the server's report."""
    url = f"udpm://239.255.76.67:{arguments.port}?ttl=0&recv_buf_size={RECEIVE_BUFFER}"
    journal, output, heard = (os.path.join(work, name) for name in ("journal", "map", "heard.lcm"))
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with open(os.path.join(work, "server.log"), "wb") as errors:
        server = subprocess.Popen([os.path.join(arguments.build, "bin", "isthmus-server"), "--lcm-url", url,
                                   "--journal", journal, "--output", output], stderr=errors)
    logger = subprocess.Popen(["lcm-logger", "--force", f"--lcm-url={url}", "--channel=.*_(SCAN|POSE)", heard], **quiet)
    try:
        time.sleep(1)  # robots say what they are at the log's beginning only
        subprocess.run(["lcm-logplayer", f"--lcm-url={url}", log], check=True, **quiet)
        time.sleep(2)
    finally:
        logger.send_signal(signal.SIGINT)
        server.send_signal(signal.SIGTERM)
        logger.wait()
        code = server.wait(timeout=600)
    if code != 0:
        raise RuntimeError(f"the server failed: see {work}/server.log")
    with open(os.path.join(output, "report.json"), encoding="utf-8") as file:
        report = json.load(file)
    return sorted(os.path.join(journal, name) for name in os.listdir(journal) if name.endswith(".lcm")), heard, report


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--log", help="play this log instead of a simulated team")
    parser.add_argument("--robots", type=int, default=14)
    parser.add_argument("--rate", type=float, default=10, help="scans a second of each robot")
    parser.add_argument("--seconds", type=float, default=150)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--build", default=os.path.join(ROOT, ".build", "release"))
    parser.add_argument("--port", type=int, default=7699)
    parser.add_argument("--most-lost", type=float, default=1e-4, help="share of messages; more is a failure")
    parser.add_argument("--keep", metavar="DIR", help="keep log, journal and map in this directory")
    arguments = parser.parse_args()
    warn_of_small_buffer()
    with tempfile.TemporaryDirectory() as scratch:
        work = arguments.keep or scratch
        os.makedirs(work, exist_ok=True)
        log = arguments.log or os.path.join(work, "run.lcm")
        if not arguments.log:
            simulate(arguments, log)
        journal, heard, report = play(arguments, log, work)
        sent, taken = count_input([log]), count_input(journal)
        lost = sum((sent - taken).values())
        share = lost / sum(sent.values())
        latencies, scans = latencies_ms(heard)
        sent_scans = sum(count for channel, count in sent.items() if channel.endswith("_SCAN"))
        print(f"sent      {sum(sent.values())} messages, {sent_scans} scans")
        print(f"lost      {lost} ({100 * share:.4f} %); dropped by the server: {report['dropped'] or 'none'}")
        print(f"answered  {len(latencies)} of {scans} scans heard by the logger")
        print("latency   " + ", ".join(f"p{100 * q:g} {quantile(latencies, q):.1f} ms" for q in (0.5, 0.99, 0.999))
              + f", max {quantile(latencies, 1):.1f} ms")
    return 1 if share > arguments.most_lost else 0


if __name__ == "__main__":
    sys.exit(main())
