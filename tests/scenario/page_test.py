#!/usr/bin/env python3
"""The page in a browser: Chromium, without a screen, watches a server to which a simulated team is played.

    tests/scenario/page_test.py --build .build/dev [--pictures DIR] [--port 7698]

Exit code 0 where all holds, 1 with what does not; 0 and "no browser" where Chromium, its driver or Selenium are
missing (tools/install-dependencies.sh --browser).
"""

import argparse
import os
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
except ImportError:
    webdriver = None

LIMIT_S = 60
PLAYED_FASTER = 6
ARGUMENTS = argparse.Namespace(build=".build/dev", pictures=None, port=7698)

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


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def program(name):
    return os.path.join(ARGUMENTS.build, "bin", name)


class Server:
    """isthmus-server with a page, on a journal; started and stopped."""

    def __init__(self, work):
        self.work = work
        self.port = free_port()
        self.url = f"udpm://239.255.76.67:{ARGUMENTS.port}?ttl=0"
        self.process = None

    def start(self, *options):
        with open(os.path.join(self.work, "server.log"), "ab") as log:
            self.process = subprocess.Popen(
                [program("isthmus-server"), "--lcm-url", self.url, "--journal", os.path.join(self.work, "journal"),
                 "--http-port", str(self.port), *options], stderr=log)
        end = time.monotonic() + LIMIT_S
        while time.monotonic() < end:
            with socket.socket() as one:
                if one.connect_ex(("127.0.0.1", self.port)) == 0:
                    return
            time.sleep(0.05)
        raise RuntimeError(f"no page: see {self.work}/server.log")

    def stop(self):
        if self.process is None:
            return
        self.process.send_signal(signal.SIGINT)
        code = self.process.wait(timeout=LIMIT_S)
        self.process = None
        if code != 0:
            raise RuntimeError(f"the server ended with {code}")


def open_browser():
    options = webdriver.ChromeOptions()
    for one in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--window-size=1400,960"):
        options.add_argument(one)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    options.binary_location = shutil.which("chromium")
    return webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)


class Page(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.work = scratch.name
        self.server = Server(self.work)
        self.addCleanup(self.server.stop)
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

    def islands(self):
        return self.js("window.isthmus?.scene.islands.length ?? 0")

    def open_page(self):
        self.browser.get(f"http://127.0.0.1:{self.server.port}/")
        self.wait_for("the page is live", lambda: self.text("link") == "live")

    def play(self):
        """The team's drive, faster than it was; waits for its end."""
        log = os.path.join(self.work, "run.lcm")
        subprocess.run([program("isthmus-simulate"), "--scenario", "meeting", "--seed", "1", "-o", log], check=True,
                       stdout=subprocess.DEVNULL)
        player = subprocess.Popen(["lcm-logplayer", f"--lcm-url={self.server.url}", "--speed", str(PLAYED_FASTER), log],
                                  stdout=subprocess.DEVNULL)
        self.addCleanup(player.wait)
        self.addCleanup(player.kill)
        return player

    def merge(self, button):
        """Clicks a button of the first merge in the list that has it; waits for what it would change."""
        merges = "//ul[@id='closures']/li[contains(., 'merge')]"
        self.browser.find_element(By.XPATH, f"{merges}//button[text()='{button}']").click()
        self.wait_for("what would change is shown", lambda: self.text("dialog-text"))

    def check_console(self, away=()):
        """Nothing but that the server was away, in the spans of time when it was (milliseconds)."""
        for entry in self.browser.get_log("browser"):
            was_away = any(begin <= entry["timestamp"] <= end for begin, end in away)
            if not (was_away and entry["source"] == "network"):
                self.fail(f"in the console: {entry}")

    def test_islands_merge_and_part_on_the_screen_and_the_page_outlives_a_restart(self):
        self.server.start()
        self.open_page()
        player = self.play()
        self.wait_for("two islands are on the screen", lambda: self.islands() == 2)
        self.browser.execute_script(WATCH_PAINT)
        self.wait_for("robots are named", lambda: self.text("robots").count("scans/s") == 2)
        self.wait_for("they have merged", lambda: self.islands() == 1)
        self.picture("merged")
        player.wait()
        self.check_no_flicker()
        self.follow_a_robot()
        self.withdraw_the_merge()
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
        self.server.stop()
        self.wait_for("the page says that the server is away", lambda: self.text("link") == "reconnecting")
        self.server.start()
        self.wait_for("the page is live again", lambda: self.text("link") == "live")
        self.wait_for("both islands are there", lambda: self.islands() == 2)
        self.wait_for("the withdrawal has stayed", lambda: "withdrawn" in self.text("closures"))
        self.assertTrue(self.js("window.isTheSamePage"))
        self.picture("restarted")
        self.check_console([(begin, 1000 * time.time())])

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


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=ARGUMENTS.build)
    parser.add_argument("--pictures", metavar="DIR", help="keep pictures of the screen in this directory")
    parser.add_argument("--port", type=int, default=ARGUMENTS.port, help="of LCM's multicast")
    ARGUMENTS = parser.parse_args()
    if missing():
        print(f"no browser: {', '.join(missing())} missing (tools/install-dependencies.sh --browser)")
        sys.exit(0)
    unittest.main(argv=sys.argv[:1])
