"""Faults of what the daemon stands on: a clear error each, nothing lost, and on it goes.

    python3 tests/torture/faults.py BUILD [NAME...]

Disks that are full or fail (faulty.c, loaded into the daemon), files cut short or with a byte
changed, a database that is locked, damaged or of a later version, no descriptors, no memory. Each
case starts from a daemon with a scene and a job that succeeded, and ends by asking for both again.
"""

import errno
import hashlib
import os
import resource
import shutil
import signal
import socket
import sqlite3
import struct
import sys
import tempfile
import threading
import time

from daemon import Client, Daemon, Failure
from ledger import ENDED, list_files
from load import FIRST_SCENE, upload_scene

WRITES, SYNCS, NAMES, MEMORY, REMOVALS, SLOW = 1, 2, 4, 8, 16, 32
SENSORS = [[2, 1, 0.8, 0, 0, 1], [2, 4, 0.8, 0, 0, 1]]
VIEW = "-vtv -vp 2 4.5 1.6 -vd 0 -1 0 -vu 0 0 1 -vh 70 -vv 55"


def is_long():
    return os.environ.get("ORIEL_LONG", "0") not in ("", "0")


def expect(what, given, *wanted):
    if given not in wanted:
        raise Failure("%s is %r, not %s" % (what, given, " or ".join(map(repr, wanted))))


def expect_problem(answer, statuses, *words):
    """A problem document whose text has one of the words."""
    expect("the status of %r" % answer.body[:300], answer.status, *statuses)
    text = answer.body.decode()
    if not answer.headers["Content-Type"].startswith("application/problem+json") or not any(
            word in text for word in words):
        raise Failure("not one of %s: %s" % (", ".join(words), text))


class Case:
    """A daemon with a scene and a finished job, on a disk that can be made to fail."""

    shims = ("faulty.so",)
    extra = ()  # arguments of the daemon

    def __init__(self, build):
        self.build = build
        self.folder = tempfile.mkdtemp(prefix="oriel-faults-")
        self.root = os.path.join(self.folder, "data")
        os.mkdir(self.root)
        self.control = os.path.join(self.folder, "control")
        self.fail(0, 0)
        self.daemon = self.client = None
        self.start()
        self.scene = upload_scene(self.client, FIRST_SCENE).json()["id"]
        self.first = self.submit()
        expect("the first job", self.wait(self.first)["state"], "succeeded")
        self.files = self.fetch(self.first)

    def fail(self, number, what, nth=0):
        """All such calls from now on, or the nth alone."""
        mode = "r+b" if os.path.exists(self.control) else "wb"
        with open(self.control, mode) as stream:
            stream.write(struct.pack("iiii", 0, 0, nth, 0))
            stream.flush()
            stream.seek(0)
            stream.write(struct.pack("ii", number, what))

    def calls(self):
        """How many of them there were."""
        with open(self.control, "rb") as stream:
            return struct.unpack("iiii", stream.read(16))[3]

    def start(self):
        shim = " ".join(os.path.join(self.build, "tests", name) for name in self.shims)
        self.daemon = Daemon(self.build, self.root, ["--threads", "2", *self.extra],
                             {"LD_PRELOAD": shim, "FAULTY": self.control})
        if not self.daemon.wait_listening():
            self.daemon.wait()
            self.daemon = None
            return False
        self.client = Client(self.daemon.port, "faults")
        return True

    def stop(self):
        self.client.close()
        self.daemon.stop()
        self.daemon = None

    def kill(self):
        self.client.close()
        self.daemon.kill()
        self.daemon.wait()
        self.daemon = None

    def log(self):
        with open(self.root + ".log", encoding="utf-8", errors="replace") as stream:
            return stream.read()

    def document(self, **members):
        return dict({"kind": "render", "scene": self.scene, "seed": 1, "technique": "gather",
                     "photons": {"global": 4000, "caustic": 2000}, "gather_samples": 64,
                     "sensors": SENSORS, "views": [{"name": "view", "view": VIEW, "width": 24,
                                                    "height": 16}]}, **members)

    def try_to_submit(self, **members):
        return self.client.post_json("/v1/jobs", self.document(**members))

    def submit(self, **members):
        answer = self.try_to_submit(**members)
        expect("the status of %r" % answer.body[:300], answer.status, 202)
        return answer.json()["id"]

    def status(self, job):
        return self.client.request("GET", "/v1/jobs/" + job).json()

    def wait(self, job, states=ENDED, seconds=60):
        until = time.monotonic() + seconds
        while True:
            status = self.status(job)
            if status["state"] in states:
                return status
            if time.monotonic() > until:
                raise Failure("job %s is still %s" % (job, status["state"]))
            time.sleep(0.02)

    def fetch(self, job):
        files = {}
        for entry in self.status(job)["files"]:
            answer = self.client.request("GET", "/v1/jobs/%s/files/%s" % (job, entry["name"]))
            expect("the status of %s" % entry["name"], answer.status, 200)
            files[entry["name"]] = answer.body
        return files

    def path_of(self, folder, largest=False):
        """A file below a folder of the data."""
        paths = [os.path.join(self.root, path) for path, _ in list_files(self.root)
                 if path.startswith(folder + os.sep)]
        paths = sorted((path for path in paths if os.path.isfile(path)), key=os.path.getsize)
        return paths[-1 if largest else 0]

    def check_all_is_well(self):
        """What was acknowledged is there, and new work is done; the same after a restart. The daemon is
        down then."""
        for last in (False, True):
            expect("the first job", self.status(self.first)["state"], "succeeded")
            expect("its files as fetched again", self.fetch(self.first) == self.files, True)
            again = self.submit(seed=7)
            expect("a new job", self.wait(again)["state"], "succeeded")
            self.stop()
            with sqlite3.connect(os.path.join(self.root, "oriel.db")) as database:
                said = database.execute("PRAGMA integrity_check").fetchall()
            database.close()
            expect("the database", said, [("ok",)])
            expect("what is left in tmp", os.listdir(os.path.join(self.root, "tmp")), [])
            if not last and not self.start():
                raise Failure("the daemon does not start again")

    def done(self):
        if self.daemon:
            self.stop()
        shutil.rmtree(self.folder)


