"""Clients that upload, submit, poll, cancel, fetch and remove, at random but for a seed.

Each runs in a thread until the daemon is gone, or it is told to stop. What is answered goes to the
ledger; an answer that no client should ever get is a Failure.
"""

import hashlib
import json
import threading
import urllib.parse

from daemon import Failure, Gone
from ledger import ENDED

_ROOM = """void plastic white 0 0 5 {wall:.3f} {wall:.3f} {wall:.3f} 0 0
void plastic grey 0 0 5 0.2 0.2 0.2 0 0
{pane}
grey polygon floor 0 0 12 0 0 0  4 0 0  4 5 0  0 5 0
white polygon ceiling 0 0 12 0 0 3  0 5 3  4 5 3  4 0 3
white polygon east 0 0 12 4 0 0  4 0 3  4 5 3  4 5 0
white polygon west 0 0 12 0 0 0  0 5 0  0 5 3  0 0 3
white polygon north 0 0 12 0 5 0  4 5 0  4 5 3  0 5 3
white polygon sill 0 0 12 0 0 0  0 0 1  4 0 1  4 0 0
white polygon lintel 0 0 12 0 0 2.5  0 0 3  4 0 3  4 0 2.5
pane polygon window 0 0 12 0 0 1  0 0 2.5  4 0 2.5  4 0 1
"""
_SKY = """!gendaylit 3 22 12 -a 38.42 -o -27.14 -m -30 -W 800 120
skyfunc glow sky_glow 0 0 4 1 1 1 0
sky_glow source sky 0 0 4 0 0 1 180
"""
_WEATHER = """place here
latitude 38.42
longitude -27.14
time_zone -30
site_elevation 0
weather_data_file_units 1
3 22 10.5 700 120
3 22 11.5 800 120
3 22 12.5 800 120
"""
_GLASS = "void glass pane 0 0 3 0.9 0.9 0.9"
_BSDF = "void BSDF pane 6 0 pane.xml 0 0 1 . 0 0"
_VIEW = "-vtv -vp 2 4.5 1.6 -vd 0 -1 0 -vu 0 0 1 -vh 70 -vv 55"
_BOUNDARY = "torture"
_WAITING = 30  # jobs, when no more are submitted

FIRST_SCENE = (_ROOM.format(wall=0.5, pane=_GLASS) + _SKY).encode()


def upload_scene(client, text):
    """A scene of one file."""
    return client.request("POST", "/v1/scenes", _multipart([("file", "scene.rad", text)]), {
        "Content-Type": "multipart/form-data; boundary=" + _BOUNDARY})


def _multipart(files):
    parts = []
    for field, name, data in files:
        parts.append(("--%s\r\nContent-Disposition: form-data; name=\"%s\"; filename=\"%s\"\r\n"
                      "\r\n" % (_BOUNDARY, field, name)).encode() + data + b"\r\n")
    return b"".join(parts) + ("--%s--\r\n" % _BOUNDARY).encode()


