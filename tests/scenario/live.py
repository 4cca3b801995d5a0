"""A live server for tests in processes of their own, on an LCM network that no other test is on."""
import glob
import os
import signal
import socket
import subprocess
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
LIMIT_S = 60


def check(condition, what):
    if not condition:
        raise SystemExit("not so: " + what)


def free_port(kind=socket.SOCK_STREAM):
    """A port of TCP, or of UDP (SOCK_DGRAM), that nobody has. Tests run side by side, and each binds LCM's multicast
    so that others may bind it too: with one port for two tests, each would hear the other's robots."""
    with socket.socket(socket.AF_INET, kind) as one:
        one.bind(("", 0))
        return one.getsockname()[1]


def free_lcm_port():
    return free_port(socket.SOCK_DGRAM)


def lcm_url(port):
    return f"udpm://239.255.76.67:{port}?ttl=0"


def generate_types(directory):
    """The Python classes of lcmtypes, to be imported from `directory` as `isthmus`."""
    subprocess.run(["lcm-gen", "-p", "--ppath", directory, *glob.glob(os.path.join(ROOT, "lcmtypes", "*.lcm"))],
                   check=True)


class Server:
    """isthmus-server on the LCM network `url`; its words go to server.log in `work`."""

    def __init__(self, build, url, work):
        self.program, self.url = os.path.join(build, "bin", "isthmus-server"), url
        self.log = os.path.join(work, "server.log")
        self.process = None

    def start(self, *options):
        """Until it listens."""
        before = self.words().count("msg=listening")
        with open(self.log, "a", encoding="utf-8") as log:
            self.process = subprocess.Popen([self.program, "--lcm-url", self.url, *options], stderr=log)
        end = time.monotonic() + LIMIT_S
        while self.words().count("msg=listening") == before:
            if self.process.poll() is not None or time.monotonic() > end:
                raise SystemExit("the server does not listen:\n" + self.words())
            time.sleep(0.05)

    def words(self):
        if not os.path.exists(self.log):
            return ""
        with open(self.log, encoding="utf-8") as log:
            return log.read()

    def stop(self):
        if self.process is None:
            return
        self.process.send_signal(signal.SIGINT)
        code = self.process.wait(timeout=LIMIT_S)
        self.process = None
        check(code == 0, f"the server ended well, not with {code}:\n" + self.words())

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()
