#!/usr/bin/env python3
"""Plays a team to a live isthmus-server over UDP on this machine, and tells what was lost and how long poses took.

    tools/live_load.py [--robots 14] [--rate 10] [--seconds 150] [--viewers 10] [--build DIR] [--keep DIR]
    tools/live_load.py --log run.lcm
    tools/live_load.py --compare 3 --viewers 10 [--foxglove-viewers 2]
    tools/live_load.py --compare 3 --bad-questions 2000

Without --log a team is simulated first, on a floor made for so many (isthmus-simulate --scenario floor). The log is
played at its own speed (lcm-logplayer, ttl=0) while lcm-logger hears scans and poses.

    lost      messages sent that are not in the server's journal
    latency   from when a scan was heard to when the pose that answers it was, both by the logger
    engine    what an event takes in the server
    viewers   what each of --viewers who watch the page, and of --foxglove-viewers, was sent
    asked     bad questions sent, of --bad-questions a second: NaN, unknown kinds, cut short

--compare plays the same load with viewers (or bad questions) and without, in turn, so many times, and tells how the
engine's latencies with them are to those without: of each pair, and the least, middle and largest of the pairs.
"""

import argparse
import base64
import collections
import http.client
import json
import os
import re
import signal
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import threading
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


class Viewer(threading.Thread):
    """Watches the page as a browser does that shows all islands: events, and tiles that changed, at 20 cm a cell."""

    ZOOM = -2

    def __init__(self, port):
        super().__init__(daemon=True)
        self.port = port
        self.event_bytes = self.tile_bytes = self.tiles = 0
        self.versions = {}
        self.islands = []

    def get(self, path):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        connection.request("GET", path)
        body = connection.getresponse().read()
        connection.close()
        return body

    def run(self):
        try:
            connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
            connection.request("GET", "/events")
            topic = ""
            for line in connection.getresponse():
                self.event_bytes += len(line)
                if line.startswith(b"event: "):
                    topic = line[7:].strip()
                elif line.startswith(b"data: ") and topic == b"islands":
                    self.watch(json.loads(line[6:]))
        except (OSError, http.client.HTTPException):
            pass  # the server has ended

    def watch(self, islands):
        for island in islands:
            number = island["id"]
            changed = self.get(f"/tiles/{number}?since={self.versions.get(number, 0)}")
            self.tile_bytes += len(changed)
            for zoom, x, y, version in json.loads(changed):
                if zoom == self.ZOOM:
                    self.tile_bytes += len(self.get(f"/tile/{number}/{zoom}/{x}/{y}?v={version}"))
                    self.tiles += 1
            self.versions[number] = island["tiles"]


