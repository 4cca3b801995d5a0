#!/usr/bin/env python3
"""Kills a live isthmus-server again and again, and accounts for every message that it had acknowledged.

    tools/kill_campaign.py run.lcm [--kills 200] [--build DIR] [--seed 1] [--speed 20] [--keep DIR]

The log is sent over UDP on this machine alone (ttl=0), each message with a stamp of its own, faster than it was
recorded; in every third life of the server ten times as fast again, so that messages pile up. The server tells on
ISTHMUS_RECEIVED what it has on the disk. SIGKILL comes at random moments, while it takes messages and while it recovers;
every tenth life is ended with SIGTERM. After every other kill the journal loses some of its last bytes, as in a power
cut: of those that the disk did not have to hold, as the spool still has their messages.

After the last kill of a journal the server recovers, is stopped with SIGTERM, and then
    each message that was acknowledged must be in the journal, once, or be counted there as dropped,
    the map must be the one that isthmus-replay makes of all of the journal.
Several rounds of so many kills each begin with a new journal (--kills-per-journal). Snapshots are made meanwhile.
"""

import argparse
import bisect
import collections
import json
import os
import random
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
INPUT = re.compile(r".+_(ROBOT|ODOMETRY|SCAN|SIGHTING)|ISTHMUS_TAG")
GROUP = "239.255.76.67"
SHORT_MESSAGE = 0x4C433032  # LCM's packet of a whole message: this, a sequence number, channel, NUL, data
MOST_BYTES = 65499  # of a message in one packet
HEADER = struct.Struct(">IqqII")  # of a log's event: sync word, number, receive time, lengths of channel and data
SYNC_WORD = 0xEDA1DA01


def events(path):
    """(offset, number, receive time in microseconds, channel, data) of an LCM log, to its end or where it is torn."""
    with open(path, "rb") as file:
        offset = 0
        while len(header := file.read(HEADER.size)) == HEADER.size:
            sync, number, utime, channel_size, data_size = HEADER.unpack(header)
            if sync != SYNC_WORD:
                raise RuntimeError(f"{path}: damaged at {offset}")
            body = file.read(channel_size + data_size)
            if len(body) < channel_size + data_size:
                return
            yield offset, number, utime, body[:channel_size].decode("utf-8", "replace"), body[channel_size:]
            offset += HEADER.size + channel_size + data_size


class Fields:
    """Reads an encoded LCM message, behind its fingerprint."""

    def __init__(self, data):
        self.data, self.at = data, 8

    def take(self, form):
        (value,) = struct.unpack_from(">" + form, self.data, self.at)
        self.at += struct.calcsize(">" + form)
        return value

    def text(self):
        size = self.take("i")
        self.at += size
        return self.data[self.at - size:self.at - 1].decode("utf-8", "replace")


def stamp(data):
    """The utime that inputs begin with, behind the type's fingerprint."""
    return struct.unpack_from(">q", data, 8)[0]


def inputs(log):
    """(receive time, channel, data, stamp) of a log's inputs; stamps rise on each channel, so that they tell messages
    apart."""
    newest = {}
    for _, _, utime, channel, data in events(log):
        if INPUT.fullmatch(channel) and len(data) <= MOST_BYTES:
            newest[channel] = max(stamp(data), newest.get(channel, 0) + 1)
            yield utime, channel, data, newest[channel]


class Player:
    """Sends the log over UDP, over and over, and notes each message and in which life of the server it was sent."""

    def __init__(self, log, port, speed):
        self.messages = list(inputs(log))
        self.port, self.speed, self.hurry = port, speed, False
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        self.life = None
        self.sent = []  # (channel, stamp, life)
        self.over = False
        self.thread = threading.Thread(target=self.play)

    def play(self):
        first, last = self.messages[0][0], self.messages[-1][0]
        shift, number = 0, 0
        due = time.monotonic()
        while True:
            before = first
            for utime, channel, data, stamped in self.messages:
                if self.over:
                    return
                due += 1e-6 * (utime - before) / self.speed / (10 if self.hurry else 1)
                before = utime
                wait = due - time.monotonic()
                if wait > 0.001:
                    time.sleep(wait)
                elif wait < -0.1:
                    due = time.monotonic()
                self.send(number, channel, data, stamped + shift)
                number += 1
            shift += last - first + 10_000_000

    def send(self, number, channel, data, utime):
        data = data[:8] + struct.pack(">q", utime) + data[16:]
        packet = struct.pack(">II", SHORT_MESSAGE, number & 0xFFFFFFFF) + channel.encode() + b"\0" + data
        self.sent.append((channel.upper(), utime, self.life))
        self.socket.sendto(packet, (GROUP, self.port))

    def stop(self):
        self.over = True
        self.thread.join()


