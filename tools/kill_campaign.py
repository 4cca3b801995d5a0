#!/usr/bin/env python3
"""Kills a live isthmus-server again and again, and compares the map it ends with to a replay of its journal.

    tools/kill_campaign.py run.lcm [--kills 200] [--build DIR] [--seed 1] [--speed 20] [--file] [--keep DIR]

The log is played over UDP on this machine alone (lcm-logplayer, ttl=0), again from its start whenever it ends;
with --file the server reads it itself, from its start after each kill. SIGKILL comes at random moments, while
it takes messages and while it recovers; after every other one the journal loses some of its last bytes besides,
as in a power cut. After the last kill it recovers, is stopped with SIGTERM, and must
have written the map_sha256 that isthmus-replay gets from all of its journal; snapshots of the segments are made
meanwhile, and what was recovered began with them. Several rounds of so many kills each
begin with a new journal (--kills-per-journal).
"""

import argparse
import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))


class Player:
    """The log over UDP, over and over."""

    def __init__(self, log, url, speed):
        self.command = ["lcm-logplayer", f"--speed={speed}", f"--lcm-url={url}", log]
        self.process = None
        self.go_on()

    def go_on(self):
        if self.process is None or self.process.poll() is not None:
            self.process = subprocess.Popen(self.command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def stop(self):
        self.process.kill()
        self.process.wait()


class Campaign:
    def __init__(self, arguments, work):
        self.bin = os.path.join(arguments.build, "bin")
        self.log = os.path.abspath(arguments.log)
        self.url = f"udpm://239.255.76.67:{arguments.port}?ttl=0"
        self.arguments = arguments
        self.random = random.Random(arguments.seed)
        self.work = work

    def start(self, journal, output):
        url = "file://" + self.log if self.arguments.file else self.url
        with open(os.path.join(self.work, "server.log"), "ab") as errors:
            return subprocess.Popen(
                [os.path.join(self.bin, "isthmus-server"), "--lcm-url", url, "--journal", journal, "--output", output, "--segment-mb",
                 str(self.arguments.segment_mb)],
                stderr=errors)

    def round(self, number, kills):
        """One journal through so many kills; returns (events in it, map of the server, map of the replay)."""
        journal, output = (os.path.join(self.work, f"{name}-{number}") for name in ("journal", "map"))
        player = None
        try:
            for kill in range(kills):
                server = self.start(journal, output)
                if not self.arguments.file and player is None:
                    time.sleep(0.5)  # robots say what they are at the log's beginning only
                    player = Player(self.log, self.url, self.arguments.speed)
                time.sleep(self.random.uniform(0.0, self.arguments.longest))
                if server.poll() not in (None, 0):
                    raise RuntimeError(f"the server ended by itself: see {self.work}/server.log")
                server.kill()
                server.wait()
                if kill % 2:
                    self.cut_power(journal)
                if player:
                    player.go_on()
            server = self.start(journal, output)
            time.sleep(self.random.uniform(0.5, 1.0) * self.arguments.longest)
            server.send_signal(signal.SIGTERM)
            if server.wait(timeout=600) != 0:
                raise RuntimeError(f"the server failed: see {self.work}/server.log")
        finally:
            if player:
                player.stop()
        return self.compare(number, journal, output)

    def cut_power(self, journal):
        files = os.listdir(journal) if os.path.isdir(journal) else []
        segments = sorted(name for name in files if name.endswith(".lcm"))
        if segments:
            last = os.path.join(journal, segments[-1])
            os.truncate(last, max(0, os.path.getsize(last) - self.random.randrange(5000)))

    def compare(self, number, journal, output):
        replayed = os.path.join(self.work, f"replay-{number}")
        summary = subprocess.run(
            [os.path.join(self.bin, "isthmus-replay"), journal, "--output", replayed, "--json"],
            check=True, capture_output=True, text=True)
        reports = []
        for directory in (output, replayed):
            with open(os.path.join(directory, "report.json"), encoding="utf-8") as file:
                reports.append(json.load(file))
        return json.loads(summary.stdout), *reports


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log")
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--kills-per-journal", type=int, default=10)
    parser.add_argument("--build", default=os.path.join(ROOT, ".build", "release"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--speed", type=float, default=50, help="of the played log, in times of its own")
    parser.add_argument("--longest", type=float, default=1.5, help="seconds that a server lives, at most")
    parser.add_argument("--segment-mb", type=int, default=1, help="small, so that snapshots are restarted from")
    parser.add_argument("--port", type=int, default=7697)
    parser.add_argument("--file", action="store_true", help="the server reads the log itself")
    parser.add_argument("--keep", metavar="DIR", help="keep journals and maps in this directory")
    arguments = parser.parse_args()
    failed = 0
    with tempfile.TemporaryDirectory() as scratch:
        work = arguments.keep or scratch
        os.makedirs(work, exist_ok=True)
        campaign = Campaign(arguments, work)
        done = 0
        print("kills  events  patches  skipped bytes  same map")
        while done < arguments.kills:
            kills = min(arguments.kills_per_journal, arguments.kills - done)
            done += kills
            summary, server, replay = campaign.round(done, kills)
            same = server["map_sha256"] == replay["map_sha256"]
            failed += not same
            print(f"{done:5}  {summary['messages']:6}  {server['patches']:7}  {summary['skipped_bytes']:13}  "
                  f"{'yes' if same else 'NO'}", flush=True)
    print(f"{done} kills, {failed} maps differ")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
