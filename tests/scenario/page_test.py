#!/usr/bin/env python3
"""The page in a browser: Chromium, without a screen, watches a server to which a simulated team is played.

    tests/scenario/page_test.py --build .build/dev [--pictures DIR] [Page.test_an_exploration_is_shown_live]

All tests, if none is named, run at the same time, each as a process: mostly they wait for robots and for frames.
Exit code 0 where all holds, 1 with what does not; 0 and "no browser" where Chromium, its driver or Selenium are
missing (tools/install-dependencies.sh --browser).
"""

import argparse
import concurrent.futures
import json
import math
import os
import secrets
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request

from live import LIMIT_S, Server, free_lcm_port, free_port, lcm_url

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../bench"))

try:
    import page_frames
    from selenium import webdriver
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
except (ImportError, SystemExit):  # page_frames.py ends without selenium
    webdriver = None

PLAYED_FASTER = 6
WEB = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../server/wire/page/web")
COLOURS = "[...document.querySelectorAll('#robots .robot')].map((one) => one.style.getPropertyValue('--colour'))"
ARGUMENTS = argparse.Namespace(build=".build/dev", pictures=None)

# How many pixels of the map are painted, sampled; kept for each frame, so that a flicker is seen.
WATCH_PAINT = """
window.paint = [];
const small = document.createElement("canvas");
small.width = small.height = 32;
const context = small.getContext("2d", {willReadFrequently: true});
const look = () => {
  let painted = 0;
  for (const tile of isthmus.tiles.shown()) {
    context.clearRect(0, 0, 32, 32);
    context.drawImage(tile, 0, 0, 32, 32);
    const bytes = context.getImageData(0, 0, 32, 32).data;
    for (let i = 3; i < bytes.length; i += 4) painted += bytes[i] > 0 ? 1 : 0;
  }
  window.paint.push([painted, isthmus.map.getZoom(), isthmus.scene.islands.length]);
  requestAnimationFrame(look);
};
look();
"""


def missing():
    """What the test needs and is not there; empty: nothing."""
    names = [name for name in ("chromium", "chromedriver", "lcm-logplayer") if shutil.which(name) is None]
    return names + (["python3-selenium"] if webdriver is None else [])


def program(name):
    return os.path.join(ARGUMENTS.build, "bin", name)


class PageServer(Server):
    """isthmus-server with a page, on a journal; started and stopped."""

    def __init__(self, work):
        super().__init__(ARGUMENTS.build, lcm_url(free_lcm_port()), work)
        self.journal = os.path.join(work, "journal")
        self.port = free_port()

    def start(self, *options):
        super().start("--journal", self.journal, "--http-port", str(self.port), *options)


def open_browser():
    options = webdriver.ChromeOptions()
    for one in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--window-size=1400,960"):
        options.add_argument(one)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    options.binary_location = shutil.which("chromium")
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


class InBrowser(unittest.TestCase):
    """What tests of a page in a browser need."""

    def setUp(self):
        self.browser = open_browser()
        self.addCleanup(self.browser.quit)

    def js(self, expression):
        return self.browser.execute_script(f"return {expression}")

    def wait_for(self, what, is_so):
        end = time.monotonic() + LIMIT_S
        while time.monotonic() < end:
            if is_so():
                return
            time.sleep(0.05)
        self.picture("failed")
        self.fail(f"not within {LIMIT_S} s: {what}")

    def picture(self, name):
        if ARGUMENTS.pictures:
            os.makedirs(ARGUMENTS.pictures, exist_ok=True)
            self.browser.save_screenshot(os.path.join(ARGUMENTS.pictures, f"{name}.png"))

    def text(self, name):
        return self.browser.find_element(By.ID, name).text

    def click(self, name):
        self.browser.find_element(By.ID, name).click()

    def check_console(self, away=()):
        """Nothing but orders that were refused, and that the server was away when it was (milliseconds)."""
        for entry in self.browser.get_log("browser"):
            was_away = any(begin <= entry["timestamp"] <= end for begin, end in away)
            was_refused = "/command" in entry["message"] and "409" in entry["message"]
            if not (entry["source"] == "network" and (was_away or was_refused)):
                self.fail(f"in the console: {entry}")


