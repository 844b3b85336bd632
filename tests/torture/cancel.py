"""Cancels jobs on the paper's office in every stage, and looks how soon they are gone.

    python3 tests/torture/cancel.py BUILD [--cancels N] [--seed N]

Each job is let go for a random time and then cancelled; what is measured is the time from the
request to the state "cancelled", by the stage that the job was in, and the daemon's resident memory
before and after, when nothing runs. A median above 200 ms, a worst case above 1 s, or memory that
grows fails the run.
"""

import argparse
import collections
import os
import random
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

from daemon import Daemon

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(TOP, "client", "python"))
import oriel  # noqa: E402  pylint: disable=wrong-import-position,wrong-import-order

MEDIAN_S, WORST_S = 0.2, 1.0
# Between the first jobs and the last: what the shelf holds of the few maps that are used again
# (kinds), and nothing besides. Without it there is none.
GROWTH_BYTES = 40 << 20
FIRST = 20
LONGEST_S = 4.0  # that a job is let go
POLL_S = 0.003
VIEW = "-vtv -vp 0.35 5.6 1.5 -vd 0.25 -1 0.05 -vu 0 0 1 -vh 75.2 -vv 60"


def make_office(build, folder):
    office = os.path.join(TOP, "client", "examples", "office")
    for name in os.listdir(office):
        if name.endswith(".rad") or name == "sensors.txt":
            shutil.copy(os.path.join(office, name), folder)
    subprocess.run([os.path.join(build, "oriel-lcp"), "--resolution", "6", "--seed", "1", "-o",
                    os.path.join(folder, "lcp.xml")], check=True, stdout=subprocess.DEVNULL)
    return ["materials.rad", "room.rad", "ground.rad", "sky.rad", "glazing.rad", "panel.rad"]


def kinds(scene, number):
    """Long jobs, each with its stages. Those that come to use their maps leave what they found for
    later jobs, on a shelf that is bounded, but larger than what is looked for here: so these are
    the same two again and again."""
    seed, kept = number, min(number, 2)
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


class Cancels:
    def __init__(self, client, pid):
        self.client, self.pid = client, pid
        self.seconds = collections.defaultdict(list)  # by stage
        self.memory = []                              # after each

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
        self.memory.append(memory(self.pid))
        return stage, took


def report(cancels):
    everything = sorted(took for stage in cancels.seconds.values() for took in stage)
    for stage, seconds in sorted(cancels.seconds.items()):
        print("  %-12s %4d cancels: median %4.0f ms, worst %4.0f ms" % (
            stage, len(seconds), 1e3 * statistics.median(seconds), 1e3 * max(seconds)))
    median, worst = statistics.median(everything), everything[-1]
    growth = max(cancels.memory[-FIRST:]) - max(cancels.memory[:FIRST])
    good = median < MEDIAN_S and worst < WORST_S and growth < GROWTH_BYTES
    print("cancel: %d cancels: median %.0f ms (< %.0f), worst %.0f ms (< %.0f); memory %.0f MiB "
          "after %d, %.0f MiB after all: %s" % (
              len(everything), 1e3 * median, 1e3 * MEDIAN_S, 1e3 * worst, 1e3 * WORST_S,
              max(cancels.memory[:FIRST]) / 2**20, FIRST, max(cancels.memory[-FIRST:]) / 2**20,
              "met" if good else "FAILED"))
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("build")
    parser.add_argument("--cancels", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--verbose", action="store_true")
    arguments = parser.parse_args()
    chance = random.Random(arguments.seed)
    folder = tempfile.mkdtemp(prefix="oriel-cancel-")
    os.mkdir(os.path.join(folder, "data"))
    daemon = Daemon(arguments.build, os.path.join(folder, "data"), ["--threads", "2"])
    try:
        daemon.wait_listening()
        client = oriel.Client("http://127.0.0.1:%d" % daemon.port)
        scene = client.upload_scene(make_office(arguments.build, folder), folder=folder)
        cancels = Cancels(client, daemon.process.pid)
        seed = 0
        while len(cancels.memory) < arguments.cancels:
            seed += 1
            for name, document in kinds(scene, seed):
                told = cancels.one(document, LONGEST_S * chance.random() ** 2)
                if arguments.verbose:
                    print(name, *told, cancels.memory[-1] >> 20, flush=True)
        good = report(cancels)
        daemon.stop()
    finally:
        if daemon.process.returncode is None:
            daemon.kill()
            daemon.wait()
        shutil.rmtree(folder)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
