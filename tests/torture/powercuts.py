"""Power cuts: a daemon's writes are recorded, and it is started on what each of many cuts leaves.

    python3 tests/torture/powercuts.py BUILD [--cuts N] [--seed N]

One daemon does all that writes to its folder: uploads of both kinds, jobs of several kinds, one
cancelled, removals, results that go for the budget. recorder.c, loaded into it, writes down every
name made or gone, every sync with the bytes that it made safe, and the database's writes. A cut is
a place in that recording: what was not synced by then is gone, or some of it (playback.py). A
daemon is started on the rest. Whatever was answered for before the cut must be there: rows, bytes
by their digests, results as they were fetched, removals; and nothing else may lie around.
"""

import argparse
import hashlib
import os
import random
import shutil
import sqlite3
import sys
import tempfile
import time

from daemon import Client, Daemon, Failure
from faults import SENSORS, VIEW
from ledger import ENDED, Ledger
from load import FIRST_SCENE, upload_scene
from playback import Disk, read_acts


class Session:
    """Asks for things one by one, and notes at which place of the recording each was answered."""

    def __init__(self, build, folder):
        self.root = os.path.join(folder, "data")
        self.recording = os.path.join(folder, "recording")
        self.answered = []  # (place, what to tell the ledger)
        os.mkdir(self.root)
        shim = os.path.join(build, "tests", "recorder.so")
        self.daemon = Daemon(build, self.root, ["--threads", "2", "--storage-budget", "400K"],
                             {"LD_PRELOAD": shim, "RECORDER": self.recording,
                              "RECORDER_ROOT": self.root})
        if not self.daemon.wait_listening():
            raise Failure("the daemon does not start: see %s.log" % self.root)
        self.client = Client(self.daemon.port, "cuts")

    def note(self, tell):
        self.answered.append((os.path.getsize(self.recording), tell))

    def upload(self, text):
        answer = upload_scene(self.client, text)
        if answer.status not in (200, 201):
            raise Failure("an upload: " + answer.problem())
        scene = answer.json()["id"]
        self.note(lambda ledger: ledger.scenes.__setitem__(scene, False))
        return scene

    def upload_bsdf(self, text):
        answer = self.client.request("POST", "/v1/bsdfs", text, {"Content-Type": "application/xml"})
        if answer.status not in (200, 201):
            raise Failure("a BSDF: " + answer.problem())
        bsdf = answer.json()["id"]
        self.note(lambda ledger: ledger.bsdfs.__setitem__(bsdf, False))
        return bsdf

    def submit(self, scene, seed, **members):
        document = dict({"kind": "render", "scene": scene, "seed": seed, "technique": "gather",
                         "photons": {"global": 3000, "caustic": 1000}, "gather_samples": 32,
                         "sensors": SENSORS, "views": [{"name": "view", "view": VIEW, "width": 24,
                                                        "height": 16}]}, **members)
        answer = self.client.post_json("/v1/jobs", document)
        if answer.status != 202:
            raise Failure("a job: " + answer.problem())
        job = answer.json()["id"]
        self.note(lambda ledger: ledger.add_job(job, "%s/%d" % (scene, seed)))
        return job

    def await_end(self, job):
        while True:
            status = self.client.request("GET", "/v1/jobs/" + job).json()
            if status["state"] in ENDED:
                state = status["state"]
                self.note(lambda ledger: ledger.see_state(job, state, {"detail": ""}))
                return status
            time.sleep(0.01)

    def fetch(self, job):
        status = self.await_end(job)
        for entry in status["files"]:
            answer = self.client.request("GET", "/v1/jobs/%s/files/%s" % (job, entry["name"]))
            if answer.status == 200:
                name, body = entry["name"], answer.body
                self.note(lambda ledger, name=name, body=body: ledger.see_file(job, name, body))

    def cancel(self, job):
        self.note(lambda ledger: setattr(ledger.jobs[job], "asked_to_cancel", True))
        self.client.request("POST", "/v1/jobs/%s/cancel" % job, b"{}",
                            {"Content-Type": "application/json"})
        self.await_end(job)

    def remove_job(self, job):
        place = self.answered[-1][0]  # from the moment of asking it may be gone
        self.answered.append((place, lambda ledger: setattr(ledger.jobs[job], "asked_to_remove",
                                                            True)))
        answer = self.client.request("DELETE", "/v1/jobs/" + job)
        if answer.status == 204:
            self.note(lambda ledger: setattr(ledger.jobs[job], "removed", True))

    def remove_scene(self, scene):
        place = self.answered[-1][0]
        self.answered.append((place, lambda ledger: ledger.scenes.__setitem__(scene, True)))
        self.client.request("DELETE", "/v1/scenes/" + scene)

    def act(self, fixture):
        first = self.upload(FIRST_SCENE)
        self.fetch(self.submit(first, 1))
        self.upload_bsdf(fixture)
        second = self.upload(FIRST_SCENE + b"# a second\n")
        removed = self.submit(second, 2)
        self.fetch(removed)
        waits = self.submit(second, 3, photons={"global": 1000000, "caustic": 1000})
        self.cancel(waits)
        self.fetch(self.submit(first, 4, technique="backward", photons={}, pixel_samples=4))
        self.remove_job(removed)
        self.remove_scene(self.upload(FIRST_SCENE + b"# a third\n"))
        for seed in range(5, 9):  # the budget makes earlier maps and results go
            self.fetch(self.submit(first, seed))
        self.client.close()
        self.daemon.stop()