class Page(InBrowser):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)  # isthmus-snapshot may outlive its server
        self.addCleanup(scratch.cleanup)
        self.work = scratch.name
        self.server = PageServer(self.work)
        self.addCleanup(self.server.stop)
        super().setUp()

    def islands(self):
        return self.js("window.isthmus?.scene.islands.length ?? 0")

    def open_page(self):
        self.browser.get(f"http://127.0.0.1:{self.server.port}/")
        self.wait_for("the page is live", lambda: self.text("link") == "live")

    def play(self, faster=PLAYED_FASTER):
        """The team's drive, faster than it was."""
        log = os.path.join(self.work, "run.lcm")
        subprocess.run([program("isthmus-simulate"), "--scenario", "meeting", "--seed", "1", "--force", "-o", log], check=True,
                       stdout=subprocess.DEVNULL)
        player = subprocess.Popen(["lcm-logplayer", f"--lcm-url={self.server.url}", "--speed", str(faster), log],
                                  stdout=subprocess.DEVNULL)
        self.addCleanup(player.wait)
        self.addCleanup(player.kill)
        return player

    def merge(self, button):
        """Clicks a button of the first merge in the list that has it; waits for what it would change."""
        merges = "//ul[@id='closures']/li[contains(., 'merge')]"
        self.browser.find_element(By.XPATH, f"{merges}//button[text()='{button}']").click()
        self.wait_for("what would change is shown", lambda: self.text("dialog-text"))

    def test_islands_merge_and_part_on_the_screen_and_the_page_outlives_a_restart(self):
        self.server.start("--segment-mb", "0.1")
        self.open_page()
        player = self.play()
        self.wait_for("two islands are on the screen", lambda: self.islands() == 2)
        self.browser.execute_script(WATCH_PAINT)
        self.wait_for("robots are named", lambda: self.text("robots").count("scans/s") == 2)
        self.assertTrue(self.js("document.getElementById('with-exploration').hidden"), "nobody explores")
        self.wait_for("they have merged", lambda: self.islands() == 1)
        # Robots' clocks are those of the log: what they have just seen is no older for that.
        self.wait_for("what they see is drawn", lambda: self.js(
            "isthmus.sightings.some(({ray, time}) => ray && Math.abs(isthmus.status.time - time) < 30)"))
        self.picture("merged")
        player.wait()
        self.look_at_a_closure()
        self.check_no_flicker()
        self.zoom()
        self.fit_the_window()
        self.follow_a_robot()
        self.name_a_place()
        self.draw_a_zone()
        self.ask_for_a_path()
        self.look_at_the_past()
        self.look_at_the_map_as_it_was()
        self.check_closures()
        self.check_console()
        self.withdraw_the_merge()
        self.check_closures()
        self.download()
        self.keep_a_zone_on_one_island()
        self.erase_the_zone()
        self.drop_a_robot()
        self.check_console()
        self.restart()

    def check_no_flicker(self):
        """From one frame to the next, at one zoom, the map never loses most of its paint."""
        frames = self.js("window.paint")
        self.assertGreater(len(frames), 20)
        painted = 0
        for (before, zoom_before, _), (after, zoom, _) in zip(frames, frames[1:]):
            if zoom == zoom_before:
                self.assertGreaterEqual(2 * after + 10, before, "the map flickered")
            painted = max(painted, after)
        self.assertGreater(painted, 100)

    def zoom(self):
        """What is shown stays until it is painted anew."""
        self.browser.execute_script("window.paint = []")
        for step in (-1, 1, 1, -1):
            self.browser.execute_script(f"isthmus.map.setZoom(isthmus.map.getZoom() + {step}, {{animate: false}})")
            time.sleep(0.5)
        frames = self.js("window.paint")
        self.assertGreater(len({zoom for _, zoom, _ in frames}), 1)
        self.assertGreater(min(painted for painted, _, _ in frames), 0, "the map was empty for a moment")

    def refusal_of_signed(self, order, operator, key):
        """Why the server refuses an order that is signed in the browser: it could read it, then."""
        return self.browser.execute_async_script(f"""
            const [tell] = arguments;
            (async () => {{
                const {{keyOf, signedOrder}} = await import("/sign.js");
                window.utime = Math.max(window.utime + 1 || 0, Date.now() * 1000);
                const body = signedOrder({order}, "{operator}", keyOf("{key}"), window.utime, isthmus.about.types);
                const answer = await fetch("command", {{method: "POST", body, headers: {{"Content-Type": "application/octet-stream"}}}});
                tell((await answer.json()).error);
            }})().catch((error) => tell(String(error)));""")

    def follow_a_robot(self):
        """By its name in the list, and where it is on the map; then all is shown again."""
        from_centre = "isthmus.map.latLngToContainerPoint(isthmus.placeOf(isthmus.robots[0])).distanceTo(" \
                      "isthmus.map.getSize().divideBy(2))"
        self.assertGreater(self.js(from_centre), 20)
        self.browser.find_element(By.CSS_SELECTOR, "#robots .robot").click()
        self.wait_for("the robot is in the middle", lambda: self.js(from_centre) < 2)
        self.assertEqual(self.js("isthmus.followed"), "R1")
        self.browser.find_element(By.ID, "map").click()  # in the middle
        self.wait_for("it is followed no longer", lambda: self.js("isthmus.followed") is None)
        self.click("fit")
        self.assertGreater(self.js(from_centre), 20)

    def drag(self, *points):
        """Presses at the first of some points of the map (pixels from its middle), lets go at the last."""
        begin = [round(value) for value in points[0]]
        chain = ActionChains(self.browser).move_to_element_with_offset(self.browser.find_element(By.ID, "map"), *begin)
        chain.click_and_hold()
        for (x0, y0), (x1, y1) in zip(points, points[1:]):
            chain.move_by_offset(round(x1 - x0), round(y1 - y0))
        chain.release().perform()

    def click_map(self, *points):
        for point in points:
            ActionChains(self.browser).move_to_element_with_offset(
                self.browser.find_element(By.ID, "map"), *point).pause(0.05).click().perform()

    def answer_drawn(self, expected, **fields):
        """Fills in what the dialog asks for, and sends it."""
        self.wait_for("it is asked what is drawn", lambda: self.js("document.getElementById('dialog').open"))
        for name, value in fields.items():
            field = self.browser.find_element(By.ID, f"field-{name}")
            field.clear()
            field.send_keys(value)
        self.click("dialog-yes")
        self.wait_for("the server has answered", lambda: self.text("dialog-answer"))
        self.assertEqual(self.text("dialog-answer"), expected)
        self.click("dialog-no")

    def on_screen(self, point):
        """A point of the first place or zone of a name, in pixels from the map's middle."""
        return self.js(f"""(() => {{
            const {{island, points}} = isthmus.annotations.find(({{name}}) => name === "{point}");
            const [ox, oy] = isthmus.scene.offsets.get(island);
            const at = isthmus.map.latLngToContainerPoint([points[0][1] + oy, points[0][0] + ox]);
            return [at.x - isthmus.map.getSize().x / 2, at.y - isthmus.map.getSize().y / 2];
        }})()""")

    def robot_on_screen(self, name):
        """Where a robot is, in pixels from the map's middle."""
        return self.js(f"""(() => {{
            const at = isthmus.map.latLngToContainerPoint(isthmus.placeOf(isthmus.robots.find((one) => one.name === "{name}")));
            return [at.x - isthmus.map.getSize().x / 2, at.y - isthmus.map.getSize().y / 2];
        }})()""")

    def fit_the_window(self):
        """In a smaller window all is still in view, and the page's own parts do not hide one another."""
        size = self.browser.get_window_size()
        self.browser.set_window_size(900, 700)
        inside = "isthmus.scene.islands.every(({id, box}) => isthmus.map.getBounds().contains([" \
                 "[box[1] + isthmus.scene.offsets.get(id)[1], box[0] + isthmus.scene.offsets.get(id)[0]]," \
                 "[box[3] + isthmus.scene.offsets.get(id)[1], box[2] + isthmus.scene.offsets.get(id)[0]]]))"
        self.wait_for("all islands are in view", lambda: self.js(inside) and self.js("isthmus.map.getSize().x") < 700)
        apart = """((a, b) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top)(
            ...[%s].map((one) => document.querySelector(one).getBoundingClientRect()))"""
        for pair in ("'#tools', '.leaflet-control-zoom'", "'#time', '.leaflet-control-scale'"):
            self.assertTrue(self.js(apart % pair), pair)
        self.picture("small_window")
        self.browser.set_window_size(size["width"], size["height"])
        self.wait_for("the window is as it was", lambda: self.js("isthmus.map.getSize().x") > 900)

    def look_at_a_closure(self):
        """It is brought into view where it holds the map together, and what came out of its trial is told."""
        merge = "//ul[@id='closures']/li[contains(., 'merge') and contains(., 'accepted')]"
        self.browser.find_element(By.XPATH, f"{merge}//button[text()='Show']").click()
        self.assertIsNotNone(self.js("isthmus.marked"))
        line = "isthmus.closures.find(({id}) => id === isthmus.marked).line"
        self.assertTrue(self.js(f"""[[1, 2], [3, 4]].every(([x, y]) => {{
            const [east, north] = isthmus.scene.offsets.get({line}[0]);
            return isthmus.map.getBounds().contains([{line}[y] + north, {line}[x] + east]);
        }})"""))
        self.browser.find_element(By.XPATH, f"{merge}//summary").click()
        self.wait_for("its evidence is told", lambda: "propose it" in self.text("closures"))
        time.sleep(0.3)
        self.picture("closure")
        self.click("fit")

    def name_a_place(self):
        """Pressed where it is, dragged the way it faces: it stands there as long as the map does."""
        self.click("draw-place")
        self.drag((60, 20), (90, 20), (60, -40))
        self.answer_drawn("Done.", name="Dock 1")
        self.wait_for("it is listed", lambda: "Dock 1" in self.text("annotations"))
        x, y = self.on_screen("Dock 1")
        self.assertLess(abs(x - 60) + abs(y - 20), 2)
        self.assertAlmostEqual(self.js("isthmus.annotations[0].points[0][2]"), 1.571, delta=0.06)
        self.click("draw-place")
        self.drag((100, 20), self.robot_on_screen("R1"))
        self.assertIsNone(self.js("isthmus.followed"), "the pointer's way to a robot was the place's")
        self.answer_drawn("Refused: another place or zone has this name.", name="dock 1")

    def draw_a_zone(self):
        """Corner by corner; one of them dragged elsewhere afterwards."""
        self.click("draw-keep_out")
        self.click_map((-120, -40), (-20, -40), (-20, 60), (-120, 60))
        self.picture("drawing")
        self.click_map((-120, -40))
        self.wait_for("it is asked what is drawn", lambda: "4 corners" in self.text("dialog-text"))
        self.picture("zone_asked")
        self.answer_drawn("Done.", name="Stairs")
        self.wait_for("it is listed", lambda: "Stairs" in self.text("annotations"))
        self.browser.find_element(By.XPATH, "//ul[@id='annotations']/li[contains(., 'Stairs')]//button[text()='Edit']").click()
        self.drag((-120, -40), (-150, -60), (-160, -80))
        self.click("hint-end")
        self.answer_drawn("Done.")
        self.wait_for("its corner is elsewhere", lambda: abs(self.on_screen("Stairs")[0] + 160) < 2)
        self.picture("zones")
        self.click("draw-speed")
        self.click_map((-100, -100), (100, 100), (100, -100), (-100, 100))
        self.browser.find_element(By.TAG_NAME, "body").send_keys(Keys.ENTER)
        self.wait_for("it is said that its sides cross", lambda: "Its sides cross" in self.text("dialog-text"))
        self.answer_drawn("Refused: its sides cross or touch, or it has no area.", name="Bow")

    def ask_for_a_path(self):
        """A robot asks for a way to the place: it is shown."""
        asked = subprocess.run([program("isthmus-ask"), "--lcm-url", self.server.url, "--wait", "20", "path", "R1", "--to-place",
                                "Dock 1", "--radius", "0.2", "--clearance", "0"], capture_output=True, text=True, check=False)
        if asked.returncode != 0:
            self.assertIn("refused: ", asked.stderr)
            return
        self.wait_for("it is on the page", lambda: self.js("isthmus.asked.length") == 1)
        self.assertGreater(self.js("isthmus.asked[0].points.length"), 1)
        self.picture("path")

    def look_at_the_past(self):
        """The slider leaves out what was mapped later."""
        self.wait_for("there is a past", lambda: self.js("isthmus.history.end") > 100)
        self.browser.execute_script("""
            const slider = document.getElementById("time-slider");
            slider.value = slider.max / 3;
            slider.dispatchEvent(new Event("input"));""")
        self.wait_for("a part of the map is shown", lambda: " of " in self.text("time-text"))
        self.wait_for("robots are where they were", lambda: self.js("isthmus.history.robots().length") == 2)
        self.picture("past")
        self.click("time-now")
        self.assertTrue(self.text("time-text").startswith("now"))

    def look_at(self, tenths):
        self.browser.execute_script(f"""
            const slider = document.getElementById("time-slider");
            slider.value = {tenths};
            slider.dispatchEvent(new Event("input"));""")

    def look_at_the_map_as_it_was(self):
        """At a snapshot of before they met, the islands are apart; and one is there again, once it is now."""
        self.wait_for("there are snapshots", lambda: self.js("isthmus.history.snapshots.length") > 2)
        self.look_at(self.js("isthmus.history.snapshots[0].end"))
        self.wait_for("the map is there as it was", lambda: self.js("isthmus.history.map?.snapshot === isthmus.history.snapshots[0].snapshot"))
        self.assertEqual(self.js("isthmus.view.scene.islands.length"), 2)
        self.assertEqual(self.islands(), 1, "the live map goes on")
        self.assertIn("as it was at ", self.text("time-text"))
        self.assertTrue(self.js("isthmus.history.robots().every((one) => isthmus.map.getBounds().contains(isthmus.placeOf(one)))"),
                        "all of it is in view")
        self.assertEqual(len(self.js("isthmus.history.robots()")), 2)
        self.wait_for("its tiles are painted", lambda: self.js(
            "isthmus.tiles.shown().some(({parts}) => parts?.length > 0)"))
        time.sleep(0.5)
        self.picture("as_it_was")
        self.look_at(self.js("isthmus.history.snapshots[0].end / 2"))
        self.wait_for("only a part of it is shown", lambda: self.text("time-text").count(" of ") == 1)
        self.click("time-now")
        self.wait_for("the map is as it is", lambda: self.js("isthmus.view === isthmus"))

    def fetch(self, name):
        with urllib.request.urlopen(f"http://127.0.0.1:{self.server.port}/download/{name}", timeout=LIMIT_S) as answer:
            self.assertIn(name, answer.headers["Content-Disposition"])
            return answer.read()

    def download(self):
        """Each of the islands by its id, whichever is the larger."""
        rows = self.js("""[...document.querySelectorAll("#downloads li")].map((row) =>
            [row.textContent, ...[...row.querySelectorAll("a")].map((link) => link.getAttribute("href"))])""")
        islands = self.js("isthmus.scene.islands.map(({id}) => id)")
        self.assertEqual(len(islands), 2)
        self.assertCountEqual([row[0].split(":")[0] for row in rows], [f"island {island}" for island in islands])
        for text, *links in rows:
            island = text.split(":")[0].split()[1]
            self.assertEqual(links, [f"download/island-{island}{suffix}" for suffix in (".png", ".yaml", "-plan.svg", "-plan.dxf", "-plan.geojson")])
            for suffix, begin in ((".png", b"\x89PNG"), (".yaml", f"image: island-{island}.png".encode()), ("-plan.svg", b"<"),
                                  ("-plan.geojson", b"{")):
                self.assertTrue(self.fetch(f"island-{island}{suffix}").startswith(begin), suffix)
        places = json.loads(self.fetch("places.geojson"))
        of_page = {one["name"]: one["island"] for one in self.js("isthmus.annotations")}
        self.assertEqual({one["properties"]["name"]: one["properties"]["island"] for one in places["features"]}, of_page)
        self.assertTrue(self.fetch("report.json").startswith(b"{"))

    def check_closures(self):
        """What the server would refuse is not offered, and what is told of them is told in words."""
        told, rows = self.js("""[isthmus.closures, [...document.querySelectorAll("#closures > li")].map((row) => [row.dataset.key,
            row.textContent, [...row.querySelectorAll("button.order")].map((button) => button.textContent)])]""")
        closures = {str(one["id"]): one for one in told}
        self.assertGreater(len(rows), 0)
        for key, text, buttons in rows:
            one = closures[key]
            self.assertEqual(buttons, ["Withdraw" if one["state"] == "accepted" else "Allow" if one["forbidden"] else "Forbid"], text)
            for wrong in ("1 patches", "1 relations", "1 steps", " 0 patches", "map changed", "on trialon trial"):
                self.assertNotIn(wrong, text.replace("11 ", "12 "))

    def hint(self):
        return self.text("hint-text")

    def keep_a_zone_on_one_island(self):
        """Its corners are all on the island of the first; and it has three at least."""
        middle = """(() => {
            const [x0, y0, x1, y1] = isthmus.scene.islands[%d].box, [ox, oy] = isthmus.scene.offsets.get(isthmus.scene.islands[%d].id);
            const at = isthmus.map.latLngToContainerPoint([(y0 + y1) / 2 + oy, (x0 + x1) / 2 + ox]);
            return [Math.round(at.x - isthmus.map.getSize().x / 2), Math.round(at.y - isthmus.map.getSize().y / 2)];
        })()"""
        self.click("fit")
        (x, y), other = self.js(middle % (0, 0)), self.js(middle % (1, 1))
        self.click("draw-keep_out")
        self.click_map((x, y), (x + 40, y))
        self.click("hint-end")
        self.assertEqual(self.hint(), "A zone needs three corners: this one has 2 so far.")
        self.click_map(other)
        self.picture("other_island")
        self.assertIn("all its corners are on one island", self.hint())
        self.assertEqual(self.js("isthmus.drawing.now.points.length"), 2)
        self.click_map((x + 40, y + 40))
        self.assertTrue(self.hint().startswith("Click the corners"))
        self.drag((x + 40, y + 40), other)
        self.assertIn("all its corners are on one island", self.hint())
        self.assertLess(abs(self.js("isthmus.drawing.now.points[2][0] - isthmus.drawing.now.points[1][0]")), 40 * 0.2,
                        "the corner has stayed on its island")
        self.click("hint-cancel")

    def drop_a_robot(self):
        """What goes with it is told before; it is off the map then, and said so, until it is allowed again."""
        row = "//tbody[@id='robots']/tr[contains(., 'R2')]"
        marks = "isthmus.robots.map(({name}) => name)"
        self.browser.execute_script("isthmus.order({verb: 'drop', robot: 'R9'})")
        self.wait_for("it is said that there is nothing", lambda: "R9 has contributed nothing yet." in self.text("dialog-text"))
        self.click("dialog-no")
        closures = self.js("isthmus.closures.filter(({relations, robots}) => relations > 0 && robots.includes('R2')).length")
        for button, done in (("Drop", lambda: self.js(marks) == ["R1"] and "dropped" in self.text("robots")),
                             ("Allow", lambda: self.js(marks) == ["R1", "R2"] and "dropped" not in self.text("robots"))):
            self.browser.find_element(By.XPATH, f"{row}//button[text()='{button}']").click()
            self.wait_for("it is said what changes", lambda: "patches" in self.text("dialog-text"))
            self.picture(f"robot_{button}")
            if button == "Drop" and closures > 0:
                self.assertRegex(self.text("dialog-text"), r"Relations are lost by \d+ (closure|merge)")
            self.click("dialog-yes")
            self.wait_for("the server has answered", lambda: self.text("dialog-answer"))
            self.assertEqual(self.text("dialog-answer"), "Done.")
            self.click("dialog-no")
            self.wait_for(f"it is as after {button}", done)
            self.picture(f"robot_after_{button}")

    def erase_the_zone(self):
        """Drawn on the merged map, it lies on one of the two islands."""
        self.assertIn("Stairs", self.text("annotations"))
        self.browser.find_element(By.XPATH, "//ul[@id='annotations']/li[contains(., 'Stairs')]//button[text()='Erase']").click()
        self.wait_for("it is said what comes of it", lambda: self.text("dialog-text"))
        self.click("dialog-yes")
        self.wait_for("the server has answered", lambda: self.text("dialog-answer"))
        self.click("dialog-no")
        self.wait_for("it is gone", lambda: "Stairs" not in self.text("annotations"))

    def withdraw_the_merge(self):
        self.merge("Withdraw")
        self.picture("preview")
        self.assertIn("parts into 2", self.text("dialog-text"))
        self.click("dialog-yes")
        self.wait_for("the server has answered", lambda: self.text("dialog-answer"))
        self.assertEqual(self.text("dialog-answer"), "Done.")
        self.wait_for("the islands have parted", lambda: self.islands() == 2)
        self.click("dialog-no")
        self.wait_for("it is listed so", lambda: "withdrawn" in self.text("closures"))
        self.picture("withdrawn")

    def restart(self):
        begin = 1000 * time.time()
        self.browser.execute_script("window.isTheSamePage = true")
        colours = self.js(COLOURS)
        self.server.stop()
        self.wait_for("the page says that the server is away", lambda: self.text("link") == "reconnecting")
        self.browser.execute_script("isthmus.order({verb: 'refine'})")
        self.click("dialog-yes")
        self.wait_for("it is said why nothing is sent", lambda: self.text("dialog-answer") == "Not sent: the server does not answer.")
        self.click("dialog-no")
        self.server.start()
        self.wait_for("the page is live again", lambda: self.text("link") == "live")
        self.wait_for("both islands are there", lambda: self.islands() == 2)
        self.wait_for("the withdrawal has stayed", lambda: "withdrawn" in self.text("closures"))
        self.wait_for("the place has stayed", lambda: "Dock 1" in self.text("annotations"))
        self.assertTrue(self.js("window.isTheSamePage"))
        self.wait_for("robots are where they were last", lambda: self.js("isthmus.robots.length") == 2)
        self.assertFalse(self.js("isthmus.robots.some(({heard}) => heard)"))
        self.assertGreater(self.js("Math.min(...Object.values(isthmus.trails).map((steps) => steps.length))"), 3)
        self.wait_for("it is said that they are not heard", lambda: self.text("robots").count("not heard since the server's start") == 2)
        self.assertEqual(self.js(COLOURS), colours)
        time.sleep(0.5)
        self.picture("restarted")
        self.check_console([(begin, 1000 * time.time())])

    def test_a_robot_is_put_where_it_is_on_a_finished_map(self):
        self.server.start()
        self.play().wait()
        self.server.stop()
        self.server.start("--frozen")
        self.open_page()
        self.play(faster=1)
        self.wait_for("R1 drives on the map", lambda: "scans/s" in self.text("robots") and self.js(
            "isthmus.robots.filter(({heard}) => heard).length") == 2)
        self.assertEqual(self.text("annotations") + self.text("no-annotations"), "none yet")
        orders = "[...document.querySelectorAll('button.order')]"
        self.assertGreater(self.js(f"{orders}.length"), 5)
        self.assertEqual(self.js(f"{orders}.filter((button) => button.offsetParent).map((button) => button.textContent)"), [],
                         "what a frozen map refuses is not offered")
        self.place("R1", [*self.robot_on_screen("R1"), self.js("isthmus.robots.find(({name}) => name === 'R1').at[3]")], "2")
        self.place("R1", [150, 200, 1], "0.5")  # in another room
        self.wait_for("it is said why it is not moved", lambda: "R1 stays where it was found: " in self.text("warnings"))
        self.assertTrue(self.text("warnings").startswith("R1 stays where it was found: "), "what is new is seen first")
        self.picture("not_moved")
        self.check_console()

    def test_an_exploration_is_shown_live(self):
        """Two robots explore by the server's goals: where each is sent, by which way, and what is left."""
        config = os.path.join(self.work, "explore.toml")
        with open(config, "w", encoding="utf-8") as file:
            file.write("[exploration]\nenabled = true\n")
        self.server.start("--config", config, "--status-period", "0.25")
        self.open_page()
        drive = subprocess.Popen([program("isthmus-simulate"), "--scenario", "meeting", "--live", "--lcm-url", self.server.url,
                                  "--speed", "4", "--max-time", "240"], stdout=subprocess.PIPE, text=True)
        self.addCleanup(drive.wait)
        self.addCleanup(drive.kill)
        self.wait_for("both are sent somewhere by a way", lambda: self.js(
            "isthmus.exploration?.goals.filter(({goal, way}) => goal && way.length > 1).length") == 2)
        self.assertEqual(self.js("document.getElementById('with-exploration').hidden"), False)
        self.assertGreater(self.js("isthmus.exploration.frontiers.length"), 0)
        self.wait_for("it is said in the list", lambda: "explores" in self.text("robots"))
        self.wait_for("their maps have merged", lambda: self.islands() == 1)
        self.picture("exploring")
        drive.communicate(timeout=4 * LIMIT_S)
        self.assertEqual(drive.returncode, 0)
        self.picture("explored")
        self.check_console()

    def place(self, robot, where, sigma_m):
        """Says that a robot is at x, y (pixels from the map's middle) and faces a direction."""
        x, y, yaw = where
        self.browser.find_element(By.XPATH, f"//tbody[@id='robots']/tr[contains(., '{robot}')]//button[text()='Place']").click()
        self.drag((x, y), (x + 40 * math.cos(yaw), y - 40 * math.sin(yaw)))
        self.picture("placing")
        self.answer_drawn("Done.", sigma=sigma_m)

    def test_orders_are_signed_in_the_browser_where_keys_are_configured(self):
        key = secrets.token_hex(32)
        path = os.path.join(self.work, "keys.toml")
        with open(path, "w", encoding="ascii", opener=lambda name, flags: os.open(name, flags, 0o600)) as file:
            file.write(f'[auth.operators]\nALICE = "{key}"\n')
        self.server.start("--config", path)
        self.open_page()
        for given, answer in ((secrets.token_hex(32), "Refused: the key is another than the server's."), (key, "Done.")):
            self.click("refine")
            self.browser.find_element(By.ID, "operator-name").clear()
            self.browser.find_element(By.ID, "operator-name").send_keys("alice")
            self.browser.find_element(By.ID, "operator-key").clear()
            self.browser.find_element(By.ID, "operator-key").send_keys(given)
            self.click("dialog-yes")
            self.wait_for("the server has answered", lambda: self.text("dialog-answer"))
            self.picture("signed")
            self.assertEqual(self.text("dialog-answer"), answer)
            self.click("dialog-no")
        zone = '{verb: "speed", name: "Ramp", max_speed: 0.4, points: [[0, 0, 0], [0, 2, 0], [0, 1, 1]]}'
        pose = '{verb: "initial_pose", robot: "R1", patch: 0, pose: [1, 2, 0.5], sigma_m: 1, sigma_rad: 0.5}'
        for order, reason in ((zone, "unknown_patch"), ('{verb: "erase", name: "Ramp"}', "no_such_name"), (pose, "unknown_robot")):
            self.assertEqual(self.refusal_of_signed(order, "ALICE", key), reason)
            self.assertEqual(self.refusal_of_signed(order, "ALICE", secrets.token_hex(32)), "forged")

    def test_the_page_is_entered_with_a_token_that_no_address_holds(self):
        path = os.path.join(self.work, "token")
        token = secrets.token_hex(16)
        with open(path, "w", encoding="ascii", opener=lambda name, flags: os.open(name, flags, 0o600)) as file:
            file.write(token)
        self.server.start("--http-token-file", path)
        self.browser.get(f"http://127.0.0.1:{self.server.port}/")
        self.assertNotIn("Wrong", self.browser.page_source)
        for given in (secrets.token_hex(16), token):
            self.browser.find_element(By.ID, "token").send_keys(given, Keys.ENTER)
            if given != token:
                self.wait_for("it is said", lambda: "Wrong token." in self.browser.find_element(By.TAG_NAME, "form").text)
                self.picture("wrong_token")
            self.assertNotIn(given, self.browser.current_url)
        self.wait_for("the page is live", lambda: self.js("document.getElementById('link')?.textContent") == "live")


