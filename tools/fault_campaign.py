#!/usr/bin/env python3
"""Takes a live isthmus-server's disk and network away, and compares the map it ends with to a replay of its journal.

    tools/fault_campaign.py run.lcm [--build DIR] [--speed 20] [--keep DIR] [FAULT ...]

As root: disks are small file systems in memory, networks are name spaces; nothing else of the machine is touched.
The log is played over UDP (lcm-logplayer, ttl=0). Faults, all by default:

    full_then_free   the disk fills up during the run and is given room again: no event may be lost
    full_and_over    the same, and more comes than may wait: the rest is refused before the map has it
    full_for_good    the disk stays full: the server goes on, ends with an error, and says what the journal lacks
    read_only        the journal's directory lets nobody write: the server does not begin, and says why
    deleted_segment  the file that is written is deleted: it is written again, and no event is lost
    deleted_journal  the journal's directory is deleted: what can be saved is, and the server ends with an error
    network          the interface goes down and comes back: the server goes on and hears the robots again
    no_network       there is no multicast route: the server does not begin, and says what to do
"""

import argparse
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
NETWORK = f"isthmus-faults-{os.getpid()}"
URL = "udpm://239.255.76.67:7698?ttl=0"


def run(*command, check=True):
    return subprocess.run(command, check=check, capture_output=True, text=True)


class Disk:
    """A small file system in memory."""

    def __init__(self, path, megabytes, *options):
        self.path = path
        os.makedirs(path)
        run("mount", "-t", "tmpfs", "-o", ",".join([f"size={megabytes}m", *options]), "isthmus-faults", path)

    def grow(self, megabytes):
        run("mount", "-o", f"remount,size={megabytes}m", self.path)

    def remove(self):
        run("umount", self.path)