class FoxgloveViewer(threading.Thread):
    """Subscribes to all that there is, as Foxglove does where everything is shown."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.port = port
        self.bytes = self.messages = 0

    def run(self):
        try:
            with socket.create_connection(("127.0.0.1", self.port), timeout=30) as connection:
                self.watch(connection.makefile("rwb"))
        except (OSError, EOFError):
            pass  # the server has ended

    def watch(self, stream):
        stream.write(f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                     f"Sec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}\r\nSec-WebSocket-Version: 13\r\n"
                     "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n\r\n".encode())
        stream.flush()
        while stream.readline().strip():
            pass
        while True:
            opcode, payload = self.hear(stream)
            self.bytes += len(payload)
            self.messages += opcode == 2
            if opcode == 9:
                self.say(stream, 10, payload)
            elif opcode == 1 and (told := json.loads(payload))["op"] == "advertise":
                wanted = [{"id": channel["id"], "channelId": channel["id"]} for channel in told["channels"]]
                self.say(stream, 1, json.dumps({"op": "subscribe", "subscriptions": wanted}).encode())

    @staticmethod
    def hear(stream):
        """A message, of one frame or several."""
        opcode, payload, last = 0, b"", False
        while not last:
            head = stream.read(2)
            if len(head) < 2:
                raise EOFError
            last, opcode, length = head[0] & 0x80 != 0, head[0] & 0x0F or opcode, head[1] & 0x7F
            if length > 125:
                length = int.from_bytes(stream.read(2 if length == 126 else 8), "big")
            payload += stream.read(length)
        return opcode, payload

    @staticmethod
    def say(stream, opcode, payload):
        short = len(payload) < 126
        size = bytes([0x80 | len(payload)]) if short else struct.pack(">BH", 0x80 | 126, len(payload))
        stream.write(bytes([0x80 | opcode]) + size + bytes(4) + payload)  # the mask is 0
        stream.flush()


class Asker(threading.Thread):
    """Asks what is refused, so many times a second, under ever other names."""

    BURST_S = 0.01

    def __init__(self, port, rate, types):
        super().__init__(daemon=True)
        self.address, self.rate, self.asked, self.ended = ("239.255.76.67", port), rate, 0, False
        self.questions = [self.question(types, f"A{i}", **fields) for i in range(50)
                          for fields in ({"radius_m": float("nan")}, {"kind": "why"}, {"robot": "nobody"}, {"id": 7})]

    @staticmethod
    def question(types, asker, **fields):
        request = types.request_t()
        request.asker, request.kind, request.timeout_s, request.robot = asker, "frontiers", 5.0, "R99"
        request.patch_from_start, request.patch_from_target = [0, 0, 0], [0, 0, 0]
        for name, value in fields.items():
            setattr(request, name, value)
        data = request.encode()
        return b"LC02\0\0\0\0ISTHMUS_REQUEST\0" + (data[:-1] if "id" in fields else data)

    def run(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            out.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
            began = time.monotonic()
            while not self.ended:
                while self.asked < self.rate * (time.monotonic() - began):
                    out.sendto(self.questions[self.asked % len(self.questions)], self.address)
                    self.asked += 1
                time.sleep(self.BURST_S)


def question_types(work):
    subprocess.run(["lcm-gen", "-p", "--ppath", work, os.path.join(ROOT, "lcmtypes", "request_t.lcm")], check=True)
    sys.path.insert(0, work)
    import isthmus  # pylint: disable=import-error,import-outside-toplevel
    return isthmus


def viewer_options(arguments):
    page = ["--http-port", str(arguments.http_port)] if arguments.viewers else []
    return page + (["--foxglove-port", str(arguments.foxglove_port)] if arguments.foxglove_viewers else [])


def viewers_of(arguments, work):
    return [Viewer(arguments.http_port) for _ in range(arguments.viewers)] + [
        FoxgloveViewer(arguments.foxglove_port) for _ in range(arguments.foxglove_viewers)] + (
            [Asker(arguments.port, arguments.bad_questions, question_types(work))] if arguments.bad_questions else [])


def play(arguments, log, work):
    """Runs server, logger and viewers while the log is played; returns journal, heard log, the server's report and
    the viewers."""
    url = f"udpm://239.255.76.67:{arguments.port}?ttl=0&recv_buf_size={RECEIVE_BUFFER}"
    journal, output, heard = (os.path.join(work, name) for name in ("journal", "map", "heard.lcm"))
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with open(os.path.join(work, "server.log"), "wb") as errors:
        server = subprocess.Popen([os.path.join(arguments.build, "bin", "isthmus-server"), "--lcm-url", url,
                                   "--journal", journal, "--output", output, *viewer_options(arguments)], stderr=errors)
    logger = subprocess.Popen(["lcm-logger", "--force", f"--lcm-url={url}", "--channel=.*_(SCAN|POSE)", heard], **quiet)
    try:
        time.sleep(1)  # robots say what they are at the log's beginning only
        viewers = viewers_of(arguments, work)
        for viewer in viewers:
            viewer.start()
        subprocess.run(["lcm-logplayer", f"--lcm-url={url}", log], check=True, **quiet)
        time.sleep(2)
        for asker in (one for one in viewers if isinstance(one, Asker)):
            asker.ended = True
    finally:
        logger.send_signal(signal.SIGINT)
        server.send_signal(signal.SIGTERM)
        logger.wait()
        code = server.wait(timeout=600)
    if code != 0:
        raise RuntimeError(f"the server failed: see {work}/server.log")
    with open(os.path.join(output, "report.json"), encoding="utf-8") as file:
        report = json.load(file)
    segments = sorted(os.path.join(journal, name) for name in os.listdir(journal) if name.endswith(".lcm"))
    return segments, heard, report, viewers


def tell_page(report, viewers):
    engine = report["event_latency_ms"]
    print("engine    " + ", ".join(f"{name} {value:.3f} ms" for name, value in engine.items()))
    pages = [one for one in viewers if isinstance(one, Viewer)]
    if pages:
        print(f"viewers   {len(pages)}, each {sum(one.event_bytes for one in pages) / len(pages) / 1e3:.0f} kB of "
              f"events, {sum(one.tiles for one in pages) / len(pages):.0f} tiles, "
              f"{sum(one.tile_bytes for one in pages) / len(pages) / 1e3:.0f} kB")
    others = [one for one in viewers if isinstance(one, FoxgloveViewer)]
    if others:
        print(f"foxglove  {len(others)}, each {sum(one.messages for one in others) / len(others):.0f} messages, "
              f"{sum(one.bytes for one in others) / len(others) / 1e3:.0f} kB")
    for asker in (one for one in viewers if isinstance(one, Asker)):
        print(f"asked     {asker.asked}")


def compare(arguments, log, work):
    """Pairs of runs with and without viewers and askers; every other pair begins with those, so that what changes with time is in
    both alike."""
    alone = argparse.Namespace(**{**vars(arguments), "viewers": 0, "foxglove_viewers": 0, "bad_questions": 0})
    pairs = []
    for pair in range(arguments.compare):
        latencies = {}
        for watched in (pair % 2 == 0, pair % 2 != 0):
            directory = os.path.join(work, f"pair-{pair}-{'watched' if watched else 'alone'}")
            os.makedirs(directory)
            _, _, report, viewers = play(arguments if watched else alone, log, directory)
            latencies[watched] = report["event_latency_ms"]
            if watched:
                tell_page(report, viewers)
        pairs.append((latencies[True], latencies[False]))
        print(f"pair {pair + 1}    p99 {latencies[True]['p99']:.3f} ms with viewers, {latencies[False]['p99']:.3f} ms without: "
              f"{latencies[True]['p99'] / latencies[False]['p99']:.3f}", flush=True)
    for name in ("p50", "p99"):
        ratios = [watched[name] / without[name] for watched, without in pairs if without[name] > 0]
        if ratios:
            print(f"ratio     {name} with viewers to without: least {min(ratios):.3f}, middle {statistics.median(ratios):.3f}, "
                  f"largest {max(ratios):.3f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--log", help="play this log instead of a simulated team")
    parser.add_argument("--robots", type=int, default=14)
    parser.add_argument("--rate", type=float, default=10, help="scans a second of each robot")
    parser.add_argument("--seconds", type=float, default=150)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--build", default=os.path.join(ROOT, ".build", "release"))
    parser.add_argument("--port", type=int, default=7699)
    parser.add_argument("--viewers", type=int, default=0, help="how many watch the page, 16 at most")
    parser.add_argument("--http-port", type=int, default=8099)
    parser.add_argument("--foxglove-viewers", type=int, default=0, help="how many watch as Foxglove does")
    parser.add_argument("--foxglove-port", type=int, default=8769)
    parser.add_argument("--bad-questions", type=float, default=0, metavar="RATE", help="asked a second")
    parser.add_argument("--compare", type=int, default=0, metavar="PAIRS", help="runs with viewers and without, in turn")
    parser.add_argument("--most-lost", type=float, default=1e-4, help="share of messages; more is a failure")
    parser.add_argument("--keep", metavar="DIR", help="keep log, journal and map in this directory")
    arguments = parser.parse_args()
    if arguments.compare > 0 and not (arguments.viewers or arguments.foxglove_viewers or arguments.bad_questions):
        parser.error("--compare needs --viewers, --foxglove-viewers or --bad-questions")
    warn_of_small_buffer()
    with tempfile.TemporaryDirectory() as scratch:
        work = arguments.keep or scratch
        os.makedirs(work, exist_ok=True)
        log = arguments.log or os.path.join(work, "run.lcm")
        if not arguments.log:
            simulate(arguments, log)
        if arguments.compare > 0:
            compare(arguments, log, work)
            return 0
        journal, heard, report, viewers = play(arguments, log, work)
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
        tell_page(report, viewers)
    return 1 if share > arguments.most_lost else 0


if __name__ == "__main__":
    sys.exit(main())