class LargePage(InBrowser):
    """A map that is made up: as many robots and patches as the page is made for."""

    ROBOTS, PATCHES = 100, 10000

    def setUp(self):
        super().setUp()
        self.server = page_frames.serve(page_frames.Map(self.PATCHES, self.ROBOTS), WEB)
        self.addCleanup(self.server.server_close)
        self.addCleanup(self.server.shutdown)

    def painted(self, layer):
        """How many pixels of a canvas above the tiles are."""
        return self.js(f"""(() => {{
            const of = isthmus.overlay.{layer}, canvas = of.canvas ?? of.shown;
            const bytes = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
            let painted = 0;
            for (let i = 3; i < bytes.length; i += 4) painted += bytes[i] > 0 ? 1 : 0;
            return painted;
        }})()""")

    def check_labels(self, labels, least):
        """There are some, and none covers another."""
        self.assertGreaterEqual(len(labels), least)
        for i, a in enumerate(labels):
            for b in labels[:i]:
                self.assertTrue(a["left"] >= b["left"] + b["width"] or b["left"] >= a["left"] + a["width"] or
                                abs(a["baseline"] - b["baseline"]) >= 13, f"{a} {b}")

    def test_a_hundred_robots_and_ten_thousand_patches_are_drawn_and_go_on(self):
        self.browser.get(f"http://127.0.0.1:{self.server.server_address[1]}/")
        self.wait_for("the page is live", lambda: self.text("link") == "live")
        self.wait_for("all robots are there", lambda: self.js("window.isthmus?.robots.length") == self.ROBOTS)
        self.click("show-trails")
        self.click("show-closures")
        self.click("show-annotations")
        self.click("show-exploration")
        self.wait_for("nothing is drawn", lambda: self.js("isthmus.overlay.still.isWhole") and self.painted("still") == 0)
        self.click("show-patches")
        self.wait_for("the patches are there", lambda: self.js("isthmus.patches.of(0)?.x.length") == self.PATCHES)
        self.wait_for("they are drawn", lambda: self.js("isthmus.overlay.still.isWhole") and self.painted("still") > self.PATCHES)
        self.assertGreater(self.painted("moving"), 50 * self.ROBOTS)
        self.check_labels(self.js("isthmus.overlay.labels"), 30)
        self.picture("large")
        for _ in range(3):
            before = self.js("isthmus.robots.map(({at}) => at)")
            self.wait_for("robots have moved", lambda at=before: self.js("isthmus.robots.map(({at}) => at)") != at)
        self.assertEqual(self.js("document.querySelectorAll('#robots tr').length"), self.ROBOTS)
        self.check_console()

    def test_names_of_robots_that_stand_together_do_not_cover_one_another(self):
        self.browser.get(f"http://127.0.0.1:{self.server.server_address[1]}/")
        labels = self.browser.execute_async_script("""
            const [tell] = arguments;
            import("/marks.js").then(({besideEachOther}) => tell(besideEachOther(
                ["R1", "R2", "R3", "R4", "R5", "R6"].map((text, i) => ({text, x: 50 + 2 * i, y: 50})), () => 20)));""")
        self.assertEqual([one["text"] for one in labels], [f"R{i}" for i in range(1, 7)])
        self.check_labels(labels, 6)


