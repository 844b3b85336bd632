"""What the daemon has acknowledged, and whether it is true to it.

A Ledger is written to by the clients' threads; what it remembers was answered by the daemon before
it was killed. check() compares that with the database and the folders of a daemon that has just
started, whose files of before are listed in `before`; check_at_rest() with those of one that ran
out of work and was stopped.
"""

import collections
import hashlib
import os
import sqlite3
import threading

from daemon import Failure

ENDED = ("succeeded", "failed", "cancelled")
KILLER = "the daemon ended abruptly"  # of a job that was running during too many kills
FOLLOWS = {
    "queued": ENDED + ("queued", "running", "cancelling"),
    "running": ENDED + ("queued", "running", "cancelling"),
    "cancelling": ENDED + ("queued", "running", "cancelling"),
    "succeeded": ("succeeded",), "failed": ("failed",), "cancelled": ("cancelled",),
}


def sha256_of(path):
    digest = hashlib.sha256()
    with open(path, "rb") as stream:
        for chunk in iter(lambda: stream.read(1 << 20), b""):
            digest.update(chunk)
    return digest.hexdigest()


def list_files(root):
    """Files and empty folders below root: (path relative to it, which of that name it is)."""
    found = set()
    for folder, folders, files in os.walk(root):
        for name in files + folders:
            path = os.path.join(folder, name)
            try:
                if name in files or not os.listdir(path):
                    stat = os.stat(path)
                    found.add((os.path.relpath(path, root), (stat.st_ino, stat.st_mtime_ns)))
            except FileNotFoundError:
                pass
    return found


class Job:
    def __init__(self, identity):
        self.identity = identity  # jobs of the same have the same images
        self.state = "queued"     # as last seen
        self.asked_to_cancel = self.asked_to_remove = False
        self.cancelled = self.removed = False  # by an answered request
        self.files = {}           # name: SHA-256, as first fetched


class Ledger:
    def __init__(self):
        self.lock = threading.Lock()
        self.scenes, self.bsdfs = {}, {}     # id: has somebody asked to remove it?
        self.year_scenes = set()             # of these: without a sky, with weather
        self.jobs = {}                       # id: Job
        self.keys = {}                       # Idempotency-Key: id of its job
        self.images = {}                     # (identity, name): SHA-256
        self.counts = collections.Counter()

    # ---- What clients see ------------------------------------------------------------------------

    def count(self, what):
        with self.lock:
            self.counts[what] += 1

    def add_job(self, job_id, identity, key=None):
        with self.lock:
            self.jobs.setdefault(job_id, Job(identity))
            if key is None:
                return
            first = self.keys.setdefault(key, job_id)
            if first != job_id and not self.jobs[first].asked_to_remove:
                raise Failure("the key %s made two jobs, %s and %s" % (key, first, job_id))

    def see_state(self, job_id, state, problem=None):
        with self.lock:
            job = self.jobs[job_id]
            if state not in FOLLOWS[job.state]:
                raise Failure("job %s was %s and is %s" % (job_id, job.state, state))
            if state == "cancelled" and not job.asked_to_cancel:
                raise Failure("job %s is cancelled, which nobody has asked for" % job_id)
            if state == "failed" and not (problem or {}).get("detail", "").startswith(KILLER):
                raise Failure("job %s has failed: %s" % (job_id, problem))
            job.state = state

    def see_file(self, job_id, name, body):
        """Bytes never change; images are the same for all jobs of one identity."""
        digest = hashlib.sha256(body).hexdigest()
        with self.lock:
            job = self.jobs[job_id]
            if job.files.setdefault(name, digest) != digest:
                raise Failure("file %s of job %s has changed" % (name, job_id))
            if name.endswith(".hdr"):
                image = (job.identity, name)
                if self.images.setdefault(image, digest) != digest:
                    raise Failure("image %s of job %s is not what the same job gave before" %
                                  (name, job_id))
                self.counts["images compared"] += 1

    # ---- What is on the disk ---------------------------------------------------------------------

    def check(self, root, before):
        database = _Database(root)
        try:
            self._check_rows(database)
            self._check_states(database)
            database.check_files_exist()
            database.check_no_orphans(before & list_files(root), running=True)
        finally:
            database.close()

    def check_at_rest(self, root):
        database = _Database(root)
        try:
            self._check_rows(database)
            self._check_states(database)
            database.check_files_exist()
            database.check_hashes()
            database.check_no_orphans(list_files(root), running=False)
        finally:
            database.close()

    def _check_rows(self, database):
        with self.lock:
            for what, known, there in (("scene", self.scenes, database.scenes),
                                       ("BSDF", self.bsdfs, database.bsdfs)):
                lost = {item for item, mortal in known.items() if not mortal} - there
                if lost:
                    raise Failure("%d acknowledged %ss are lost: %s" %
                                  (len(lost), what, sorted(lost)[:3]))
            lost = {job for job, told in self.jobs.items()
                    if not told.asked_to_remove} - set(database.jobs)
            if lost:
                raise Failure("%d acknowledged jobs are lost: %s" % (len(lost), sorted(lost)[:3]))
            back = {job for job, told in self.jobs.items() if told.removed} & set(database.jobs)
            if back:
                raise Failure("%d removed jobs are back: %s" % (len(back), sorted(back)[:3]))

    def _check_states(self, database):
        for job_id, (state, problem) in database.jobs.items():
            if job_id in self.jobs:
                job = self.jobs[job_id]
                if job.cancelled and state not in ("cancelled", "succeeded"):
                    raise Failure("job %s was cancelled and is %s" % (job_id, state))
                self.see_state(job_id, state, problem)


