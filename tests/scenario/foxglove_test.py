#!/usr/bin/env python3
"""A live server watched as Foxglove does it: a simulated team is played to it, and a client of WebSockets by bytes
subscribes to all there is. What the server kept is written as MCAP afterwards.

    tests/scenario/foxglove_test.py --build .build/dev
"""

import argparse
import base64
import json
import os
import socket
import struct
import subprocess
import sys
import tempfile
import time

from live import LIMIT_S, Server, free_lcm_port, free_port, lcm_url

PLAYED_FASTER = 6
SCHEMAS = {"/tf": "FrameTransforms", "/scene": "SceneUpdate", "/log": "Log", "/R1/pose": "PoseInFrame",
           "/R1/scan": "LaserScan", "/R2/pose": "PoseInFrame", "/R2/scan": "LaserScan", "/island-0/grid": "Grid"}


class Client:
    """A client of the protocol: subscribes to each channel that is advertised, counts messages by topic."""

    def __init__(self, port, protocol):
        self.topics, self.schemas, self.messages, self.withdrawn = {}, {}, {}, []
        self.stream = self.connect(port).makefile("rwb")
        key = base64.b64encode(os.urandom(16)).decode()
        self.stream.write((f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                           f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
                           f"Sec-WebSocket-Protocol: {protocol}\r\n\r\n").encode())
        self.stream.flush()
        head = b""
        while not head.endswith(b"\r\n\r\n"):
            head += self.stream.read(1)
        if b" 101 " not in head or protocol.encode() not in head:
            raise RuntimeError(head.decode())

    @staticmethod
    def connect(port):
        end = time.monotonic() + LIMIT_S
        while True:
            try:
                return socket.create_connection(("127.0.0.1", port), timeout=LIMIT_S)
            except OSError:
                if time.monotonic() > end:
                    raise
                time.sleep(0.05)

    def say(self, opcode, payload):
        size = struct.pack(">BB", 0x80 | opcode, 0x80 | len(payload)) if len(payload) < 126 else struct.pack(
            ">BBH", 0x80 | opcode, 0x80 | 126, len(payload))
        self.stream.write(size + bytes(4) + payload)  # the mask is 0
        self.stream.flush()

    def hear(self):
        """One message; what it was."""
        opcode, payload, last = 0, b"", False
        while not last:
            first, second = self.stream.read(2)
            last, opcode = first & 0x80 != 0, first & 0x0F or opcode
            length = second & 0x7F
            if length > 125:
                length = int.from_bytes(self.stream.read(2 if length == 126 else 8), "big")
            payload += self.stream.read(length)
        if opcode == 9:
            self.say(10, payload)
        elif opcode == 1:
            self.take(json.loads(payload))
        elif opcode == 2:
            topic = self.topics[struct.unpack("<I", payload[1:5])[0]]
            self.messages.setdefault(topic, []).append(json.loads(payload[13:]))

    def take(self, told):
        if told["op"] == "advertise":
            for channel in told["channels"]:
                self.topics[channel["id"]] = channel["topic"]
                self.schemas[channel["topic"]] = channel["schemaName"]
                json.loads(channel["schema"])
                subscription = {"id": channel["id"], "channelId": channel["id"]}
                self.say(1, json.dumps({"op": "subscribe", "subscriptions": [subscription]}).encode())
        elif told["op"] == "unadvertise":
            self.withdrawn += [self.topics[one] for one in told["channelIds"]]
        elif told["op"] == "status":
            raise RuntimeError(told["message"])


def run(*command):
    return subprocess.run(command, check=True, timeout=600, capture_output=True, text=True).stdout


def frames_of(client):
    """Each frame's parent, by the newest that came of it."""
    return {one["child_frame_id"]: one["parent_frame_id"] for message in client.messages.get("/tf", [])
            for one in message["transforms"]}


def watch(client):
    """Until two islands have merged and all that was expected has come."""
    end = time.monotonic() + LIMIT_S
    while time.monotonic() < end:
        client.hear()
        merged = any("merge" in one["message"] and "accepted" in one["message"] for one in client.messages.get("/log", []))
        all_came = set(SCHEMAS) <= set(client.messages) and "island-0" in frames_of(client)
        if merged and client.withdrawn and all_came:
            return
    raise RuntimeError(f"came: {sorted(client.messages)}, withdrawn: {client.withdrawn}")


def judge(client):
    for topic, schema in SCHEMAS.items():
        if client.schemas[topic] != f"foxglove.{schema}":
            raise RuntimeError(f"{topic} is {client.schemas[topic]}")
    frames = frames_of(client)
    if frames.get("R1/laser") != "R1" or frames.get("R1") != "island-0" or frames.get("island-0") != "map":
        raise RuntimeError(f"frames: {frames}")
    grid = client.messages["/island-0/grid"][-1]
    if len(base64.b64decode(grid["data"])) % grid["column_count"] != 0:
        raise RuntimeError("a grid of other rows than it says")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", default=".build/dev")
    arguments = parser.parse_args()
    programs = os.path.join(os.path.abspath(arguments.build), "bin")
    url = lcm_url(free_lcm_port())
    with tempfile.TemporaryDirectory() as work:
        log, journal, mcap = (os.path.join(work, name) for name in ("run.lcm", "journal", "run.mcap"))
        run(os.path.join(programs, "isthmus-simulate"), "--scenario", "meeting", "--set", "duration_s=60", "-o", log)
        port = free_port()
        with Server(arguments.build, url, work) as server:
            server.start("--journal", journal, "--foxglove-port", str(port))
            client = Client(port, "foxglove.sdk.v1")
            player = subprocess.Popen(["lcm-logplayer", "-s", str(PLAYED_FASTER), "-l", url, log],
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                watch(client)
            finally:
                player.wait(timeout=LIMIT_S)
            judge(client)
        print(run(os.path.join(programs, "isthmus-export"), journal, "--mcap", mcap).strip())
        with open(mcap, "rb") as file:
            content = file.read()
        if not content.startswith(b"\x89MCAP0\r\n") or any(topic.encode() not in content for topic in SCHEMAS):
            raise RuntimeError("the journal's MCAP lacks something")
    print({topic: len(messages) for topic, messages in sorted(client.messages.items())})
    return 0


if __name__ == "__main__":
    sys.exit(main())
