"""Cancels jobs on the paper's office in every stage, and looks how soon they are gone.

    python3 tests/torture/cancel.py BUILD [--cancels N] [--seed N]

Each job is let go for a random time and then cancelled; what is measured is the time from the
request to the state "cancelled", by the stage that the job was in, and the daemon's resident memory
after each, when nothing runs. A median above 200 ms, a worst case above 1 s, or memory that grows
fails the run.

A cancel takes some two seconds, most of which its job is let go. It goes twice: with --shelf 0, when
nothing may stay in memory; then, for fewer cancels, with the shelf, whose own bytes (by /metrics) are
taken off, so that what else stays has to be as little.
"""

import argparse
import collections
import os
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

from daemon import Client, Daemon

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(TOP, "client", "python"))
import oriel  # noqa: E402  pylint: disable=wrong-import-position,wrong-import-order

MEDIAN_S, WORST_S = 0.2, 1.0
GROWTH_BYTES = 16 << 20  # between the first jobs, after which all that stays is there, and the last
FIRST = 20
LONGEST_S = 4.0  # that a job is let go
POLL_S = 0.003
VIEW = "-vtv -vp 0.35 5.6 1.5 -vd 0.25 -1 0.05 -vu 0 0 1 -vh 75.2 -vv 60"


def make_office(build, folder):
    office = os.path.join(TOP, "client", "examples", "office")
    for name in os.listdir(office):
        if name.endswith(".rad") or name == "sensors.txt":
            shutil.copy(os.path.join(office, name), folder)
    subprocess.run([os.path.join(build, "oriel"), "bsdf", "make",
                    os.path.join(office, "lcp", "lcp.json"), "-o", os.path.join(folder, "lcp.xml")],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return ["materials.rad", "room.rad", "ground.rad", "sky.rad", "glazing.rad", "panel.rad"]


def kinds(scene, number):
    """Long jobs, each with its stages. Maps that a job can have finished are used twice, so that
    the second time it comes to what it does with them, and to what lies on the shelf."""
    seed, kept = number, (number + 1) // 2
    view = [{"name": "room", "view": VIEW, "width": 1600, "height": 1200}]
    many = {"global": 20000000, "caustic": 20000000}
    common = {"scene": scene, "seed": kept, "sensors": [[1.5, 2, 0.8, 0, 0, 1]], "views": view}
    yield "photons", dict(common, seed=seed, technique="gather", photons=many)
    yield "gather", dict(common, technique="gather", photons={"global": 100000, "caustic": 100000})
    yield "direct", dict(common, technique="direct", photons={"global": 1000000, "caustic": 10000})
    yield "precomputed", dict(common, technique="precomputed",
                              photons={"global": 2000000, "caustic": 2000000})
    yield "backward", dict(common, technique="backward", pixel_samples=4096)
    yield "goal", dict(common, seed=seed, accuracy={"relative_error": 0.003})
    yield "study", {"kind": "study", "scene": scene, "seed": seed, "techniques": ["gather"],
                    "sensors": common["sensors"], "photons": [1000000], "gather_samples": [4096],
                    "repeats": 20, "reference": {"samples": 131072, "runs": 16}}


def memory(pid):
    with open("/proc/%d/status" % pid, encoding="ascii") as stream:
        for line in stream:
            if line.startswith("RssAnon:"):
                return int(line.split()[1]) << 10
    return 0


def shelf_bytes(port):
    client = Client(port, "cancel")
    text = client.request("GET", "/metrics").body.decode()
    client.close()
    return int(float(re.search(r"^oriel_shelf_bytes (\S+)$", text, re.MULTILINE).group(1)))


class Cancels:
    def __init__(self, daemon):
        self.client = oriel.Client("http://127.0.0.1:%d" % daemon.port)
        self.daemon = daemon
        self.seconds = collections.defaultdict(list)  # by stage
        self.memory = []                              # after each, without the shelf's
        self.most_shelf = 0

    def one(self, document, let_go_s):
        job = self.client.submit(document)
        time.sleep(let_go_s)
        stage = job.status().get("stage") or document.get("kind")
        asked = time.monotonic()
        try:
            job.cancel()
            while job.status()["state"] not in ("cancelled", "succeeded"):
                time.sleep(POLL_S)
        except oriel.Problem:
            pass  # it had succeeded
        took = time.monotonic() - asked
        if job.status()["state"] == "cancelled":
            self.seconds[stage].append(took)
        shelf = shelf_bytes(self.daemon.port)
        self.most_shelf = max(self.most_shelf, shelf)
        self.memory.append(memory(self.daemon.process.pid) - shelf)
        return stage, took


def report(shelf, cancels):
    everything = sorted(took for stage in cancels.seconds.values() for took in stage)
    for stage, seconds in sorted(cancels.seconds.items()):
        print("  %-12s %4d cancels: median %4.0f ms, worst %4.0f ms" % (
            stage, len(seconds), 1e3 * statistics.median(seconds), 1e3 * max(seconds)))
    median, worst = statistics.median(everything), everything[-1]
    growth = max(cancels.memory[-FIRST:]) - max(cancels.memory[:FIRST])
    good = median < MEDIAN_S and worst < WORST_S and growth < GROWTH_BYTES
    print("cancel --shelf %s: %d cancels: median %.0f ms (< %.0f), worst %.0f ms (< %.0f); memory "
          "without the shelf's (up to %.0f MiB) %.0f MiB after %d, %.0f MiB after all (< %.0f more): "
          "%s" % (shelf, len(everything), 1e3 * median, 1e3 * MEDIAN_S, 1e3 * worst, 1e3 * WORST_S,
                  cancels.most_shelf / 2**20, max(cancels.memory[:FIRST]) / 2**20, FIRST,
                  max(cancels.memory[-FIRST:]) / 2**20, GROWTH_BYTES / 2**20,
                  "met" if good else "FAILED"), flush=True)
    return good


def run(arguments, shelf, count):
    """One daemon's, with a shelf of that size."""
    chance = random.Random(arguments.seed)
    folder = tempfile.mkdtemp(prefix="oriel-cancel-")
    os.mkdir(os.path.join(folder, "data"))
    daemon = Daemon(arguments.build, os.path.join(folder, "data"),
                    ["--threads", "2", "--shelf", shelf])
    try:
        daemon.wait_listening()
        cancels = Cancels(daemon)
        scene = cancels.client.upload_scene(make_office(arguments.build, folder), folder=folder)
        seed = 0
        while len(cancels.memory) < count:
            seed += 1
            for name, document in kinds(scene, seed):
                told = cancels.one(document, LONGEST_S * chance.random() ** 2)
                if arguments.verbose:
                    print(name, *told, cancels.memory[-1] >> 20, flush=True)
            print("cancel --shelf %s: %d of %d cancels" % (shelf, len(cancels.memory), count),
                  flush=True)
        good = report(shelf, cancels)
        daemon.stop()
    finally:
        if daemon.process.returncode is None:
            daemon.kill()
            daemon.wait()
        shutil.rmtree(folder)
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("build")
    parser.add_argument("--cancels", type=int, default=105)
    parser.add_argument("--shelved", type=int, default=42, help="cancels with the shelf")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--verbose", action="store_true")
    arguments = parser.parse_args()
    good = [run(arguments, shelf, count)
            for shelf, count in (("0", arguments.cancels), ("256M", arguments.shelved))]
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main())