class _Database:
    """What the rows say. The daemon may run meanwhile."""

    def __init__(self, root):
        self.root = root
        self.db = sqlite3.connect("file:%s/oriel.db?mode=ro" % root, uri=True)
        try:
            self.db.execute("BEGIN")
            self._read()
        except Exception:
            self.db.close()
            raise

    def close(self):
        self.db.close()

    def _column(self, sql):
        return [row[0] for row in self.db.execute(sql)]

    def _read(self):
        said = self._column("PRAGMA integrity_check")
        if said != ["ok"]:
            raise Failure("the database is damaged: %s" % said[:5])
        if self.db.execute("PRAGMA foreign_key_check").fetchone():
            raise Failure("a row names another that is not there")
        for what, sql in (("ids", "SELECT id FROM jobs"),
                          ("keys", "SELECT client || ' ' || request_key FROM jobs "
                                   "WHERE request_key IS NOT NULL")):
            values = self._column(sql)
            if len(values) != len(set(values)):
                raise Failure("the jobs' %s are not unique" % what)
        self.scenes = set(self._column("SELECT id FROM scenes"))
        self.bsdfs = set(self._column("SELECT id FROM bsdfs"))
        self.jobs = {row[0]: (row[1], {"detail": row[2] or ""}) for row in self.db.execute(
            "SELECT id, state, json_extract(problem, '$.detail') FROM jobs")}
        self.results = {row[0] for row in self.db.execute(
            "SELECT id FROM jobs WHERE state = 'succeeded' AND evicted_ms IS NULL")}
        self.maps = {"maps/%s-%s.opm" % row
                     for row in self.db.execute("SELECT kind, key FROM maps")}
        self.blobs = {"blobs/%s/%s" % (sha[:2], sha) for sha in self._column(
            "SELECT blob FROM scene_files UNION SELECT id FROM bsdfs "
            "UNION SELECT document FROM jobs")}

    def check_files_exist(self):
        for path in self.blobs:
            if not os.path.exists(os.path.join(self.root, path)):
                raise Failure("a row names %s, which is not there" % path)

    def check_hashes(self):
        for path in self.blobs:
            if sha256_of(os.path.join(self.root, path)) != os.path.basename(path):
                raise Failure("%s is damaged" % path)

    def check_no_orphans(self, files, running):
        """files: those that a start should have looked at. Of a job that goes on at the next start its
        finished sensors and their key stay, whose names begin with '+'."""
        known = {"oriel.db", "oriel.db-wal", "oriel.db-shm", "oriel.lock", "oriel.running", "oriel.id", "oriel.reserve", "oriel.key",
                 "blobs", "maps", "partial", "results", "tmp"}
        waiting = {job for job, (state, _) in self.jobs.items() if state in ("queued", "running")}
        for path, _ in sorted(files):
            parts = path.split(os.sep)
            owned = (path in known or parts[0] == "orphans" or path.startswith("oriel.db.before-") or path in self.blobs or path in self.maps or
                     parts[0] == "results" and parts[1] in self.results or
                     running and parts[0] in ("partial", "results") and parts[1] in waiting or
                     parts[0] == "partial" and len(parts) == 3 and parts[1] in waiting and parts[2][0] == "+" or
                     parts[0] == "blobs" and len(parts) == 2)
            if not owned:
                raise Failure("nothing knows of %s" % path)