class Run:
    """One server and what plays to it."""

    def __init__(self, arguments, work, prefix=()):
        self.bin = os.path.join(arguments.build, "bin")
        self.log = os.path.abspath(arguments.log)
        self.speed = arguments.speed
        self.work = work
        self.prefix = list(prefix)
        self.errors = os.path.join(work, "server.log")
        self.output = os.path.join(work, "map")
        self.server = self.player = None

    def start(self, journal, *options):
        self.journal = journal
        with open(self.errors, "wb") as errors:
            self.server = subprocess.Popen(
                [*self.prefix, os.path.join(self.bin, "isthmus-server"), "--lcm-url", URL, "--journal", journal,
                 "--output", self.output, *options], stderr=errors)
        time.sleep(1)  # robots say what they are at the log's beginning only

    def play(self):
        self.player = subprocess.Popen(
            [*self.prefix, "lcm-logplayer", f"--speed={self.speed}", f"--lcm-url={URL}", self.log],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def said(self):
        with open(self.errors, encoding="utf-8") as file:
            return file.read()

    def wait_until_said(self, text, seconds=120):
        for _ in range(10 * seconds):
            if text in self.said():
                return
            if self.server.poll() is not None:
                break
            time.sleep(0.1)
        raise RuntimeError(f"the server did not say '{text}': see {self.errors}")

    def end(self):
        """Stops the server as an operator would; returns its exit code."""
        self.kill_player()
        self.server.send_signal(signal.SIGTERM)
        return self.server.wait(timeout=600)

    def kill_player(self):
        if self.player:
            self.player.kill()
            self.player.wait()
            self.player = None

    def clean(self):
        self.kill_player()
        if self.server and self.server.poll() is None:
            self.server.kill()
            self.server.wait()

    def report(self, directory):
        with open(os.path.join(directory, "report.json"), encoding="utf-8") as file:
            return json.load(file)

    def compare(self):
        """(report of the server, report of a replay of its journal)."""
        replayed = os.path.join(self.work, "replay")
        run(os.path.join(self.bin, "isthmus-replay"), self.journal, "--output", replayed)
        return self.report(self.output), self.report(replayed)


def expect(condition, what):
    if not condition:
        raise RuntimeError(what)


def expect_same_map(server, replay):
    expect(server["patches"] > 0, "there is no map")
    expect(server["map_sha256"] == replay["map_sha256"], "the map is another than the replay's")


def full_then_free(one, disk):
    one.start(os.path.join(disk.path, "journal"))
    one.play()
    one.wait_until_said("events wait in memory")
    time.sleep(3)
    disk.grow(500)
    one.wait_until_said("takes events again")
    time.sleep(3)
    expect(one.end() == 0, "the server failed")
    server, replay = one.compare()
    expect_same_map(server, replay)
    expect("journal_full" not in server["dropped"], "events were lost")
    return f"{server['patches']} patches, same map; {server['scans']} scans, none lost to the disk"


def full_and_over(one, disk):
    one.start(os.path.join(disk.path, "journal"), "--journal-waiting-mb", "1")
    one.play()
    one.wait_until_said("more are refused")
    time.sleep(2)
    disk.grow(500)
    one.wait_until_said("takes events again")
    time.sleep(3)
    expect(one.end() == 0, "the server failed")
    server, replay = one.compare()
    expect_same_map(server, replay)
    refused = server["dropped"].get("journal_full", 0)
    expect(refused > 0, "nothing was refused")
    return f"{server['patches']} patches, same map; {refused} events refused and counted"


def full_for_good(one, disk):
    one.start(os.path.join(disk.path, "journal"))
    one.play()
    one.wait_until_said("events wait in memory")
    time.sleep(3)
    code = one.end()
    lost = re.search(r"events that the disk refused to the end: (\d+)", one.said())
    expect(code == 1 and lost, "the server did not say what the journal lacks")
    server, replay = one.compare()
    expect(server["scans"] > replay["scans"] > 0, "the journal is not what the disk took")
    return f"exit code {code}; {lost[1]} events named as lost; the journal's {replay['scans']} scans replay"


def read_only(one, disk):
    run("mount", "-o", "remount,ro", disk.path)
    one.start(os.path.join(disk.path, "journal"))
    expect(one.server.wait(timeout=10) == 1, "the server began")
    expect("Read-only file system" in one.said(), "the server did not say why")
    return one.said().strip()


def segments_of(one):
    return sorted(os.path.join(one.journal, name) for name in os.listdir(one.journal) if name.endswith(".lcm"))


def wait_for_segments(one, count, seconds=120):
    for _ in range(10 * seconds):
        if len(segments_of(one)) >= count:
            return
        time.sleep(0.1)
    raise RuntimeError(f"there were no {count} segments: see {one.errors}")


def deleted_segment(one, disk):
    disk.grow(500)
    one.start(os.path.join(disk.path, "journal"), "--segment-mb", "1")
    one.play()
    wait_for_segments(one, 2)
    os.remove(segments_of(one)[-1])
    one.wait_until_said("is written again")
    time.sleep(3)
    expect(one.end() == 0, "the server failed")
    server, replay = one.compare()
    expect_same_map(server, replay)
    return f"{server['patches']} patches, same map; written again"


def deleted_journal(one, disk):
    disk.grow(500)
    one.start(os.path.join(disk.path, "journal"), "--segment-mb", "1", "--no-snapshots")
    one.play()
    wait_for_segments(one, 3)
    shutil.rmtree(one.journal)
    one.wait_until_said("is not whole any more")
    time.sleep(3)
    code = one.end()
    kept = len(segments_of(one))
    expect(code == 1 and kept > 0, "the server did not say what is lost, or kept nothing")
    return f"exit code {code}; {kept} segments kept; {one.said().strip().splitlines()[-1]}"


def network_up():
    run("ip", "-n", NETWORK, "link", "set", "lo", "up")
    run("ip", "-n", NETWORK, "route", "replace", "224.0.0.0/4", "dev", "lo")


def network(one, disk):
    network_up()
    one.start(os.path.join(one.work, "journal"))
    one.play()
    time.sleep(4)
    run("ip", "-n", NETWORK, "link", "set", "lo", "down")
    one.wait_until_said("the network refuses messages")
    time.sleep(2)
    journal = os.path.join(one.journal, "journal-000001.lcm")
    before = os.path.getsize(journal)
    time.sleep(1)
    expect(os.path.getsize(journal) == before, "messages came over a network that is down")
    network_up()
    one.wait_until_said("the network takes messages again")
    one.kill_player()
    one.play()
    time.sleep(4)
    heard = os.path.getsize(journal) - before
    expect(one.end() == 0, "the server failed")
    expect(heard > 10_000, "the robots were not heard again")
    expect_same_map(*one.compare())
    return f"same map; {heard} bytes heard after the network came back"


def no_network(one, disk):
    one.start(os.path.join(one.work, "journal"))
    expect(one.server.wait(timeout=10) == 1, "the server began")
    expect("ip route add 224.0.0.0/4 dev lo" in one.said(), "the server did not say what to do")
    return " ".join(one.said().split())


FAULTS = {f.__name__: f for f in (full_then_free, full_and_over, full_for_good, read_only, deleted_segment,
                                   deleted_journal, network, no_network)}


def play_out(name, arguments, work):
    """Runs one fault; returns what it showed. Throws RuntimeError with what went wrong."""
    in_network = name in ("network", "no_network")
    os.makedirs(work)
    one = Run(arguments, work, ("ip", "netns", "exec", NETWORK) if in_network else ())
    disk = None
    try:
        if in_network:
            run("ip", "netns", "add", NETWORK)
        else:
            disk = Disk(os.path.join(work, "disk"), arguments.megabytes)
        return FAULTS[name](one, disk)
    finally:
        one.clean()
        if disk:
            disk.remove()
        if in_network:
            run("ip", "netns", "del", NETWORK)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log")
    parser.add_argument("faults", nargs="*", metavar="FAULT", default=list(FAULTS))
    parser.add_argument("--build", default=os.path.join(ROOT, ".build", "release"))
    parser.add_argument("--speed", type=float, default=20, help="of the played log, in times of its own")
    parser.add_argument("--megabytes", type=int, default=2, help="of the disk that fills up")
    parser.add_argument("--keep", metavar="DIR", help="keep logs and maps in this directory; it must not exist")
    arguments = parser.parse_args()
    if unknown := set(arguments.faults) - set(FAULTS):
        parser.error("no such fault: " + ", ".join(sorted(unknown)))
    failed = 0
    with tempfile.TemporaryDirectory() as scratch:
        for name in arguments.faults:
            try:
                shown = play_out(name, arguments, os.path.join(arguments.keep or scratch, name))
                print(f"{name:15} {shown}", flush=True)
            except (RuntimeError, subprocess.SubprocessError) as error:
                failed += 1
                print(f"{name:15} FAILED: {error}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
