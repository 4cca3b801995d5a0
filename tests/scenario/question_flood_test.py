#!/usr/bin/env python3
"""Floods of bad questions against a live server: each kind is refused with its reason, memory stays bounded, and what
is in order is answered meanwhile. Robots are mapped as if nobody asked.

    tests/scenario/question_flood_test.py --build .build/dev
"""

import argparse
import collections
import http.client
import os
import re
import struct
import subprocess
import sys
import tempfile
import threading
import time

from live import LIMIT_S, ROOT, Server, check, free_lcm_port, free_port, generate_types, lcm_url

sys.path.insert(0, os.path.join(ROOT, "tools", "examples"))
from small_lcm import Lcm  # pylint: disable=wrong-import-position

FLOOD_S = 8
ROBOT_S = FLOOD_S + 6
MAX_GROWTH_MB = 64  # of the server's resident memory: several times less than a flood of the largest questions sends
NAN, HUGE = float("nan"), 1e300


class Bytes:
    """What is sent as it is."""

    def __init__(self, data):
        self.data = data

    def encode(self):
        return self.data


def question(types, asker, **fields):
    request = types.request_t()
    request.utime, request.id, request.asker = int(time.time() * 1e6), 1, asker
    request.kind, request.timeout_s, request.robot = "frontiers", 5.0, "R1"
    request.patch_from_start, request.patch_from_target = [0, 0, 0], [0, 0, 0]
    request.radius_m = 0.2
    for name, value in fields.items():
        setattr(request, name, value)
    return request


def bad_questions(types, asker):
    """(reason, message) of each kind of bad question."""
    good = question(types, asker).encode()
    long_name = struct.pack(">i", 2**31 - 1)
    return [
        ("bad_kind", question(types, asker, kind="x" * 40)),
        ("bad_kind", question(types, asker, kind="path", target="nowhere")),
        ("bad_name", question(types, "")),
        ("bad_name", question(types, asker, robot="../../etc")),
        ("bad_value", question(types, asker, radius_m=NAN)),
        ("bad_value", question(types, asker, radius_m=HUGE)),
        ("bad_value", question(types, asker, radius_m=-1.0)),
        ("bad_value", question(types, asker, timeout_s=HUGE)),
        ("bad_value", question(types, asker, patch_from_start=[NAN, 0, 0])),
        ("bad_value", question(types, asker, follow_s=float("inf"))),
        ("unknown_robot", question(types, asker, robot="R99")),
        ("unknown_patch", question(types, asker, robot="", start_patch=2**31 - 1)),
        ("bad_bytes", Bytes(b"")),
        ("bad_bytes", Bytes(good[:-1])),
        ("bad_bytes", Bytes(os.urandom(200))),
        ("bad_bytes", Bytes(good[:24] + long_name + good[28:])),  # the asker's name ends far behind the message
        ("bad_bytes", question(types, "y" * 60000)),
    ]


def flood(types, port, asker, end, sent):
    """As fast as it can, from one sender, under one name or ever others."""
    network, number = Lcm(port), 0
    while time.monotonic() < end:
        for reason, message in bad_questions(types, asker or f"A{number}"):
            network.publish("ISTHMUS_REQUEST", message)
            sent[reason] += 1
        number += 1


def metrics(port):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
    connection.request("GET", "/metrics")
    text = connection.getresponse().read().decode()
    connection.close()
    return {outcome: int(float(count))
            for outcome, count in re.findall(r'questions_total\{outcome="(\w+)"\} (\S+)', text)}


def resident_mb(process):
    with open(f"/proc/{process.pid}/status", encoding="ascii") as file:
        return int(re.search(r"VmRSS:\s+(\d+)", file.read())[1]) / 1024


def answer(types, network, request):
    """The reply to a question that is asked again until it is answered: on a flooded network messages are lost."""
    end = time.monotonic() + LIMIT_S
    while time.monotonic() < end:
        network.publish("ISTHMUS_REQUEST", request)
        again = time.monotonic() + 1
        while (left := again - time.monotonic()) > 0:
            got = network.receive(left)
            if got and got[0] == "ISTHMUS_REPLY":
                reply = types.reply_t.decode(got[1])
                if reply.asker == request.asker and reply.request_id == request.id and reply.reason != "queue_full":
                    return reply
    raise SystemExit(f"nobody answers {request.asker}")


def each_reason_is_told(types, network):
    for number, (reason, message) in enumerate(bad_questions(types, "one")):
        if reason == "bad_bytes":
            continue  # whose it is nobody knows
        message.id = 100 + number
        reply = answer(types, network, message)
        check((reply.done, reply.reason) == (0, reason), f"question {number}: {reply.reason}, not {reason}")


def watch(arguments, port, types, work):
    metrics_port, network = free_port(), Lcm(port)
    with Server(arguments.build, lcm_url(port), work) as server:
        server.start("--metrics-port", str(metrics_port), "--output", os.path.join(work, "map"))
        with subprocess.Popen([os.path.join(arguments.build, "examples", "example-robot"), "R1", "1", str(ROBOT_S),
                               lcm_url(port)], stdout=subprocess.DEVNULL) as robot:
            check(answer(types, network, question(types, "before")).done == 1, "a question is answered")
            each_reason_is_told(types, network)
            before_mb, sent = resident_mb(server.process), collections.Counter()
            end = time.monotonic() + FLOOD_S
            senders = [threading.Thread(target=flood, args=(types, port, asker, end, sent)) for asker in ("one", "")]
            for sender in senders:
                sender.start()
            check(answer(types, network, question(types, "amid")).done == 1, "a question amid the flood is answered")
            for sender in senders:
                sender.join()
            growth_mb = resident_mb(server.process) - before_mb
            check(robot.wait(timeout=LIMIT_S) == 0, "the robot has driven")
        check(answer(types, network, question(types, "after")).done == 1, "a question after the flood is answered")
        counts = metrics(metrics_port)
        print(f"{sum(sent.values()) / FLOOD_S:.0f} questions a second; {growth_mb:.1f} MB more; {counts}")
        check(growth_mb < MAX_GROWTH_MB, f"memory is bounded: {growth_mb} MB more")
        for reason in ("bad_kind", "bad_name", "bad_value", "bad_bytes"):
            check(0 < counts.get(reason, 0) <= sent[reason] + 10 * LIMIT_S, f"{reason} is counted: {counts}")
        check(sum(counts.values()) > 500 * FLOOD_S, "hundreds a second came to the server at least")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=".build/dev")
    arguments = parser.parse_args()
    port = free_lcm_port()
    with tempfile.TemporaryDirectory() as work:
        generate_types(work)
        sys.path.insert(0, work)
        import isthmus as types  # pylint: disable=import-error,import-outside-toplevel
        watch(arguments, port, types, work)


if __name__ == "__main__":
    main()