class Listener:
    """What the server acknowledged: for each of its lives and channels, how many messages up to which stamp."""

    def __init__(self, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 * 1024 * 1024)
        self.socket.bind((GROUP, port))
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                               socket.inet_aton(GROUP) + socket.inet_aton("0.0.0.0"))
        self.socket.settimeout(0.1)
        self.acknowledged = {}  # by the time when a server began to count
        self.over = False
        self.thread = threading.Thread(target=self.listen)

    def listen(self):
        while not self.over:
            try:
                packet = self.socket.recv(65536)
            except TimeoutError:
                continue
            if packet[8:].startswith(b"ISTHMUS_RECEIVED\0"):
                self.take(Fields(packet[8 + len("ISTHMUS_RECEIVED") + 1:]))

    def take(self, fields):
        fields.take("q")
        channels = self.acknowledged.setdefault(fields.take("q"), {})
        for _ in range(fields.take("i")):
            channel = fields.text()
            channels[channel] = (fields.take("q"), fields.take("q"))

    def stop(self):
        self.over = True
        self.thread.join()
        self.socket.close()


class Journal:
    """The messages that a journal holds, and what it counts as dropped."""

    def __init__(self, directory):
        self.taken = collections.Counter()  # by channel and stamp
        self.dropped = collections.Counter()  # by robot and reason
        for path in segments(directory):
            for _, _, _, channel, data in events(path):
                if INPUT.fullmatch(channel):
                    self.taken[channel.upper(), stamp(data)] += 1
                elif channel == "ISTHMUS_DROPPED":
                    self.add_dropped(Fields(data))

    def add_dropped(self, fields):
        for _ in range(fields.take("i")):
            robot, reason, count = fields.text(), fields.text(), fields.take("q")
            self.dropped[robot, reason] += count
            numbers = fields.take("i")
            fields.at += 8 * numbers


def segments(directory):
    names = os.listdir(directory) if os.path.isdir(directory) else []
    return [os.path.join(directory, name) for name in sorted(names) if name.endswith(".lcm")]


def cut_power(directory, generator):
    """Takes some of the journal's last bytes, of entries whose messages are still in the spool. Returns how many."""
    if not segments(directory):
        return 0
    spooled = {number for name in os.listdir(directory) if name.endswith(".spool")
               for _, number, _, _, _ in events(os.path.join(directory, name))}
    last = segments(directory)[-1]
    size = os.path.getsize(last)
    least = size
    entries = [(offset, Fields(data)) for offset, _, _, channel, data in events(last) if channel == "ISTHMUS_ENTRY"]
    for offset, fields in reversed(entries):
        fields.take("q")
        if fields.take("q") not in spooled:
            break
        least = offset
    cut = min(generator.randrange(5000), size - least)
    os.truncate(last, size - cut)
    return cut


class Account:
    """What became of the messages of a round."""

    def __init__(self, player, listener, lives, journal):
        self.sent = len(player.sent)
        self.found = sum(1 for channel, utime, _ in player.sent if journal.taken[channel, utime])
        self.twice = sum(count - 1 for count in journal.taken.values())
        self.dropped = sum(journal.dropped.values())
        self.acknowledged = 0
        missing = collections.Counter()  # by robot
        by_life = collections.defaultdict(list)
        for channel, utime, life in player.sent:
            by_life[life, channel].append(utime)
        for since, channels in listener.acknowledged.items():
            life = bisect.bisect_right([begin for begin, _ in lives], since) - 1
            for channel, (count, newest) in channels.items():
                stamps = by_life[life, channel]
                if newest not in stamps:
                    raise RuntimeError(f"life {life} acknowledged {channel} {newest}, which it was not sent")
                heard = stamps[:stamps.index(newest) + 1]
                self.acknowledged += count
                robot = channel.rsplit("_", 1)[0]
                missing[robot] += max(0, count - sum(1 for utime in heard if journal.taken[channel, utime]))
        for (robot, _), count in journal.dropped.items():
            missing[robot.upper()] = max(0, missing[robot.upper()] - count)
        self.lost = sum(missing.values())


