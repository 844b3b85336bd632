"""`make load`: how the daemon bears many clients. A table: measured, wanted, met.

Usage: python3 tests/bench/load.py BUILD. wrk (Debian's package) polls; hello is the least that
libmicrohttpd can do, measured in turns with the daemon. ORIEL_LOAD_SECONDS (3): of one measurement.
Status 1 when something is not met.
"""

import os
import re
import resource
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../contract"))
from cases import NEVER, ROOM, SKY, sensors_of
from daemons import Daemon

SECONDS = int(os.environ.get("ORIEL_LOAD_SECONDS", "3"))
ROUNDS = 5
POLLERS = 8      # connections that ask again as soon as they are answered: the most there can be
PACED = 32       # ... that wait for PACE_MS first: a load that leaves the daemon time to sleep
PACE_MS = 2
STREAMS = 1000
SLOW = 200
REQUESTS = 100000


class Any:
    """In place of the contract: here nobody judges answers."""

    def judge(self, method, path, answer):
        pass

    def judge_request(self, document):
        return []


class Table:
    def __init__(self):
        self.missed = 0

    def row(self, what, measured, wanted, met):
        self.missed += not met
        print("  %-52s %22s   %-22s %s" % (what, measured, wanted, "yes" if met else "NO"),
              flush=True)

    def note(self, what, measured):
        print("  %-52s %22s" % (what, measured), flush=True)


def wrk(port, path, connections=POLLERS, seconds=SECONDS, script=None):
    """(requests a second, p99 in ms, requests, answers that were not good)"""
    command = ["wrk", "-t1", "-c%d" % connections, "-d%ds" % seconds, "--latency"]
    command += ["-s", script] if script else []
    text = subprocess.check_output(command + ["http://127.0.0.1:%d%s" % (port, path)], text=True)
    number, unit = re.search(r"99% +([\d.]+)(us|ms|s)", text).groups()
    bad = re.search(r"Non-2xx or 3xx responses: (\d+)", text)
    broken = re.search(r"Socket errors: (.*)", text)
    assert not broken, text
    return (float(re.search(r"Requests/sec: +([\d.]+)", text).group(1)),
            float(number) * {"us": 0.001, "ms": 1, "s": 1000}[unit],
            int(re.search(r"(\d+) requests in", text).group(1)), int(bad.group(1)) if bad else 0)


def best(runs):
    """The round that was answered soonest: other work on the machine only adds to it."""
    return min(runs, key=lambda run: run[1])[:2]


def paced(port, path):
    with tempfile.NamedTemporaryFile("w", suffix=".lua") as script:
        script.write("function delay() return %d end" % PACE_MS)
        script.flush()
        return wrk(port, path, PACED, script=script.name)


def process_value(daemon, name):
    """Of /proc/PID/status, in bytes; of its stat, the processor time in seconds."""
    if name == "cpu":
        with open("/proc/%d/stat" % daemon.process.pid) as stream:
            fields = stream.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    with open("/proc/%d/status" % daemon.process.pid) as stream:
        return 1024 * int(re.search(name + r":\s+(\d+)", stream.read()).group(1))


class Office:
    """A daemon with a scene, a job that has ended and, between busy and quiet, one that runs."""

    def __init__(self):
        self.daemon = Daemon(Any())
        self.port = self.daemon.port
        self.scene = self.daemon.upload(ROOM + SKY)
        self.ended = self.daemon.submit(sensors_of(self.scene))
        self.daemon.wait(self.ended)
        self.running = None

    def busy(self):
        """Anew where one runs: on fast machines the most photons there can be take half a minute."""
        if self.running:
            self.quiet()
        self.running = self.daemon.submit(sensors_of(self.scene, photons={"global": NEVER}))
        self.daemon.wait(self.running, ("running",), lambda job: job["stage"] == "photons")

    def quiet(self):
        self.daemon.ask("POST", self.running + "/cancel", want=202)
        self.daemon.wait(self.running)
        self.running = None


# ---- Polls ---------------------------------------------------------------------------------------