class Loader(threading.Thread):
    """One client. `fixture` is a BSDF file's text, of which variants are sent."""

    def __init__(self, daemon, ledger, random, fixture):
        super().__init__(daemon=True)
        self.client = daemon.client("client-%d" % random.randrange(3))
        self.ledger, self.random, self.fixture = ledger, random, fixture
        self.stopping = threading.Event()
        self.failure = None

    def run(self):
        acts = ((self._upload_scene, 2), (self._upload_bsdf, 1), (self._submit, 8),
                (self._poll, 12), (self._cancel, 0.5), (self._fetch, 6), (self._remove_job, 1),
                (self._remove_upload, 2), (self._remove_map, 1), (self._look_around, 1))
        doers, weights = zip(*acts)
        try:
            while not self.stopping.is_set():
                self.random.choices(doers, weights)[0]()
        except Gone:
            pass
        except Exception as error:  # pylint: disable=broad-except
            self.failure = error
        finally:
            self.client.close()

    def _pick(self, items):
        """One of the newest, mostly."""
        with self.ledger.lock:
            items = list(items)
        if not items:
            return None
        return self.random.choice(items[-10:] if self.random.random() < 0.7 else items)

    def _expect(self, answer, statuses, what):
        if answer.status not in statuses:
            raise Failure("%s: %s" % (what, answer.problem()))
        self.ledger.count("%s %d" % (what, answer.status))
        return answer.status

    # ---- Uploads -----------------------------------------------------------------------------

    def _upload_scene(self):
        wall = 0.3 + 0.001 * self.random.randrange(500)
        of_years, with_bsdf = (self.random.random() < share for share in (0.2, 0.25))
        room = _ROOM.format(wall=wall, pane=_BSDF if with_bsdf else _GLASS).encode()
        if self.random.random() < 0.03:
            room += b"# more than is held in memory\n" * 50000
        files = [("file", "room.rad", room), ("resource", "w.wea", _WEATHER.encode()) if of_years
                 else ("file", "sky.rad", _SKY.encode())]
        if with_bsdf:
            files.append(("file", "pane.xml", self._bsdf()))
        answer = self.client.request("POST", "/v1/scenes", _multipart(files), {
            "Content-Type": "multipart/form-data; boundary=" + _BOUNDARY})
        if self._expect(answer, (200, 201, 507), "scene") != 507:
            with self.ledger.lock:
                self.ledger.scenes.setdefault(answer.json()["id"], False)
                if of_years:
                    self.ledger.year_scenes.add(answer.json()["id"])

    def _bsdf(self):
        thickness = "%.3f" % (1 + 0.001 * self.random.randrange(2000))
        return self.fixture.replace("12.5", thickness, 1).encode()

    def _upload_bsdf(self):
        data = self._bsdf()
        answer = self.client.request("POST", "/v1/bsdfs", data, {"Content-Type": "application/xml"})
        if self._expect(answer, (200, 201, 507), "bsdf") == 507:
            return
        if answer.json()["id"] != hashlib.sha256(data).hexdigest():
            raise Failure("a BSDF's id is not its hash")
        with self.ledger.lock:
            self.ledger.bsdfs.setdefault(answer.json()["id"], False)

    # ---- Jobs --------------------------------------------------------------------------------

    def _year(self, scene):
        sensors = [[0.5 + x, 1 + y, 0.8, 0, 0, 1] for x in range(4) for y in range(4)]
        return {"kind": "annual", "scene": scene, "weather": "w.wea", "metrics": ["DA300"],
                "seed": self.random.randrange(3), "samples": self.random.choice((16, 256)),
                "sensors": sensors * self.random.choice((1, 10)), "formats": ["honeybee"]}

    def _document(self, scene):
        random = self.random
        if scene in self.ledger.year_scenes:
            return self._year(scene)
        document = {"kind": "render", "scene": scene, "seed": random.randrange(3),
                    "sensors": [[2, 1, 0.8, 0, 0, 1], [2, 4, 0.8, 0, 0, 1]]}
        if random.random() < 0.05:
            document["accuracy"] = {"relative_error": 0.2}
        else:
            document["technique"] = random.choice(("gather", "direct", "precomputed"))
            photons = random.choice((1000, 4000, 16000))
            document["photons"] = {"global": photons, "caustic": photons // 2}
            document["gather_samples"] = 64
            document["views"] = [{"name": "view-%d" % i, "view": _VIEW, "width": 24, "height": 16}
                                 for i in range(random.randrange(4))]
        return document

    def _submit(self):
        with self.ledger.lock:
            waiting = sum(job.state not in ENDED for job in self.ledger.jobs.values())
        if waiting > _WAITING:
            return
        with self.ledger.lock:
            scenes = [scene for scene, leaving in self.ledger.scenes.items() if not leaving]
        scene = self._pick(scenes)
        if scene is None:
            self._upload_scene()
            return
        document = self._document(scene)
        identity = json.dumps(document, sort_keys=True)
        key = None
        if self.random.random() < 0.5:
            key = "%032x" % self.random.getrandbits(128)
        headers = {"Idempotency-Key": key} if key else {}
        for _ in range(2 if key else 1):  # a key's second request is the same job
            document["priority"] = 0
            answer = self.client.post_json("/v1/jobs", document, headers)
            expected = (202, 429, 507) + ((404, 422) if self.ledger.scenes[scene] else ())
            if self._expect(answer, expected, "submit") == 202:
                self.ledger.add_job(answer.json()["id"], identity, key)

    def _poll(self):
        job_id = self._pick(self.ledger.jobs)
        if job_id is None:
            return
        answer = self.client.request("GET", "/v1/jobs/" + job_id)
        if self._expect(answer, self._or_gone(job_id, 200), "poll") == 404:
            return
        # Two clients may be told in one order and note it in another; only ends are for ever.
        document = answer.json()
        if document["state"] in ENDED:
            self.ledger.see_state(job_id, document["state"], document.get("error"))

    def _cancel(self):
        job_id = self._pick(self.ledger.jobs)
        if job_id is None:
            return
        with self.ledger.lock:
            self.ledger.jobs[job_id].asked_to_cancel = True
        answer = self.client.request("POST", "/v1/jobs/%s/cancel" % job_id, b"")
        if self._expect(answer, self._or_gone(job_id, 200, 202, 409), "cancel") < 300:
            with self.ledger.lock:
                self.ledger.jobs[job_id].cancelled = True

    def _fetch(self):
        with self.ledger.lock:
            done = [job for job, told in self.ledger.jobs.items() if told.state == "succeeded"]
        job_id = self._pick(done)
        if job_id is not None:
            fetch_results(self.client, self.ledger, job_id)

    # ---- Removal -----------------------------------------------------------------------------

    def _or_gone(self, job_id, *statuses):
        with self.ledger.lock:
            return statuses + ((404,) if self.ledger.jobs[job_id].asked_to_remove else ())

    def _remove_job(self):
        """Mostly of one that has ended; of others this is a cancellation."""
        with self.ledger.lock:
            jobs = [job for job, told in self.ledger.jobs.items()
                    if told.state in ENDED or self.random.random() < 0.05]
        job_id = self._pick(jobs)
        if job_id is None:
            return
        job = self.ledger.jobs[job_id]
        with self.ledger.lock:
            job.asked_to_remove = job.asked_to_cancel = True
        answer = self.client.request("DELETE", "/v1/jobs/" + job_id)
        status = self._expect(answer, (200, 202, 204, 404, 409), "remove job")
        with self.ledger.lock:
            job.removed = job.removed or status == 204
            job.cancelled = job.cancelled or status in (200, 202)

    def _remove_upload(self):
        kind, items = self.random.choice((("scenes", self.ledger.scenes),
                                          ("bsdfs", self.ledger.bsdfs)))
        item = self._pick(items)
        if item is None:
            return
        with self.ledger.lock:
            items[item] = True
        answer = self.client.request("DELETE", "/v1/%s/%s" % (kind, item))
        self._expect(answer, (204, 404, 409), "remove " + kind)

    def _remove_map(self):
        maps = self.client.request("GET", "/v1/maps").json()["maps"]
        if maps:
            chosen = self.random.choice(maps)
            answer = self.client.request("DELETE", "/v1/maps/%s/%s" % (chosen["kind"],
                                                                      chosen["key"]))
            self._expect(answer, (204, 404, 409), "remove map")

    def _look_around(self):
        for path in ("/v1/jobs?limit=50", "/v1/maps", "/metrics", "/readyz"):
            answer = self.client.request("GET", path)
            self._expect(answer, (200, 503), "look around")


def fetch_results(client, ledger, job_id):
    """All files of a job that has succeeded, unless it was removed or its results were evicted."""
    job = ledger.jobs[job_id]
    answer = client.request("GET", "/v1/jobs/" + job_id)
    if answer.status == 404 and job.asked_to_remove:
        return
    for entry in answer.json().get("files", ()):
        answer = client.request("GET", "/v1/jobs/%s/files/%s"
                                % (job_id, urllib.parse.quote(entry["name"], safe="")))
        if answer.status == 410 or answer.status == 404 and job.asked_to_remove:
            ledger.count("results gone")
            return
        if answer.status != 200:
            raise Failure("file %s of job %s: %s" % (entry["name"], job_id, answer.problem()))
        if len(answer.body) != entry["bytes"]:
            raise Failure("file %s of job %s has another length" % (entry["name"], job_id))
        if entry["name"].endswith(".json"):
            json.loads(answer.body.decode())
        ledger.see_file(job_id, entry["name"], answer.body)
    ledger.count("results fetched")
