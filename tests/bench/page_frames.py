#!/usr/bin/env python3
"""What a frame of the page costs: Chromium, without a screen, draws a large map that is made up here.

    tests/bench/page_frames.py [--patches 10000] [--robots 100] [--web server/wire/page/web] [--picture FILE]

Patches, relations and trails are all shown; the map is dragged, zoomed and left to be while robots move at 5 Hz. Of
each it prints the processor time of the longest tasks of the page's thread, as many as there were frames, from the
browser's own trace: script, layout, and what the canvases cost behind the script. Exit code 1 where one took over
16 ms.
"""

import argparse
import http.server
import json
import math
import os
import shutil
import struct
import sys
import threading
import time
import zlib

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
except ImportError:
    sys.exit("page_frames.py: needs python3-selenium, chromium and chromedriver")

LEAFLET = "/usr/share/javascript/leaflet"
SPACING_M = 4
CELL_M = 0.05
TILE_CELLS = 256
COARSEST_ZOOM = -6
FRAME_MS = 16
TYPES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css"}


class Map:
    """Patches in a square; each is related with the one before it, the one below and the one across."""

    def __init__(self, patches, robots):
        self.side = math.isqrt(patches)
        self.patches = self.side**2
        self.robots = [f"R{i + 1}" for i in range(robots)]
        self.version = 1
        self.box = [0, 0, SPACING_M * self.side, SPACING_M * self.side]

    def position(self, patch):
        row, column = divmod(patch, self.side)
        return SPACING_M * column + math.sin(patch), SPACING_M * row + math.cos(patch)

    def relations(self):
        for patch in range(self.patches):
            for before in (patch - 1, patch - self.side, patch - self.side - 1):
                if before >= 0:
                    yield before, patch

    def arrays(self):
        names = "".join(name + "\n" for name in self.robots).encode()
        names += b"\n" * (-len(names) % 4)
        relations = list(self.relations())
        places = [self.position(i) for i in range(self.patches)]
        share = self.patches / len(self.robots)
        return b"".join([
            struct.pack("<3I", self.patches, len(relations), len(names)), names,
            pack("i", range(self.patches)), pack("i", (int(i / share) for i in range(self.patches))),
            pack("f", (x for x, _ in places)), pack("f", (y for _, y in places)), pack("f", (0.1 * i for i in range(self.patches))),
            pack("i", (10 * i for i in range(self.patches))),
            pack("i", (a for a, _ in relations)), pack("i", (b for _, b in relations)),
            pack("i", (i % 6 for i in range(len(relations)))), pack("i", (-1 for _ in relations))])

    def tiles(self):
        """As the server tells of them: y grows downwards from the island's origin."""
        for zoom in range(COARSEST_ZOOM, 1):
            count = math.ceil(self.box[2] / CELL_M * 2**zoom / TILE_CELLS)
            for x in range(count):
                for y in range(count):
                    yield [zoom, x, -1 - y, 1]

    def events(self, step):
        """Topics with their values, as they are after so many steps of the robots."""
        if step == 0:
            yield "about", {"run": 1, "signed": False, "types": {}, "cell_m": CELL_M, "tile_cells": TILE_CELLS, "coarsest_zoom": COARSEST_ZOOM}
            yield "status", {"patches": self.patches, "relations": 0, "matched": 1, "islands": 1, "queued": 0, "latency_p99_ms": 1.5, "frozen": False, "recovering": False, "warnings": [], "left_out": [],
                             "colours": self.robots, "scans": 0, "scans_matched": 0, "time": 0,
                             "robots": [{"name": name, "scan_hz": 10, "matched": 1, "heard": 0} for name in self.robots]}
            yield "islands", [{"id": 0, "tiles": 1, "map": self.version, "patches": self.patches, "rank": 0, "end": 10 * self.patches,
                               "box": self.box}]
            yield "annotations", [{"kind": "keep_out", "name": f"zone {i}", "max_speed": 0, "island": 0, "moved": 0, "lost": False,
                                   "points": [[40 * i, 40, 0], [40 * i + 20, 40, 0], [40 * i + 20, 80, 0], [40 * i, 80, 0]]}
                                  for i in range(9)]
            yield "closures", [{"id": i, "kind": "merge" if i % 9 == 0 else "closure", "state": "accepted", "reason": "", "forbidden": False, "robots": ["R1"], "patches": 9,
                                "steps": 9, "relations": 9, "trial": None, "start": 0, "end": 1,
                                "line": [0, *self.position(31 * i % self.patches), *self.position(57 * i % self.patches)]} for i in range(300)]
            share = self.patches // len(self.robots)
            yield "trails", {name: [[0, *self.position(i * share + j)] for j in range(share)] for i, name in enumerate(self.robots)}
        robots = []
        for i, name in enumerate(self.robots):
            x, y = self.position((i * self.patches // len(self.robots) + step) % self.patches)
            robots.append({"name": name, "time": 0, "matched": True, "heard": True, "at": [0, x, y, 0.1 * step]})
        yield "robots", robots
        if step % 5 == 0:  # with each status
            ahead = [[self.position((i * self.patches // len(self.robots) + step + j) % self.patches) for j in range(40)]
                     for i in range(len(self.robots))]
            yield "exploration", {"goals": [{"robot": name, "reason": "frontier", "island": 0, "gain": 9, "goal": [*ahead[i][-1], 0], "way": ahead[i]}
                                            for i, name in enumerate(self.robots)],
                                  "frontiers": [[0, *self.position(160 * i % self.patches), i, 12] for i in range(60)]}


def pack(kind, values):
    values = list(values)
    return struct.pack(f"<{len(values)}{kind}", *values)


def tile_png():
    """Rooms, in map_server's greys."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    def grey(x, y):
        if x % 64 < 2 or y % 64 < 2:
            return 0
        return 205 if (x // 64 + y // 64) % 4 == 0 else 254

    rows = b"".join(b"\0" + bytes(grey(x, y) for x in range(TILE_CELLS)) for y in range(TILE_CELLS))
    header = struct.pack(">2I5B", TILE_CELLS, TILE_CELLS, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def handler_of(world, web):
    arrays, tile = world.arrays(), tile_png()

    class Handler(http.server.BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.0"

        def log_message(self, *_):
            pass

        def answer(self, body, kind):
            self.send_response(200)
            self.send_header("Content-Type", kind)
            self.end_headers()
            self.wfile.write(body)

        def stream(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/event-stream")
            self.end_headers()
            for step in range(10**6):
                for topic, value in world.events(step):
                    self.wfile.write(f"event: {topic}\ndata: {json.dumps(value)}\n\n".encode())
                self.wfile.flush()
                time.sleep(0.2)

        def do_GET(self):
            path = self.path.split("?")[0]
            try:
                if path == "/events":
                    return self.stream()
                if path.startswith("/patches/"):
                    return self.answer(arrays, "application/octet-stream")
                if path.startswith("/tiles/"):
                    return self.answer(json.dumps(list(world.tiles())).encode(), "application/json")
                if path.startswith("/tile/"):
                    return self.answer(tile, "image/png")
                name = path.lstrip("/") or "index.html"
                folder = LEAFLET if name.startswith("leaflet") else web
                with open(os.path.join(folder, name), "rb") as file:
                    return self.answer(file.read(), TYPES.get(os.path.splitext(name)[1], "text/plain"))
            except (BrokenPipeError, ConnectionResetError):
                pass
            except OSError:
                self.send_error(404)

    return Handler


# Each calls `act(i)` in so many frames of the browser and then waits; resolves to the page's own drawing, ms.
FRAMES = """
const [frames, act, tell] = arguments;
const does = new Function("i", act);
const own = [];
let i = 0;
const next = () => {
  if (i > 0) own.push(isthmus.overlay.frame_ms);
  if (i >= frames) return tell(own);
  does(i++);
  requestAnimationFrame(next);
};
requestAnimationFrame(next);
"""

ACTS = {
    "dragged": (200, "isthmus.map.panBy([i % 100 < 50 ? 7 : -7, i % 60 < 30 ? 3 : -3], {animate: false});"),
    "zoomed": (300, "if (i % 12 === 0) isthmus.map.setZoom([-5, -4, -3, -2, -4][(i / 12) % 5], {animate: false});"),
    "left to be": (300, ""),
}


def open_browser():
    options = webdriver.ChromeOptions()
    for one in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--window-size=1400,960"):
        options.add_argument(one)
    options.set_capability("goog:loggingPrefs", {"performance": "ALL"})
    options.add_experimental_option("perfLoggingPrefs", {"enableNetwork": False, "enablePage": False,
                                                         "traceCategories": "devtools.timeline,toplevel"})
    options.binary_location = shutil.which("chromium")
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


def trace_of(browser):
    """Events of the trace so far: the browser gives them away some time after they were asked for."""
    events = []
    for _ in range(3):
        time.sleep(1)
        for entry in browser.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Tracing.dataCollected":
                events.append(message["params"])
    return events


def tasks_ms(events, act):
    """Processor time of the tasks of the page's main thread while something was done, ms."""
    marks = {e["args"]["data"]["message"]: e for e in events if e.get("name") == "TimeStamp"}
    begin, end = marks[act], marks[f"end of {act}"]
    of_page = [e for e in events if (e["pid"], e["tid"]) == (begin["pid"], begin["tid"]) and "tdur" in e]
    return [e["tdur"] / 1000 for e in of_page if e["name"].endswith("RunTask") and begin["ts"] < e["ts"] < end["ts"]]


def share(values, part):
    return sorted(values)[min(len(values) - 1, int(part * len(values)))] if values else 0


def serve(world, web):
    """A server of such a map, in a thread of its own."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler_of(world, web))
    server.daemon_threads = True
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--patches", type=int, default=10000)
    parser.add_argument("--robots", type=int, default=100)
    parser.add_argument("--web", default=os.path.join(os.path.dirname(__file__), "../../server/wire/page/web"))
    parser.add_argument("--picture", help="file, PNG, of what was on the screen at last")
    arguments = parser.parse_args()
    world = Map(arguments.patches, arguments.robots)
    server = serve(world, arguments.web)
    browser = open_browser()
    worst_of_all = 0
    try:
        browser.set_script_timeout(120)
        browser.get(f"http://127.0.0.1:{server.server_address[1]}/")
        for name in ("patches", "relations"):
            browser.execute_script(f"document.getElementById('show-{name}').click()")
        end = time.monotonic() + 30
        while not browser.execute_script("return window.isthmus?.patches.of(0) !== undefined") and time.monotonic() < end:
            time.sleep(0.1)
        time.sleep(1)
        own = {}
        for name, (frames, act) in ACTS.items():
            browser.execute_script("console.timeStamp(arguments[0])", name)
            own[name] = browser.execute_async_script(FRAMES, frames, act)
            browser.execute_script("console.timeStamp(arguments[0])", f"end of {name}")
        events = trace_of(browser)
        for name, (frames, _) in ACTS.items():
            tasks = tasks_ms(events, name)
            worst_of_all = max([worst_of_all, *tasks])
            of_frames = sorted(tasks)[-frames:]
            print(f"{name}: {frames} frames; ms of the page's thread: median {share(of_frames, 0.5):.1f}, 95 % {share(of_frames, 0.95):.1f}, "
                  f"worst {max(tasks, default=0):.1f}; over {FRAME_MS} ms: {sum(ms > FRAME_MS for ms in tasks)}; of it its own "
                  f"drawing: median {share(own[name], 0.5):.1f}, worst {max(own[name]):.1f} (by the clock)")
        if arguments.picture:
            browser.execute_script("isthmus.map.setZoom(-3, {animate: false})")
            time.sleep(1)
            browser.save_screenshot(arguments.picture)
        for entry in browser.get_log("browser"):
            print(f"in the console: {entry['message']}")
    finally:
        browser.quit()
        server.shutdown()
    return 0 if worst_of_all < FRAME_MS else 1


if __name__ == "__main__":
    sys.exit(main())
