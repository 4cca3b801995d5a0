#!/usr/bin/env python3
"""A live server and an MCAP file as the field's own programs read them: a simulated team is played to a server that
Foxglove's client watches (npm's @foxglove/ws-protocol), and what the server kept is written as MCAP and read back
(npm's @mcap/core). Where npm cannot fetch them, foxglove_test.py, by bytes, is what there is.

    tests/scenario/foxglove_peers_test.py --build .build/dev
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile

from foxglove_test import PLAYED_FASTER, SCHEMAS, run
from live import LIMIT_S, Server, check, free_lcm_port, free_port, lcm_url

SCRIPTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "foxglove_peers")


def installed_scripts(build):
    """Where the scripts stand beside what they import; None where that cannot be had."""
    place = os.path.join(build, "foxglove_peers")
    shutil.copytree(SCRIPTS, place, dirs_exist_ok=True)
    if shutil.which("node") is None or shutil.which("npm") is None:
        return None
    if not os.path.exists(os.path.join(place, "node_modules", "ws", "package.json")):
        installed = subprocess.run(["npm", "install", "--no-audit", "--no-fund", "--no-save", "--fetch-retries", "1"],
                                   cwd=place, capture_output=True, text=True, timeout=300)
        if installed.returncode != 0:
            return None
    return place


def read_by(script, *arguments):
    answer = subprocess.run(["node", script, *arguments], capture_output=True, text=True, timeout=300)
    check(answer.returncode == 0, f"{os.path.basename(script)} reads it: {answer.stderr.strip()}")
    return json.loads(answer.stdout)


def judge(seen, what):
    for topic, schema in SCHEMAS.items():
        check(topic in seen, f"{what} has {topic}")
        check(seen[topic]["schema"] == f"foxglove.{schema}", f"{topic} of {what} is a {schema}: {seen[topic]}")
        check(seen[topic]["encoding"] == "json" and seen[topic]["messages"] > 0, f"{topic} of {what}: {seen[topic]}")
    print(f"{what}: {sum(topic['messages'] for topic in seen.values())} messages of {len(seen)} topics")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", default=".build/dev")
    build = os.path.abspath(parser.parse_args().build)
    scripts = installed_scripts(build)
    if scripts is None:
        print("no peers: npm does not fetch @foxglove/ws-protocol and @mcap/core here")
        return 0
    with tempfile.TemporaryDirectory() as work:
        log, journal, mcap = (os.path.join(work, name) for name in ("run.lcm", "journal", "run.mcap"))
        run(os.path.join(build, "bin", "isthmus-simulate"), "--scenario", "meeting", "--set", "duration_s=60", "-o", log)
        port, url = free_port(), lcm_url(free_lcm_port())
        with Server(build, url, work) as server:
            server.start("--journal", journal, "--foxglove-port", str(port))
            player = subprocess.Popen(["lcm-logplayer", "-s", str(PLAYED_FASTER), "-l", url, log],
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                judge(read_by(os.path.join(scripts, "watch.mjs"), str(port), *SCHEMAS), "the live server")
            finally:
                player.wait(timeout=LIMIT_S)
        run(os.path.join(build, "bin", "isthmus-export"), journal, "--mcap", mcap)
        judge(read_by(os.path.join(scripts, "read_mcap.mjs"), mcap), "the journal's MCAP file")
    return 0


if __name__ == "__main__":
    sys.exit(main())