class Cut:
    """A folder as a cut leaves it, and the daemon on it."""

    def __init__(self, build, folder, number):
        self.build = build
        self.root = os.path.join(folder, "cut-%d" % number)

    def check(self, ledger):
        daemon = Daemon(self.build, self.root, ["--threads", "2"])
        if not daemon.wait_listening():
            daemon.wait()
            raise Failure("the daemon does not start")
        client = Client(daemon.port, "cuts")
        try:
            self._check_files(client, ledger)
            while self._waiting():
                time.sleep(0.02)
        finally:
            client.close()
            daemon.stop()
        ledger.check_at_rest(self.root)
        left = os.listdir(os.path.join(self.root, "tmp"))
        if left:
            raise Failure("left in tmp: %s" % left)

    def _waiting(self):
        database = sqlite3.connect("file:%s/oriel.db?mode=ro" % self.root, uri=True)
        try:
            return database.execute("SELECT count(*) FROM jobs WHERE state IN "
                                    "('queued', 'running')").fetchone()[0]
        finally:
            database.close()

    def _check_files(self, client, ledger):
        """Results that were fetched are what they were, or are said to have gone for the budget."""
        for job_id, job in ledger.jobs.items():
            for name, digest in job.files.items():
                answer = client.request("GET", "/v1/jobs/%s/files/%s" % (job_id, name))
                gone = answer.status == 410 or (answer.status == 404 and job.asked_to_remove)
                if not gone and (answer.status != 200 or
                                 hashlib.sha256(answer.body).hexdigest() != digest):
                    raise Failure("%s of job %s: %s" % (name, job_id, answer.problem()))


def play(session, build, folder, cuts, seed):
    acts = read_acts(session.recording)
    chance = random.Random(seed)
    places = sorted(chance.sample(range(len(acts)), min(cuts, len(acts))))
    disk, failures, told, at = Disk(), 0, 0, 0
    kinds = (("nothing unsynced", None, False), ("names alone", None, True),
             ("some of the database", chance, False))
    with open(session.recording + ".data", "rb") as data:
        for number, place in enumerate(places):
            while at <= place:
                disk.play(acts[at][1], data)
                at += 1
            ledger = Ledger()
            for end, tell in session.answered:
                if end <= acts[place][0]:
                    tell(ledger)
            cut, kind = Cut(build, folder, number), kinds[number % len(kinds)]
            disk.cut(cut.root, kind[1], kind[2])
            told += len(ledger.jobs) + len(ledger.scenes) + len(ledger.bsdfs)
            try:
                cut.check(ledger)
                shutil.rmtree(cut.root)
                os.unlink(cut.root + ".log")
            except Exception as error:  # pylint: disable=broad-except
                failures += 1
                print("cut %d of %d, with %s, FAILED: %s: %s\n  the folder: %s" % (
                    place, len(acts), kind[0], type(error).__name__, error, cut.root), flush=True)
    print("power cuts: %d in %d acts, %d things answered for before them, %d failures" % (
        len(places), len(acts), told, failures), flush=True)
    return failures


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build")
    parser.add_argument("--cuts", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    with open(os.path.join(arguments.build, "orield"), "rb") as stream:
        program = stream.read()
    if b"__asan_init" in program or b"__tsan_init" in program:
        print("power cuts: left out with sanitizers")  # their library would have to come first
        return 0
    top = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    with open(os.path.join(top, "fixtures", "bsdf_klems41.xml"), "rb") as stream:
        fixture = stream.read()
    folder = tempfile.mkdtemp(prefix="oriel-cuts-")
    session = Session(arguments.build, folder)
    session.act(fixture)
    failures = play(session, arguments.build, folder, arguments.cuts, arguments.seed)
    if failures:
        print("seed %d; all is in %s" % (arguments.seed, folder))
        return 1
    shutil.rmtree(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