def change_byte(path, at=None):
    size = os.path.getsize(path)
    with open(path, "r+b") as stream:
        stream.seek(size // 2 if at is None else at)
        byte = stream.read(1)[0]
        stream.seek(-1, os.SEEK_CUR)
        stream.write(bytes([byte ^ 0x04]))


# ---- Disks ---------------------------------------------------------------------------------------

def bad_disk(case, number, what, status_wanted, words):
    running = case.submit(seed=2, photons={"global": 400000, "caustic": 1000})
    case.wait(running, ("running",))
    case.fail(number, what)
    status = case.wait(running)
    expect("the job that ran", status["state"], "failed")
    if not any(word in status["error"]["detail"] for word in words):
        raise Failure("it says: %s" % status["error"])
    expect("its status", status["error"]["status"], status_wanted)
    expect_problem(upload_scene(case.client, FIRST_SCENE + b"# other\n"), (status_wanted,), *words)
    expect_problem(case.try_to_submit(seed=3), (status_wanted,), *words)
    expect("the first job", case.status(case.first)["state"], "succeeded")
    expect("its files", case.fetch(case.first) == case.files, True)
    expect("health", case.client.request("GET", "/healthz").status, 200)
    case.fail(0, 0)
    time.sleep(1.5)
    case.kill()
    case.start()
    expect("the job that failed, after a kill", case.status(running)["state"], "failed")


def disk_full(case):
    bad_disk(case, errno.ENOSPC, WRITES | SYNCS, 507, ("No space left", "disk is full"))


def quota_full(case):
    bad_disk(case, errno.EDQUOT, WRITES | SYNCS, 507, ("Disk quota exceeded", "disk I/O"))


def disk_fails(case):
    bad_disk(case, errno.EIO, WRITES | SYNCS, 500, ("Input/output", "disk I/O"))


def syncs_fail(case):
    bad_disk(case, errno.EIO, SYNCS, 500, ("Input/output", "disk I/O"))


def slow_disk(case):
    """Where the loop waits for the disk, everybody does: never for what somebody asks, however much
    goes for it."""
    delay_s, jobs = 0.1, [case.submit(seed=seed) for seed in range(20, 26)]
    for job in jobs:
        expect("a job", case.wait(job)["state"], "succeeded")
        case.fetch(job)
    used = sum(os.path.getsize(os.path.join(case.root, path)) for path, _ in list_files(case.root)
               if path.split(os.sep)[0] in ("blobs", "maps", "results"))
    case.extra = ("--storage-budget", str(used + 4096))
    restarted(case, lambda: None)
    case.fetch(case.first)

    def never_waits(what, act):
        case.fail(int(1000 * delay_s), SLOW)
        answer = act()
        time.sleep(0.3)
        if case.calls() > 0:
            raise Failure("%s: the loop waited for the disk %d times" % (what, case.calls()))
        return answer

    filler = FIRST_SCENE + b"#" * (used * 4 // 10) + b"\n"
    before = len(list_files(case.root))
    answer = never_waits("an upload that others go for", lambda: upload_scene(case.client, filler))
    expect("the status of %r" % answer.body[:300], answer.status, 201)
    case.fail(0, 0)
    if before - len(list_files(case.root)) < 12:
        raise Failure("of %d files %d are left" % (before, len(list_files(case.root))))
    job = case.submit(seed=30)
    never_waits("a job", lambda: case.wait(job))
    never_waits("another", lambda: case.wait(case.submit(seed=31)))
    never_waits("its removal", lambda: case.client.request("DELETE", "/v1/jobs/" + job))
    case.fail(0, 0)
    for line in case.client.request("GET", "/metrics").body.decode().split("\n"):
        if line.startswith("oriel_loop_longest_turn_seconds "):
            print("# the longest turn: %s s, of syncs of %s s" % (line.split()[1], delay_s))


# ---- Files ---------------------------------------------------------------------------------------

def damaged_map(case, damage):
    before = case.files["view.hdr"]
    for path, _ in list_files(case.root):
        if path.startswith("maps" + os.sep):
            damage(os.path.join(case.root, path))
    again = case.submit(gather_samples=64, sensors=SENSORS[:1])
    expect("the job", case.wait(again)["state"], "succeeded")
    result = case.client.request("GET", "/v1/jobs/%s/result" % again).json()
    expect("a cached map", result["maps"][0]["cached"], False)
    if not any("damaged" in warning for warning in result["warnings"]):
        raise Failure("no warning: %s" % result["warnings"])
    expect("the picture", case.fetch(again)["view.hdr"] == before, True)


def restarted(case, act):
    """With nothing in memory that was read before."""
    case.stop()
    act()
    case.start()


def removal_beside_upload(case):
    """What comes again, and is removed by another while it is kept, comes as new. Of 30 removals some
    five fall between; the short form does every other."""
    def again_and_again(post, path):
        for step in range(0, 30, 1 if is_long() else 2):
            expect("the status of %s" % path, post(case.client).status, 200, 201)
            client, answers = case.daemon.client("another"), []
            again = threading.Thread(target=lambda: answers.append(post(client)))
            again.start()
            time.sleep(0.0005 * step)
            removed = case.client.request("DELETE", path)
            again.join()
            client.close()
            expect("its removal", removed.status, 204, 404)
            expect("the status of %r" % answers[0].body[:300], answers[0].status, 200, 201)
        expect("the status of %s" % path, post(case.client).status, 200, 201)
        expect("what is there", case.client.request("GET", path).status, 200)

    text = FIRST_SCENE + b"# once more\n"
    scene = upload_scene(case.client, text).json()["id"]
    again_and_again(lambda client: upload_scene(client, text), "/v1/scenes/" + scene)
    with open("tests/fixtures/bsdf_klems41.xml", "rb") as stream:
        xml = stream.read()
    again_and_again(lambda client: client.request("POST", "/v1/bsdfs", xml, {"Content-Type": "application/xml"}),
                    "/v1/bsdfs/" + hashlib.sha256(xml).hexdigest())


def truncated_map(case):
    case.stop()
    case.start()
    damaged_map(case, lambda path: os.truncate(path, os.path.getsize(path) // 2))


def flipped_map(case):
    case.stop()
    case.start()
    damaged_map(case, change_byte)


def damaged_blob(case, damage):
    path = None
    for name, _ in list_files(case.root):
        full = os.path.join(case.root, name)
        if name.startswith("blobs" + os.sep) and os.path.isfile(full):
            with open(full, "rb") as stream:
                if stream.read() == FIRST_SCENE:
                    path = full
    restarted(case, lambda: damage(path))
    failed = case.submit(seed=4)
    status = case.wait(failed)
    expect("the job", status["state"], "failed")
    expect("'damaged' is said", "damaged" in status["error"]["detail"], True)
    with open(path, "wb") as stream:
        stream.write(FIRST_SCENE)


def map_cut_under_way(case):
    """Cut short beneath a job that reads it: that ends the daemon (SIGBUS), and is survived."""
    members = {"technique": "direct", "photons": {"global": 100000, "caustic": 10000},
               "views": [{"name": "view", "view": VIEW, "width": 500, "height": 350}]}
    whole = case.submit(**members)
    expect("the job with a whole map", case.wait(whole)["state"], "succeeded")
    restarted(case, lambda: None)
    running = case.submit(**members)
    while case.wait(running, ("running",))["stage"] != "render":
        time.sleep(0.005)
    for path, _ in list_files(case.root):
        if path.startswith("maps" + os.sep):
            os.truncate(os.path.join(case.root, path), 4096)
    case.client.close()
    expect("how the daemon ends", case.daemon.process.wait(60), -signal.SIGBUS)
    case.daemon.wait()
    case.start()
    status = case.wait(running)
    expect("the job", status["state"], "succeeded")
    expect("how often it was tried", status["attempts"], 2)
    expect("its picture", case.fetch(running)["view.hdr"] == case.fetch(whole)["view.hdr"], True)
    result = case.client.request("GET", "/v1/jobs/%s/result" % running).json()
    expect("a cached map", any(one["cached"] for one in result["maps"]), False)
    if not any("damaged" in warning for warning in result["warnings"]):
        raise Failure("no warning: %s" % result["warnings"])


def flipped_blob(case):
    damaged_blob(case, change_byte)


def truncated_blob(case):
    damaged_blob(case, lambda path: os.truncate(path, 100))


def damaged_document(case):
    blocker = case.submit(seed=5, photons={"global": 400000, "caustic": 1000})
    waiting = case.submit(seed=6)
    case.wait(blocker, ("running",))
    for name, _ in list_files(case.root):
        full = os.path.join(case.root, name)
        if name.startswith("blobs" + os.sep) and os.path.isfile(full):
            with open(full, "rb") as stream:
                text = stream.read()
            if b'"seed": 6' in text:
                change_byte(full, text.index(b'"seed": 6') + 8)
    status = case.wait(waiting)
    expect("the job", status["state"], "failed")
    expect("'damaged' is said", "damaged" in status["error"]["detail"], True)
    case.wait(blocker)


def damaged_result(case, damage):
    """Seen while the daemon runs and after a start; the other files are as good as before, and so is
    this one once it is put back, or computed anew."""
    path = os.path.join(case.root, "results", case.first, "view.hdr")
    where = "/v1/jobs/%s/files/view.hdr" % case.first
    for act in (lambda: damage(path), lambda: restarted(case, lambda: None)):
        act()
        for headers in ({}, {"Range": "bytes=0-9"}):
            expect_problem(case.client.request("GET", where, None, headers), (500,), "damaged")
    expect("the other picture",
           case.client.request("GET", "/v1/jobs/%s/files/view.png" % case.first).body,
           case.files["view.png"])
    again = case.submit()
    expect("the job again", case.wait(again)["state"], "succeeded")
    expect("the picture", case.fetch(again)["view.hdr"] == case.files["view.hdr"], True)
    with open(path, "wb") as stream:
        stream.write(case.files["view.hdr"])


def flipped_result(case):
    damaged_result(case, change_byte)


def truncated_result(case):
    damaged_result(case, lambda path: os.truncate(path, os.path.getsize(path) // 2))


# ---- The database --------------------------------------------------------------------------------

def locked_database(case):
    other = sqlite3.connect(os.path.join(case.root, "oriel.db"), isolation_level=None)
    running = case.submit(seed=8, photons={"global": 400000, "caustic": 1000})
    other.execute("BEGIN IMMEDIATE")
    expect_problem(case.try_to_submit(seed=9), (500, 503), "locked")
    expect("polls", case.client.request("GET", "/v1/jobs/" + case.first).status, 200)
    case.wait(running)
    other.execute("ROLLBACK")
    other.close()
    time.sleep(1.5)
    case.kill()
    case.start()
    expect("the job, after a kill", case.status(running)["state"], "succeeded")


def refused_database(case, act, *words):
    path = os.path.join(case.root, "oriel.db")
    case.stop()
    shutil.copy(path, path + ".kept")
    act(path)
    expect("a start", case.start(), False)
    last = case.log().strip().split("\n")[-1]
    if not any(word in last for word in words):
        raise Failure("the daemon says: %s" % last)
    for name in os.listdir(case.root):
        if name.startswith("oriel.db-"):
            os.unlink(os.path.join(case.root, name))
    os.rename(path + ".kept", path)
    expect("a start", case.start(), True)


def later_database(case):
    def act(path):
        database = sqlite3.connect(path)
        database.execute("INSERT INTO schema_migrations VALUES (9999, 'later', 'x', 0)")
        database.commit()
        database.close()
    refused_database(case, act, "later version")


def damaged_database(case):
    def act(path):
        with open(path, "r+b") as stream:
            stream.seek(4096)
            stream.write(b"\xff" * 6 * 4096)
    refused_database(case, act, "malformed", "damaged")


def no_database(case):
    refused_database(case, lambda path: change_byte(path, 3), "not a database")


# ---- Descriptors and memory ----------------------------------------------------------------------

def no_descriptors(case):
    pid = case.daemon.process.pid
    before = resource.prlimit(pid, resource.RLIMIT_NOFILE)
    used = len(os.listdir("/proc/%d/fd" % pid))
    resource.prlimit(pid, resource.RLIMIT_NOFILE, (used, before[1]))
    waiting = [socket.create_connection(("127.0.0.1", case.daemon.port)) for _ in range(8)]
    expect_problem(upload_scene(case.client, FIRST_SCENE + b"# other\n"), (500, 503, 507),
                   "Too many open files")
    expect_problem(case.try_to_submit(seed=11), (500, 503, 507), "Too many open files", "unable to")
    expect("polls", case.client.request("GET", "/v1/jobs/" + case.first).status, 200)
    resource.prlimit(pid, resource.RLIMIT_NOFILE, before)
    for one in waiting:
        one.close()


def no_memory(case):
    """A job that would take more than there is fails by itself."""
    pid = case.daemon.process.pid
    before = resource.prlimit(pid, resource.RLIMIT_AS)
    with open("/proc/%d/statm" % pid, encoding="ascii") as stream:
        used = int(stream.read().split()[0]) * resource.getpagesize()
    resource.prlimit(pid, resource.RLIMIT_AS, (used + (200 << 20), before[1]))
    greedy = case.submit(seed=12, photons={"global": 100000000, "caustic": 1000})
    status = case.wait(greedy)
    resource.prlimit(pid, resource.RLIMIT_AS, before)
    expect("the job", status["state"], "failed")
    expect("'memory' is said", "memory" in status["error"]["detail"], True)
    expect("how often it was tried", status["attempts"], 1)


CASES = (disk_full, quota_full, disk_fails, syncs_fail, slow_disk, removal_beside_upload, truncated_map, flipped_map, map_cut_under_way,
         flipped_blob, truncated_blob, flipped_result, truncated_result, damaged_document, locked_database,
         later_database, damaged_database, no_database, no_descriptors, no_memory)


def has_sanitizer(build):
    """Then nothing may be loaded before its library."""
    with open(os.path.join(build, "orield"), "rb") as stream:
        program = stream.read()
    return b"__asan_init" in program or b"__tsan_init" in program


def main():
    build, names = sys.argv[1], sys.argv[2:]
    if has_sanitizer(build):
        print("faults: left out with sanitizers")
        return 0
    failures = 0
    for case_of in CASES:
        if names and case_of.__name__ not in names:
            continue
        case = Case(build)
        started = time.monotonic()
        try:
            case_of(case)
            case.check_all_is_well()
            print("fault %-18s met: a clear error, nothing lost (%.1f s)" % (
                case_of.__name__, time.monotonic() - started), flush=True)
            case.done()
        except Exception as error:  # pylint: disable=broad-except
            failures += 1
            print("fault %-18s FAILED: %s: %s\n  the data folder is %s" % (
                case_of.__name__, type(error).__name__, error, case.root), flush=True)
            if case.daemon:
                case.daemon.process.send_signal(signal.SIGKILL)
                case.daemon.wait()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