def idle_polls(table, office, build):
    hello = subprocess.Popen([os.path.join(build, "tests/bench/hello")], stdin=subprocess.PIPE,
                             stdout=subprocess.PIPE, text=True)
    port = int(hello.stdout.readline())
    polls, hellos, ratios = [], [], []
    for _ in range(ROUNDS):  # in turns, since other work on the machine comes and goes
        hellos.append(wrk(port, "/")[0])
        polls.append(wrk(office.port, office.ended)[0])
        ratios.append(polls[-1] / hellos[-1])
    hello.stdin.close()
    hello.wait()
    hello.stdout.close()
    table.note("hello world on libmicrohttpd, idle", "%.0f /s" % statistics.median(hellos))
    table.note("status polls, idle", "%.0f /s" % statistics.median(polls))
    table.row("polls by hello world, idle (median of %d)" % ROUNDS,
              "%.2f" % statistics.median(ratios), ">= 0.50", statistics.median(ratios) >= 0.5)


def busy_polls(table, office):
    for what, ended in (("of the job that runs", None), ("of one that ended", office.ended)):
        office.busy()
        path = ended or office.running
        rate, late = best([paced(office.port, path) for _ in range(ROUNDS)])
        table.row("status polls %s, all cores rendering" % what, "%.0f /s" % rate, ">= 5000 /s",
                  rate >= 5000)
        table.row("  99 % of them answered within", "%.1f ms" % late, "< 20 ms", late < 20)
        table.note("  as many as it can", "%.0f /s" % wrk(office.port, path)[0])
        assert office.daemon.ask("GET", office.running).json["state"] == "running"


# ---- Streams -------------------------------------------------------------------------------------

def open_stream(office, path):
    stream = socket.create_connection(("127.0.0.1", office.port), timeout=60)
    stream.sendall(("GET %s/events HTTP/1.1\r\nHost: localhost\r\n\r\n" % path).encode())
    return stream


def streams(table, office):
    """All at once on the job that runs: the first event, polls beside them, the last event."""
    office.busy()
    began = time.monotonic()
    opened = [open_stream(office, office.running) for _ in range(STREAMS)]
    good = sum(stream.recv(12) == b"HTTP/1.1 200" for stream in opened)
    table.row("event streams open", "%d in %.1f s" % (good, time.monotonic() - began),
              ">= %d" % STREAMS, good >= STREAMS)
    rate, late = best([paced(office.port, office.running) for _ in range(ROUNDS)])
    table.row("  99 % of polls beside them answered within", "%.1f ms" % late, "< 20 ms", late < 20)
    table.note("  polls beside them", "%.0f /s" % rate)
    began = time.monotonic()
    office.daemon.ask("POST", office.running + "/cancel", want=202)
    whole = 0
    for stream in opened:
        text = b""
        for part in iter(lambda: stream.recv(1 << 16), b""):
            text += part
            if text.endswith(b"0\r\n\r\n"):
                break
        whole += b'"cancelled"' in text
        stream.close()
    seconds = time.monotonic() - began
    office.daemon.wait(office.running)
    office.running = None
    table.row("  streams that told the end, and then ended", "%d in %.1f s" % (whole, seconds),
              "all", whole == STREAMS)


# ---- Slow clients --------------------------------------------------------------------------------

class Slow(threading.Thread):
    """Clients that send a byte now and then, of headers or of a body, or never read an answer."""

    def __init__(self, office):
        super().__init__(daemon=True)
        self.over = threading.Event()
        self.streams = []
        for i in range(SLOW):
            stream = socket.create_connection(("127.0.0.1", office.port), timeout=60)
            stream.setblocking(False)
            stream.send((b"GET /v1/jobs HTTP/1.1\r\nHost: loc",
                         b"POST /v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/"
                         b"json\r\nContent-Length: 100000\r\n\r\n{",
                         b"GET /openapi.yaml HTTP/1.1\r\nHost: localhost\r\n\r\n" * 20)[i % 3])
            self.streams.append(stream)

    def run(self):
        while not self.over.wait(0.5):
            for i, stream in enumerate(self.streams):
                try:
                    if i % 3 < 2:
                        stream.send(b" ")
                except OSError:
                    pass  # cut off already

    def end(self):
        self.over.set()
        self.join()
        for stream in self.streams:
            stream.close()


