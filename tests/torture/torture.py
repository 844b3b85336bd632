"""Kills a busy daemon, again and again, and looks whether it kept everything it had answered for.

    python3 tests/torture/torture.py BUILD [--kills N] [--seed N] [--keep]

Each round starts orield on the same data folder, checks what it found there (ledger.py), lets some
clients loose (load.py), and ends it by SIGKILL after a random moment, which may lie before it
listens. At the end it is left to work until nothing waits, every result is fetched and compared,
and the folder must hold exactly what the database speaks of.
"""

import argparse
import collections
import os
import random
import shutil
import sys
import tempfile
import time

from daemon import Daemon, Failure, Gone
from ledger import ENDED, Ledger, list_files
from load import Loader, fetch_results

CLIENTS = 4
LOAD_S = (0.005, 1.5)      # how long a daemon lives, log-uniformly
STARTING_S = (0.001, 0.03)  # ... of those killed while they start
STARTING = 0.1             # share of these
LAST_JOBS_S = 240
BUDGET = "16M"


def log_uniform(chance, bounds):
    return bounds[0] * (bounds[1] / bounds[0]) ** chance.random()


class Torture:
    def __init__(self, build, root, seed):
        self.build, self.root, self.seed = build, root, seed
        self.ledger = Ledger()
        self.counts = collections.Counter()
        self.slowest_start_s = 0.0
        top = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
        with open(os.path.join(top, "fixtures", "bsdf_klems41.xml"), encoding="utf-8") as stream:
            self.fixture = stream.read()

    def start(self):
        return Daemon(self.build, self.root, ["--threads", "2", "--jobs", "2", "--storage-budget",
                                              BUDGET])

    def round(self, number):
        chance = random.Random("%d/%d" % (self.seed, number))
        before = list_files(self.root)
        daemon = self.start()
        try:
            if chance.random() < STARTING:
                time.sleep(log_uniform(chance, STARTING_S))
                self.counts["kills while starting"] += 1
            else:
                self._load(daemon, chance, before)
        finally:
            daemon.kill()
            daemon.wait()
        self.counts["kills"] += 1

    def _load(self, daemon, chance, before):
        started = time.monotonic()
        if not daemon.wait_listening():
            raise Failure("the daemon does not start again; see %s.log" % self.root)
        self.slowest_start_s = max(self.slowest_start_s, time.monotonic() - started)
        self.ledger.check(self.root, before)
        loaders = [Loader(daemon, self.ledger, random.Random(chance.getrandbits(64)), self.fixture)
                   for _ in range(CLIENTS)]
        for loader in loaders:
            loader.start()
        time.sleep(log_uniform(chance, LOAD_S))
        daemon.kill()
        for loader in loaders:
            loader.stopping.set()
            loader.join()
            if loader.failure:
                raise loader.failure

    def finish(self):
        """The last daemon may finish its work."""
        daemon = self.start()
        try:
            if not daemon.wait_listening():
                raise Failure("the daemon does not start again; see %s.log" % self.root)
            client = daemon.client()
            self._wait_for_jobs(client)
            for job_id, job in self.ledger.jobs.items():
                if job.state == "succeeded" and not job.removed:
                    fetch_results(client, self.ledger, job_id)
            client.close()
            daemon.stop()
        finally:
            if daemon.process.returncode is None:
                daemon.kill()
                daemon.wait()
        self.ledger.check_at_rest(self.root)

    def _wait_for_jobs(self, client):
        until = time.monotonic() + LAST_JOBS_S
        for job_id, job in self.ledger.jobs.items():
            while True:
                answer = client.request("GET", "/v1/jobs/" + job_id)
                if answer.status == 404 and job.asked_to_remove:
                    break
                status = answer.json()
                if status["state"] in ENDED:
                    self.ledger.see_state(job_id, status["state"], status.get("error"))
                    break
                if time.monotonic() > until:
                    raise Failure("job %s is still %s" % (job_id, status["state"]))
                time.sleep(0.05)

    def summary(self, seconds):
        ends = collections.Counter(job.state for job in self.ledger.jobs.values())
        counts = self.ledger.counts
        return ("torture: %d kills (%d while starting) in %.0f s: %d scenes, %d BSDFs, %d jobs "
                "(%s), %d removed, %d results fetched, %d evicted, %d images compared; slowest "
                "start %.2f s; nothing lost, no orphan" % (
                    self.counts["kills"], self.counts["kills while starting"], seconds,
                    len(self.ledger.scenes), len(self.ledger.bsdfs), len(self.ledger.jobs),
                    ", ".join("%d %s" % (ends[state], state) for state in ENDED),
                    sum(job.removed for job in self.ledger.jobs.values()),
                    counts["results fetched"], counts["results gone"], counts["images compared"],
                    self.slowest_start_s))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("build")
    parser.add_argument("--kills", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", action="store_true", help="the data folder stays")
    arguments = parser.parse_args()
    folder = tempfile.mkdtemp(prefix="oriel-torture-")
    root = os.path.join(folder, "data")
    os.mkdir(root)
    torture = Torture(arguments.build, root, arguments.seed)
    started = time.monotonic()
    number = 0
    try:
        for number in range(arguments.kills):
            torture.round(number)
        torture.finish()
    except (Failure, Gone) as failure:
        print("torture: FAILED after %d kills (seed %d): %s\n  the data folder is %s" %
              (number, arguments.seed, failure, root))
        return 1
    print(torture.summary(time.monotonic() - started))
    if not arguments.keep:
        shutil.rmtree(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