class Campaign:
    def __init__(self, arguments, work):
        self.bin = os.path.join(arguments.build, "bin")
        self.log = os.path.abspath(arguments.log)
        self.url = f"udpm://{GROUP}:{arguments.port}?ttl=0"
        self.arguments = arguments
        self.random = random.Random(arguments.seed)
        self.work = work
        self.in_recovery = 0

    def start(self, journal, output, *options):
        with open(os.path.join(self.work, "server.log"), "ab") as errors:
            return subprocess.Popen(
                [os.path.join(self.bin, "isthmus-server"), "--lcm-url", self.url, "--journal", journal, "--output", output,
                 "--segment-mb", str(self.arguments.segment_mb), *options], stderr=errors)

    def said(self):
        with open(os.path.join(self.work, "server.log"), encoding="utf-8") as file:
            return file.read()

    def live(self, number, journal, output, player, lives):
        """A life of the server, to its end by a signal."""
        player.life = len(lives)
        player.hurry = number % 3 == 2
        lives.append([time.time_ns() // 1000, 0])
        said = len(self.said()) if number else 0
        server = self.start(journal, output)
        time.sleep(self.random.uniform(0.0, self.arguments.longest))
        player.hurry = False
        if server.poll() is not None:
            raise RuntimeError(f"the server ended by itself: see {self.work}/server.log")
        if number % 10 == 9:
            server.send_signal(signal.SIGTERM)
        else:
            text = self.said()[said:]
            self.in_recovery += "recovering the journal" in text and "msg=recovered" not in text
            server.kill()
        server.wait(timeout=600)
        lives[-1][1] = time.time_ns() // 1000
        player.life = None
        if number % 2:
            cut_power(journal, self.random)

    def round(self, number, kills):
        """One journal through so many kills; returns the account, and the reports of the server and of a replay."""
        journal, output = (os.path.join(self.work, f"{name}-{number}") for name in ("journal", "map"))
        player = Player(self.log, self.arguments.port, self.arguments.speed)
        listener = Listener(self.arguments.port)
        lives = []
        listener.thread.start()
        try:
            player.thread.start()
            for kill in range(kills):
                self.live(kill, journal, output, player, lives)
            player.life = len(lives)
            lives.append([time.time_ns() // 1000, 0])
            server = self.start(journal, output, "--stop-timeout", "600")  # a finished map, to be compared
            time.sleep(self.random.uniform(0.5, 1.0) * self.arguments.longest)
            server.send_signal(signal.SIGTERM)
            if server.wait(timeout=600) != 0:
                raise RuntimeError(f"the server failed: see {self.work}/server.log")
        finally:
            player.stop()
            listener.stop()
        account = Account(player, listener, lives, Journal(journal))
        return account, *self.compare(number, journal, output)

    def compare(self, number, journal, output):
        replayed = os.path.join(self.work, f"replay-{number}")
        subprocess.run([os.path.join(self.bin, "isthmus-replay"), journal, "--output", replayed], check=True,
                       capture_output=True)
        reports = []
        for directory in (output, replayed):
            with open(os.path.join(directory, "report.json"), encoding="utf-8") as file:
                reports.append(json.load(file))
        return reports


def run(arguments, work):
    """Returns the number of faults."""
    campaign = Campaign(arguments, work)
    sums = collections.Counter()
    done = faults = 0
    print("kills    sent  acknowledged  found  dropped  lost  twice  patches  same map")
    while done < arguments.kills:
        kills = min(arguments.kills_per_journal, arguments.kills - done)
        done += kills
        account, server, replay = campaign.round(done, kills)
        same = server["map_sha256"] == replay["map_sha256"]
        faults += account.lost + account.twice + (not same)
        sums.update(vars(account))
        print(f"{done:5}  {account.sent:6}  {account.acknowledged:12}  {account.found:5}  {account.dropped:7}  "
              f"{account.lost:4}  {account.twice:5}  {server['patches']:7}  {'yes' if same else 'NO'}", flush=True)
    print(f"{done} kills, {campaign.in_recovery} of them while it recovered: {sums['sent']} messages sent, "
          f"{sums['acknowledged']} acknowledged, {sums['found']} in the journals, {sums['dropped']} dropped; "
          f"{sums['lost']} acknowledged and lost, {sums['twice']} taken twice; {faults} faults")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log")
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--kills-per-journal", type=int, default=10)
    parser.add_argument("--build", default=os.path.join(ROOT, ".build", "release"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--speed", type=float, default=20, help="of the log, in times of its own")
    parser.add_argument("--longest", type=float, default=1.5, help="seconds that a server lives, at most")
    parser.add_argument("--segment-mb", type=int, default=1, help="small, so that snapshots are restarted from")
    parser.add_argument("--port", type=int, default=7697)
    parser.add_argument("--keep", metavar="DIR", help="keep journals and maps in this directory")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        work = arguments.keep or scratch
        os.makedirs(work, exist_ok=True)
        return 1 if run(arguments, work) else 0


if __name__ == "__main__":
    sys.exit(main())