def slow_clients(table, office):
    office.busy()
    alone, beside = [], []
    for _ in range(ROUNDS):  # in turns
        alone.append(paced(office.port, office.running))
        slow = Slow(office)
        slow.start()
        beside.append(paced(office.port, office.running))
        slow.end()
    (rate, late), (_, before) = best(beside), best(alone)
    table.row("polls beside %d slow clients, all cores rendering" % SLOW, "%.0f /s" % rate,
              ">= 5000 /s", rate >= 5000)
    table.row("  99 % of them answered within", "%.1f ms" % late, "< 20 ms, or as without",
              late < max(20, 1.2 * before))
    table.note("  99 % without the slow clients, in turns with them", "%.1f ms" % before)
    office.quiet()


# ---- Memory --------------------------------------------------------------------------------------

MIX = """
local paths = {%s}
local at = 0
request = function()
  at = at %% #paths + 1
  local one = paths[at]
  return wrk.format(one[1], one[2], one[3], one[4])
end
"""


def mixed(office):
    """A script for wrk: good and bad requests of every kind that makes no job."""
    id = office.ended
    asks = [("GET", id), ("GET", id + "/result"), ("GET", id + "/events"), ("GET", "/nowhere"),
            ("GET", "/v1/jobs?limit=5"), ("GET", "/v1/jobs?limit=x"), ("GET", "/metrics"),
            ("GET", "/v1/scenes/" + office.scene), ("GET", "/v1/maps"), ("PUT", "/v1/jobs"),
            ("GET", "/openapi.yaml"), ("GET", "/v1/limits"), ("GET", id + "/files/x")]
    lines = ['{"%s", "%s"}' % ask for ask in asks]
    json = '{["Content-Type"] = "application/json"}'
    for body in ("{", '{"scene": 1}', '{\\"scene\\": \\"%s\\", \\"sensors\\": []}' % ("0" * 64)):
        lines.append('{"POST", "/v1/jobs", %s, "%s"}' % (json, body.replace('"', '\\"')
                                                        .replace('\\\\"', '\\"')))
    lines.append('{"POST", "/v1/scenes", %s, [[{"files": [{"name": "0.rad", "text": "%s"}]}]]}'
                 % (json, (ROOM + SKY).replace("\n", "\\n")))
    return MIX % ", ".join(lines)


def memory(table, office):
    with tempfile.NamedTemporaryFile("w", suffix=".lua") as script:
        script.write(mixed(office))
        script.flush()
        warm = wrk(office.port, "/", script=script.name, seconds=5)[2]
        before = process_value(office.daemon, "VmRSS")
        count = 0
        while count < REQUESTS:
            count += wrk(office.port, "/", script=script.name, seconds=5)[2]
    grown = process_value(office.daemon, "VmRSS") - before
    table.row("memory over %d requests, after %d" % (count, warm),
              "%+.2f of %.0f MiB" % (grown / 2**20, before / 2**20), "< 1 MiB more",
              grown < 2**20)


def main():
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, max(soft, 8192)), hard))
    os.environ["ORIEL_BUILD"] = sys.argv[1]
    table, office = Table(), Office()
    print("  %-52s %22s   %-22s met" % ("%d processors, %d other programs at work" %
                                        (os.cpu_count(), os.getloadavg()[0] + 0.5),
                                        "measured", "wanted"))
    idle_polls(table, office, sys.argv[1])
    busy_polls(table, office)
    streams(table, office)
    slow_clients(table, office)
    memory(table, office)
    office.daemon.end()
    print("  %s" % ("all met" if not table.missed else "%d not met" % table.missed))
    return 1 if table.missed else 0


if __name__ == "__main__":
    sys.exit(main())