def each_by_itself():
    """Runs every test as a process, all at the same time; the exit code."""
    tests = [f"{case.__name__}.{name}" for case in InBrowser.__subclasses__() for name in unittest.defaultTestLoader.getTestCaseNames(case)]

    def run(test):
        return subprocess.run([sys.executable, __file__, *sys.argv[1:], test], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    with concurrent.futures.ThreadPoolExecutor(len(tests)) as pool:
        results = list(pool.map(run, tests))
    for test, result in zip(tests, results):
        print(f"{test}\n{result.stdout}")
    failed = [test for test, result in zip(tests, results) if result.returncode]
    print(f"{len(tests) - len(failed)} of {len(tests)} tests passed" + (f"; failed: {', '.join(failed)}" if failed else ""))
    return 1 if failed or not tests else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=ARGUMENTS.build)
    parser.add_argument("--pictures", metavar="DIR", help="keep pictures of the screen in this directory")
    parser.add_argument("tests", nargs="*", help="only these")
    ARGUMENTS = parser.parse_args()
    if missing():
        print(f"no browser: {', '.join(missing())} missing (tools/install-dependencies.sh --browser)")
        sys.exit(0)
    if not ARGUMENTS.tests:
        sys.exit(each_by_itself())
    unittest.main(argv=sys.argv[:1] + ARGUMENTS.tests)
