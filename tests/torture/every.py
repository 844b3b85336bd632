"""One call fails: every allocation, write, sync and rename of an upload, a job and an eviction.

    python3 tests/torture/every.py BUILD [--step N] [NAME...]

Each act is done once to count its calls of a kind, then again and again, and each time another call
fails, alone (faulty.c): with --step 1 every one, else every N-th. Allocations are those of the whole
process and of the children that check uploads, the libraries' and Embree's included.

Whatever happens then, one of three things is answered: what was asked for, and it is true; an error
that says what was lacking; or nothing, because the connection or the daemon went, which then says
so in its log and starts again. Nothing answered for is lost, no wrong bytes are served, and nothing
is left in tmp/.
"""

import argparse
import errno
import os
import sys
import time

from daemon import Client, Failure, Gone
from faults import MEMORY, NAMES, REMOVALS, SYNCS, WRITES, Case, expect, has_sanitizer
from ledger import list_files
from load import FIRST_SCENE, upload_scene

# Embree, where it gets no memory for a block, may spin for ever: a check's bound on time ends it.
LACKING = {MEMORY: ("memory", "too large", "seconds of processor time"), WRITES: ("No space", "disk is full", "disk"),
           SYNCS: ("Input/output", "disk"), NAMES: ("No space", "disk", "cannot"), REMOVALS: ("Input/output", "disk")}
ERRNO = {MEMORY: errno.ENOMEM, WRITES: errno.ENOSPC, SYNCS: errno.EIO, NAMES: errno.ENOSPC,
         REMOVALS: errno.EIO}
SEEDS = range(11, 16)  # of jobs that make each other's maps go
LOOK_AFTER = 40  # trials, and all is looked over
TRIAL_S = 60


class Trials(Case):
    shims = ("faulty.so", "scarce.so")
    extra = ("--check-timeout", "5")

    def __init__(self, build, what):
        self.what = what
        self.deaths = self.dropped = self.refused = self.done_as_asked = 0
        self.number = self.counted = 0
        super().__init__(build)
        self.images = {1: self.images_of(self.first)}

    def images_of(self, job):
        return {name: body for name, body in self.fetch(job).items() if name != "result.json"}

    def compare(self, job, wanted):
        given = self.images_of(job)
        wrong = [name for name in sorted(set(given) | set(wanted))
                 if given.get(name) != wanted.get(name)]
        if wrong:
            raise Failure("of its pictures %s are not as before, of %s" % (wrong, sorted(given)))

    def ended(self):
        return self.daemon.process.poll() is not None

    def calm(self):
        """Nothing fails from now on."""
        self.counted = max(self.counted, self.calls())
        self.fail(0, 0)

    def bring_back(self):
        """After the daemon went: it says why, and starts."""
        self.calm()
        status = self.daemon.wait()
        self.deaths += 1
        last = self.log().strip().split("\n")[-6:]
        if not any(word in line for line in last for word in
                   ("memory", "bad_alloc", "error", "failed", "abort")):
            raise Failure("it ended with %d, and its log does not say why: %s" % (status, last))
        self.client.close()
        if not self.start():
            raise Failure("it does not start again")

    def persist(self, ask):
        """ask(), again where a connection was dropped but the daemon is there."""
        until = time.monotonic() + TRIAL_S
        while True:
            try:
                return ask()
            except Gone:
                time.sleep(0.05)
                if self.ended():
                    raise
                self.dropped += 1
                if time.monotonic() > until:
                    raise Failure("connections are dropped again and again") from None

    def status(self, job):
        """A poll for which there was no memory says so, and is asked again."""
        while True:
            answer = self.client.request("GET", "/v1/jobs/" + job)
            if answer.status == 200:
                return answer.json()
            self.check_problem(answer.json())

    def check_problem(self, problem):
        text = "%s: %s" % (problem.get("title"), problem.get("detail"))
        expect("the status of '%s'" % text, problem["status"], 500, 503, 507, 413)
        if not any(word in text for word in LACKING[self.what]):
            raise Failure("nothing is said of what is lacking: %s" % text)
        self.refused += 1

    # ---- What is done ------------------------------------------------------------------------

    def upload(self):
        """A new scene; True where it was taken."""
        self.number += 1
        answer = upload_scene(self.client, FIRST_SCENE + b"# %d\n" % self.number)
        if answer.status not in (200, 201):
            self.check_problem(answer.json())
            return
        self.done_as_asked += 1
        self.calm()
        scene = answer.json()["id"]
        expect("a scene answered for", self.client.request("GET", "/v1/scenes/" + scene).status, 200)

    def compute(self, seed=1):
        """The first job again, its maps gone."""
        answer = self.persist(lambda: self.try_to_submit(seed=seed))
        if answer.status != 202:
            self.check_problem(answer.json())
            self.expect_withdrawn()
            return
        job = answer.json()["id"]
        try:
            status = self.persist(lambda: self.wait(job, seconds=TRIAL_S))
        except Gone:
            self.bring_back()
            status = self.wait(job)
        self.calm()
        if status["state"] != "succeeded":
            self.check_problem(status["error"])
        else:
            self.compare(job, self.images[seed])
            self.done_as_asked += 1
        expect("its removal", self.client.request("DELETE", "/v1/jobs/" + job).status, 204)

    def expect_withdrawn(self):
        """A job that nobody was told of does not go on."""
        self.calm()
        until = time.monotonic() + TRIAL_S
        while True:
            jobs = [job for job in self.client.request("GET", "/v1/jobs").json()["jobs"]
                    if job["state"] in ("queued", "running", "cancelling")]
            if not jobs:
                return
            expect("time for %s to stop" % [job["id"] for job in jobs], time.monotonic() < until, True)
            time.sleep(0.01)

    def evict(self):
        """A job whose maps have to take the place of those of the job before."""
        self.number += 1
        self.compute(SEEDS[self.number % len(SEEDS)])

    def list_maps(self):
        return sorted("%s-%s.opm" % (entry["kind"], entry["key"])
                      for entry in self.client.request("GET", "/v1/maps").json()["maps"])

    def bound(self):
        """From now on there is room for the maps of one job, beside the first job's results."""
        for seed in SEEDS:
            self.forget_maps()
            job = self.submit(seed=seed)
            expect("a job", self.wait(job)["state"], "succeeded")
            self.images[seed] = self.images_of(job)
            expect("its removal", self.client.request("DELETE", "/v1/jobs/" + job).status, 204)
        sizes = {folder: sum(os.path.getsize(os.path.join(self.root, path)) for path, _ in list_files(self.root)
                             if path.startswith(folder + os.sep))
                 for folder in ("blobs", "maps", "results")}
        self.stop()
        self.extra += ("--storage-budget", str(sum(sizes.values()) + sizes["maps"] * 9 // 10))
        self.start()
        self.use_first()
        before = self.list_maps()
        self.evict()
        expect("whether maps went", bool(set(before) & set(self.list_maps())), False)

    def use_first(self):
        """Its results are not those that go, unless a map could not be removed for them."""
        if "--storage-budget" in self.extra and self.status(self.first).get("evicted"):
            self.first = self.submit()
            expect("the first job again", self.wait(self.first)["state"], "succeeded")
            self.files = self.fetch(self.first)
        expect("the first job's pictures", self.images_of(self.first) == self.images[1], True)

    def forget_maps(self):
        for entry in self.client.request("GET", "/v1/maps").json()["maps"]:
            self.client.request("DELETE", "/v1/maps/%s/%s" % (entry["kind"], entry["key"]))

    def trial(self, act, nth):
        self.counted = 0
        self.fail(ERRNO[self.what], self.what, nth)
        try:
            act()
        except Gone:
            time.sleep(0.05)
            if self.ended():
                self.bring_back()
            else:
                self.dropped += 1
                self.client.close()
                self.client = Client(self.daemon.port, "faults")
        self.calm()
        return self.counted

    def run(self, name, act, before, step):
        before()
        calls, trials, failures = self.trial(act, 1 << 30), 0, {}
        for nth in range(1, calls + 1, step):
            before()
            try:
                self.trial(act, nth)
            except Failure as failure:
                self.calm()
                failures.setdefault(str(failure)[:60], []).append("call %d: %s" % (nth, failure))
                if self.ended():
                    self.bring_back()
            trials += 1
            if trials % LOOK_AFTER == 0:
                self.look()
        self.look()
        if failures:
            raise Failure("%d kinds of failures in %d trials\n    " % (len(failures), trials) +
                          "\n    ".join("%d times, first at %s" % (len(all_of), all_of[0])
                                        for all_of in failures.values()))
        print("every %-28s met: %d calls, %d of them failed: %d times it was done all the same, %d "
              "refused, %d connections dropped, %d times the daemon ended" % (
                  name, calls, trials, self.done_as_asked, self.refused, self.dropped, self.deaths),
              flush=True)

    def look(self):
        time.sleep(1.2)  # rows that could not be written are tried again every second
        self.use_first()
        if self.what == REMOVALS:  # what could not be removed goes at the next start
            self.stop()
            self.start()
            expect("the maps' files", sorted(os.listdir(os.path.join(self.root, "maps"))),
                   self.list_maps())
        until = time.monotonic() + TRIAL_S
        while os.listdir(os.path.join(self.root, "tmp")) and time.monotonic() < until:
            time.sleep(0.1)
        expect("what is left in tmp", os.listdir(os.path.join(self.root, "tmp")), [])


def nothing(_):
    pass


# name: kind of call, the act, what comes before each, the step
CASES = {
    "write_of_an_upload": (WRITES, Trials.upload, nothing, 1),
    "sync_of_an_upload": (SYNCS, Trials.upload, nothing, 1),
    "name_of_an_upload": (NAMES, Trials.upload, nothing, 1),
    "allocation_of_an_upload": (MEMORY, Trials.upload, nothing, 1),
    "write_of_a_job": (WRITES, Trials.compute, Trials.forget_maps, 1),
    "sync_of_a_job": (SYNCS, Trials.compute, Trials.forget_maps, 1),
    "name_of_a_job": (NAMES, Trials.compute, Trials.forget_maps, 1),
    "allocation_of_a_job": (MEMORY, Trials.compute, Trials.forget_maps, 50),
    "write_of_an_eviction": (WRITES, Trials.evict, Trials.use_first, 1),
    "sync_of_an_eviction": (SYNCS, Trials.evict, Trials.use_first, 1),
    "name_of_an_eviction": (NAMES, Trials.evict, Trials.use_first, 1),
    "removal_of_an_eviction": (REMOVALS, Trials.evict, Trials.use_first, 1),
    "allocation_of_an_eviction": (MEMORY, Trials.evict, Trials.use_first, 200),
}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--step", type=int, default=0)
    arguments = parser.parse_intermixed_args()
    if has_sanitizer(arguments.build):
        print("every: left out with sanitizers")
        return 0
    failures = 0
    for name, (what, act, before, step) in CASES.items():
        if arguments.names and name not in arguments.names:
            continue
        case = Trials(arguments.build, what)
        try:
            if act is Trials.evict:
                case.bound()
            case.run(name, lambda: act(case), lambda: before(case), arguments.step or step)
            case.fail(0, 0)
            case.check_all_is_well()
            case.done()
        except Exception as error:  # pylint: disable=broad-except
            failures += 1
            with open(case.control, "rb") as stream:
                print("every %-28s FAILED at call %s: %s: %s\n  the data folder is %s" % (
                    name, stream.read().hex(" ", 4), type(error).__name__, error, case.root),
                      flush=True)
            if case.daemon:
                case.daemon.kill()
                case.daemon.wait()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
