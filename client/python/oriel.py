"""Oriel from Python: daylight renderings by a daemon, for design tools.

One file for Python 3.8 or later, without dependencies: copy it beside your script, in Rhino, Blender,
QGIS or elsewhere. It stays one file, so that it is easy to copy. A whole job in ten lines:

    import oriel

    client = oriel.Client("http://127.0.0.1:8423")            # or $ORIEL_URL; token="oriel_..."
    scene = client.upload_scene(["materials.rad", "room.rad", "sky.rad"])
    job = client.submit({"kind": "render", "scene": scene,
                         "sensors": [[2, 1, 0.8, 0, 0, 1], [2, 4, 0.8, 0, 0, 1]]})
    job.wait(progress=lambda status: print(status["stage"], status["percent"]))
    result = job.result()
    print([sensor["illuminance_lx"] for sensor in result["sensors"]])
    job.fetch("out")                                           # images and result.json

Client.render does all of this with a job document, as the oriel command takes it. The daemon's
/openapi.yaml describes job documents.

All errors are OrielErrors: Problem if the daemon refuses a request (with title, detail, hint, file
and line), Unreachable if it does not answer, JobFailed and JobCancelled if a job ends that way. Files
that the daemon already has are not sent again. A submission that is repeated after a broken
connection creates no second job.

Several threads may share a Client: it keeps no connection.
"""

import contextlib
import hashlib
import http.client
import ipaddress
import json
import os
import ssl
import time
import urllib.parse
import uuid

__all__ = ["Client", "Job", "OrielError", "Problem", "Unauthorized", "Forbidden", "NotFound",
           "InUse", "Gone", "Busy", "Full", "Unreachable", "JobFailed", "JobCancelled"]

_CHUNK = 1 << 16
_ENDED = ("succeeded", "failed", "cancelled")


# ---- Errors -------------------------------------------------------------------------------------

class OrielError(Exception):
    """Base class of all errors of this module."""


class Unreachable(OrielError):
    """No daemon answers at the URL, or the connection broke."""


class Problem(OrielError):
    """The daemon refused a request, or a job failed: a problem document (RFC 9457).

    status, type, title, detail, hint, file, line, primitive: members of the document, or None.
    """

    def __init__(self, document, status=None):
        self.document = document
        self.status = document.get("status", status)
        for member in ("type", "title", "detail", "hint", "file", "line", "primitive"):
            setattr(self, member, document.get(member))
        super().__init__(self._sentence())

    def _sentence(self):
        place = ":".join(str(part) for part in (self.file, self.line) if part)
        what = self.detail or self.title
        # The detail of an error in a document already begins with the place: do not repeat it.
        where = None if what and what.startswith("%s:" % self.primitive) else self.primitive
        text = ": ".join(part for part in (place, where, what) if part)
        return "%s (%s)" % (text, self.hint) if self.hint else text


class Unauthorized(Problem):
    """401: the daemon requires an access token, or does not know the given one."""


class Forbidden(Problem):
    """403: the token's scope does not allow this."""


class NotFound(Problem):
    """404: the scene, job or file does not exist."""


class InUse(Problem):
    """409: not possible in this state; for example, the item is used by jobs and cannot be removed."""


class Gone(Problem):
    """410: the results were removed to make room. Submit the document again to get them back."""


class Full(Problem):
    """507: the daemon has no space left, and nothing that it may remove."""


class Busy(Problem):
    """429 or 503: the daemon is busy; retry later. retry_after is in seconds, or None."""

    retry_after = None


class JobFailed(Problem):
    """The job failed; the problem has the reason."""


class JobCancelled(OrielError):
    """The job was cancelled."""


_PROBLEMS = {401: Unauthorized, 403: Forbidden, 404: NotFound, 409: InUse, 410: Gone, 429: Busy,
             503: Busy, 507: Full}


def _problem(status, headers, body):
    try:
        document = json.loads(body.decode("utf-8"))
    except ValueError:
        document = None
    if not isinstance(document, dict):
        document = {"title": "The daemon answered with status %d" % status}
    error = _PROBLEMS.get(status, Problem)(document, status)
    if isinstance(error, Busy):
        after = headers.get("Retry-After", "")
        error.retry_after = int(after) if after.isdigit() else None
    return error


# ---- Files --------------------------------------------------------------------------------------

def _open(path, mode="rb", **how):
    try:
        return open(path, mode, **how)
    except OSError as error:
        raise OrielError("cannot open %s: %s" % (path, error.strerror)) from error


def _make_folder(path):
    try:
        os.makedirs(path or ".", exist_ok=True)
    except OSError as error:
        raise OrielError("cannot make %s: %s" % (path, error.strerror)) from error


class _File:
    """A file to send: its name in the scene, path, size and SHA-256."""

    def __init__(self, folder, name):
        self.name = name.replace(os.sep, "/")
        self.path = os.path.join(folder, name)
        digest = hashlib.sha256()
        self.size = 0
        for chunk in self.chunks():
            digest.update(chunk)
            self.size += len(chunk)
        self.sha = digest.hexdigest()

    def chunks(self):
        try:
            with open(self.path, "rb") as stream:
                yield from iter(lambda: stream.read(_CHUNK), b"")
        except OSError as error:
            raise OrielError("cannot read %s: %s" % (self.path, error.strerror)) from error


class _Known:
    """A BSDF that the daemon stores, with its file name in the scene."""

    def __init__(self, name, sha):
        self.name, self.sha = name, sha


def _is_xml(name):
    return name.endswith(".xml")


def _mentioned(folder, names):
    """Returns files below folder that scene files mention as words, and files that these mention."""
    found, left = [], list(names)
    while left:
        name = left.pop()
        if _is_xml(name):
            continue
        with _open(os.path.join(folder, name), "r", errors="replace") as stream:
            words = {word.strip("'\"") for line in stream for word in line.split("#")[0].split()}
        for word in sorted(words - set(names) - set(found)):
            if ("." in word and not os.path.isabs(word) and ".." not in word.split("/")
                    and os.path.isfile(os.path.join(folder, word))):
                found.append(word)
                left.append(word)
    return found


def _weather_files(document):
    """Returns the weather files of a job document's skies."""
    skies = document.get("skies") or []
    skies = [document.get("sky") or {}] + (skies if isinstance(skies, list) else [skies])
    files = ((sky.get("weather") or {}).get("file") for sky in skies)
    return list(dict.fromkeys(name for name in files if name))


def _year_files(document):
    """Returns the files that a year's document names in addition to its scene."""
    grids = document.get("grids") or [{"sensors": document.get("sensors")}]
    sensors = (grid.get("sensors") for grid in grids)
    files = [document.get("weather"), (document.get("occupancy") or {}).get("file")]
    files += [one.get("file") for one in sensors if isinstance(one, dict)]
    return list(dict.fromkeys(name for name in files if name))


def _view_files(document):
    """Returns the view files and glare masks of a job document."""
    views = document.get("views") or []
    files = [view.get("file") for view in views] + [(view.get("glare") or {}).get("mask") for view in views]
    return list(dict.fromkeys(name for name in files if name))


def _scene_id(mains, resources):
    """Computes the scene's id as the daemon does (POST /v1/scenes)."""
    text = "oriel-scene 1\n"
    for file in mains:
        text += "main %s %s\n" % (file.sha, file.name)
    for file in sorted(resources, key=lambda one: one.name.encode()):
        text += "resource %s %s\n" % (file.sha, file.name)
    return hashlib.sha256(text.encode()).hexdigest()


@contextlib.contextmanager
def _writing(path):
    """Gives a function that writes to the file. Its errors are distinct from network errors."""
    def write(chunk):
        try:
            stream.write(chunk)
        except OSError as error:
            raise OrielError("cannot write %s: %s" % (path, error.strerror)) from error

    with _open(path, "wb") as stream:
        yield write


class _Form:
    """multipart/form-data, streamed from disk."""

    def __init__(self):
        self.boundary = uuid.uuid4().hex
        self.parts = []  # (head, file or bytes)

    def add_file(self, field, file):
        if any(c in '"\\' or ord(c) < 32 for c in file.name):
            raise OrielError("a file named %r cannot be sent: rename it" % file.name)
        self._add('name="%s"; filename="%s"' % (field, file.name), file)

    def add_text(self, field, text):
        self._add('name="%s"' % field, text.encode())

    def _add(self, disposition, content):
        head = "--%s\r\nContent-Disposition: form-data; %s\r\n\r\n" % (self.boundary, disposition)
        self.parts.append((head.encode(), content))

    def _end(self):
        return ("--%s--\r\n" % self.boundary).encode()

    def size(self):
        sizes = (len(head) + 2 + (content.size if isinstance(content, _File) else len(content))
                 for head, content in self.parts)
        return sum(sizes) + len(self._end())

    def chunks(self):
        for head, content in self.parts:
            yield head
            if isinstance(content, _File):
                yield from content.chunks()
            else:
                yield content
            yield b"\r\n"
        yield self._end()


def _is_loopback(host):
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


# ---- The daemon ---------------------------------------------------------------------------------

class Client:
    """A daemon at a URL.

    url: default $ORIEL_URL, or http://127.0.0.1:8423.
    token: default $ORIEL_TOKEN; sent over plain HTTP only to this machine.
    ca_file: certificates in PEM to trust in addition to the system's; default $ORIEL_CA.
    name: identifies the client in the daemon's queue if it requires no token; default $ORIEL_CLIENT.
    timeout: seconds without data after which a request fails.
    """

    def __init__(self, url=None, token=None, ca_file=None, name=None, timeout=60.0):
        self.url = (url or os.environ.get("ORIEL_URL") or "http://127.0.0.1:8423").rstrip("/")
        parts = urllib.parse.urlsplit(self.url)
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise OrielError("%r is not an http:// or https:// URL" % self.url)
        self._https, self._host, self._port = parts.scheme == "https", parts.hostname, parts.port
        self._base, self._timeout = parts.path, timeout
        self._headers = {"User-Agent": "oriel-python"}
        token = token or os.environ.get("ORIEL_TOKEN")
        if token and not self._https and not _is_loopback(self._host):
            raise OrielError("a token sent over plain HTTP could be intercepted: use https://")
        if token:
            self._headers["Authorization"] = "Bearer " + token
        name = name or os.environ.get("ORIEL_CLIENT")
        if name:
            self._headers["X-Oriel-Client"] = name
        ca_file = ca_file or os.environ.get("ORIEL_CA")
        self._context = ssl.create_default_context() if self._https else None
        if self._https and ca_file:
            self._context.load_verify_locations(ca_file)

    # -- Requests ---------------------------------------------------------------------------------

    def _connect(self):
        if self._https:
            return http.client.HTTPSConnection(self._host, self._port, timeout=self._timeout,
                                               context=self._context)
        return http.client.HTTPConnection(self._host, self._port, timeout=self._timeout)

    def _send(self, method, path, body=None, headers=None, sink=None):
        """Sends a request. Returns (status, headers, body). sink(reply), if given, reads the body of a 200."""
        connection = self._connect()
        try:
            try:
                connection.request(method, self._base + path, body=body,
                                   headers=dict(self._headers, **(headers or {})))
            except (BrokenPipeError, ConnectionResetError):
                pass  # refused before the whole body was sent: the response, if any, has the reason
            reply = connection.getresponse()
            content = sink(reply) if sink and reply.status == 200 else reply.read()
            return reply.status, reply.headers, content
        except ssl.SSLCertVerificationError as error:
            raise Unreachable("the certificate of %s is not trusted: %s" % (self.url, error)) from error
        except (OSError, http.client.HTTPException) as error:
            raise Unreachable("no answer from %s: %s" % (self.url, error)) from error
        finally:
            connection.close()

    def _json(self, method, path, body=None, headers=None):
        status, reply_headers, content = self._send(method, path, body, headers)
        if status // 100 != 2:
            raise _problem(status, reply_headers, content)
        return json.loads(content.decode("utf-8"))

    def _pages(self, path, member, limit):
        """Returns the first items of a list, which may have several pages."""
        found = []
        while path and len(found) < limit:
            status, headers, content = self._send("GET", path)
            if status != 200:
                raise _problem(status, headers, content)
            found += json.loads(content.decode("utf-8"))[member]
            link = headers.get("Link", "")
            path = link[1:link.index(">")] if 'rel="next"' in link else None
        return found[:limit]

    def _remove(self, *path):
        where = "/v1/" + "/".join(urllib.parse.quote(part, safe="") for part in path)
        status, headers, content = self._send("DELETE", where)
        if status // 100 != 2:
            raise _problem(status, headers, content)

    def _has(self, path):
        status, headers, body = self._send("HEAD", path)
        if status in (200, 404):
            return status == 200
        if not body:  # the response to a HEAD has no body: request the reason
            status, headers, body = self._send("GET", path)
        raise _problem(status, headers, body)

    # -- Uploads ----------------------------------------------------------------------------------

    def upload_bsdf(self, path, name=None):
        """Uploads a BSDF (WINDOW XML) unless the daemon has it. Returns its id."""
        file = _File("", path)
        if not self._has("/v1/bsdfs/" + file.sha):
            query = urllib.parse.urlencode({"name": name or os.path.basename(path)})
            self._json("POST", "/v1/bsdfs?" + query, file.chunks(),
                       {"Content-Type": "application/xml", "Content-Length": str(file.size)})
        return file.sha

    def upload_scene(self, files, resources=None, folder=None, bsdfs=None):
        """Uploads a scene unless the daemon has it. Returns its id.

        files: Radiance files, in order.
        resources: files that these refer to (BSDFs, files of !xform, function files, weather), or
        None: every file below folder that they mention. Names are relative to folder (default: the
        current folder), and are the names in the scene.
        bsdfs: {name: id} of BSDFs that the daemon has, such as results of "bsdf_make" and "bsdf_fit".
        Files of goniophotometer measurements are uploaded in the same way.
        """
        folder = folder or ""
        if resources is None:
            resources = _mentioned(folder, files)
        extra = [name for name in files if _is_xml(name)] + list(resources)
        mains = [_File(folder, name) for name in files if not _is_xml(name)]
        known = [_Known(name, id) for name, id in (bsdfs or {}).items()]
        others = [_File(folder, name) for name in dict.fromkeys(extra) if name not in (bsdfs or {})] + known
        scene = _scene_id(mains, others)
        if not self._has("/v1/scenes/" + scene):
            scene = self._post_scene(mains, others)
        return scene

    def upload_zip(self, path, files=None):
        """Uploads a zip of a scene's folder, which the daemon unpacks. Returns the scene's id.

        files: the main Radiance files, in order, with their names in the folder; or None: the
        top-level files that no command of another file names, sorted by name.
        """
        query = urllib.parse.urlencode([("main", name) for name in files or ()])
        file = _File("", path)
        return self._json("POST", "/v1/scenes" + ("?" + query if query else ""), file.chunks(),
                          {"Content-Type": "application/zip", "Content-Length": str(file.size)})["id"]

    def _post_scene(self, mains, others):
        form, known = _Form(), {}
        for file in mains:
            form.add_file("file", file)
        for file in others:
            if isinstance(file, _Known) or (_is_xml(file.name) and self._has("/v1/bsdfs/" + file.sha)):
                known[file.name] = file.sha
            else:
                form.add_file("resource", file)
        if known:
            form.add_text("bsdfs", json.dumps(known))
        headers = {"Content-Type": "multipart/form-data; boundary=" + form.boundary,
                   "Content-Length": str(form.size())}
        return self._json("POST", "/v1/scenes", form.chunks(), headers)["id"]

    # -- Jobs -------------------------------------------------------------------------------------

    def submit(self, document, name=None, tags=None):
        """Submits a job of any kind; its scene is given by id. Returns a Job.

        name, tags: name of the job, and list of tags to find it by (see jobs); they replace those of
        the document.
        After a broken connection it tries again. The daemon recognises the submission by its key.
        """
        labels = {"name": name, "tags": list(tags) if tags else None}
        document = dict(document, **{key: one for key, one in labels.items() if one})
        body = json.dumps(document).encode()
        headers = {"Content-Type": "application/json", "Idempotency-Key": uuid.uuid4().hex}
        for attempt in range(3):
            try:
                return Job(self, self._json("POST", "/v1/jobs", body, headers)["id"])
            except Unreachable:
                if attempt == 2:
                    raise
                time.sleep(0.5)

    def plan(self, document):
        """Returns which effects a render job would simulate, and why, without rendering it.

        The scene is given by id. Returns a list of {"sky", "plan", "warnings"}: one item, or for a
        job with several skies one for each of the first skies.
        """
        return self._json("POST", "/v1/plans", json.dumps(document).encode(),
                          {"Content-Type": "application/json"})["plans"]

    def job(self, id):
        """Returns an earlier job by its id, or by enough first digits to be unique."""
        return Job(self, id)

    def jobs(self, state=None, limit=100, scene=None, tags=(), since=None, summary=False):
        """Returns the latest jobs' documents, newest first, from as many pages as needed.

        tags: only jobs that have all of them. since: only jobs submitted at that time or later, in UTC
        such as "2024-03-22T11:30:00Z". summary: short documents without files, maps and links.
        """
        query = [("limit", min(limit, 1000))] + [("tag", tag) for tag in tags]
        query += [(key, one) for key, one in (("state", state), ("scene", scene), ("since", since),
                                              ("fields", "summary" if summary else None)) if one]
        return self._pages("/v1/jobs?" + urllib.parse.urlencode(query), "jobs", limit)

    def events(self, jobs=(), tags=(), last_id=None):
        """Iterates over events of jobs from now on, as tuples (kind, data, id).

        kind "job": data is the job's summary, as from jobs(summary=True). "removed": data has the id.
        "reset": earlier events are lost, so request lists again. jobs, tags: only these jobs. last_id:
        continue after this event. Raises Unreachable when the connection ends.
        """
        query = urllib.parse.urlencode([("job", one) for one in jobs] + [("tag", one) for one in tags])
        headers = dict(self._headers, **({"Last-Event-ID": last_id} if last_id else {}))
        connection = self._connect()
        try:
            connection.request("GET", self._base + "/v1/events" + ("?" + query if query else ""),
                               headers=headers)
            reply = connection.getresponse()
            if reply.status != 200:
                raise _problem(reply.status, reply.headers, reply.read())
            event = {}
            for line in iter(reply.readline, b""):
                name, _, value = line.decode("utf-8").rstrip("\n").partition(": ")
                if name in ("id", "event", "data"):
                    event[name] = value
                elif not name and event:
                    yield event["event"], json.loads(event["data"]), event["id"]
                    event = {}
        except (OSError, http.client.HTTPException) as error:
            raise Unreachable("no answer from %s: %s" % (self.url, error)) from error
        finally:
            connection.close()
        raise Unreachable("the daemon ended the stream of events")

    def scenes(self, limit=100):
        """Returns the stored scenes, latest first, with bytes, last_used, jobs and jobs_under_way."""
        return self._pages("/v1/scenes?limit=%d" % min(limit, 1000), "scenes", limit)

    def bsdfs(self, limit=100):
        """Returns the BSDFs that were uploaded alone, latest first, with the number of scenes that use them."""
        return self._pages("/v1/bsdfs?limit=%d" % min(limit, 1000), "bsdfs", limit)

    def maps(self):
        """Returns the photon maps and loaded BSDFs that the daemon stores for later jobs."""
        return self._json("GET", "/v1/maps")["maps"]

    def remove_scene(self, id):
        """Removes a scene. Raises InUse while a waiting or running job needs it. Finished jobs stay."""
        self._remove("scenes", id)

    def remove_bsdf(self, id):
        """Removes a BSDF. Raises InUse while a scene contains it."""
        self._remove("bsdfs", id)

    def remove_map(self, kind, key):
        """Removes an item of maps(). Raises InUse while a job uses it. Later jobs build it again."""
        self._remove("maps", kind, key)

    def limits(self):
        """Returns the daemon's limits by name."""
        return self._json("GET", "/v1/limits")

    def health(self):
        """Returns the daemon's version and uptime_s. Raises Unreachable if it does not answer."""
        return self._json("GET", "/healthz")

    def render(self, document, output=None, folder=None, progress=None):
        """Runs a document of any kind, like `oriel submit --wait` followed by `oriel fetch`.

        The kinds are render (the default), "study", "annual" (a year of daylight), "bsdf_make" (the
        BSDF of a panel) and "bsdf_fit" (a BSDF from measurements). The id of a BSDF is
        ["bsdf"]["id"] of the result.
        document: a dict, or the path of a JSON file. Its "scene" (or "measurements") has "files", and
        its sensors can be a file. Names are relative to folder; by default to the JSON file's folder,
        or to the current folder.
        Uploads, submits, waits (see Job.wait), and downloads all files into the folder output unless
        it is None. Returns the result.
        """
        if not isinstance(document, dict):
            folder = folder or os.path.dirname(document)
            with _open(document) as stream:
                document = json.load(stream)
        job = self.submit(self._prepared(document, folder or ""))
        job.wait(progress)
        if output is not None:
            job.fetch(output)
        return job.result()

    def _prepared(self, document, folder):
        """Uploads the document's scene and reads its sensors (except for years). Returns the new document."""
        document, year = dict(document), document.get("kind") == "annual"
        scene, sensors = document.get("scene"), document.get("sensors")
        measured = document.get("measurements")
        if isinstance(measured, dict) and "files" in measured:
            document["measurements"] = self.upload_scene(measured["files"], [], folder)
        if isinstance(scene, dict) and "files" in scene:
            names = _mentioned(folder, scene["files"])
            named = (_year_files(document) if year
                     else _weather_files(document) + _view_files(document))
            names += [name for name in named if name not in names]
            document["scene"] = self.upload_scene(scene["files"], names, folder)
        if isinstance(sensors, dict) and "file" in sensors and not year:
            with _open(os.path.join(folder, sensors["file"]), "r") as stream:
                rows = (line.split("#")[0].split() for line in stream)
                document["sensors"] = [[float(number) for number in row] for row in rows if row]
        return document


class Job:
    """A job of a daemon, identified by its id."""

    def __init__(self, client, id):
        self.client, self.id = client, id
        self._path = "/v1/jobs/" + urllib.parse.quote(id, safe="")

    def status(self):
        """Returns the job's document: state, stage, percent, eta_s and other members (/openapi.yaml)."""
        return self.client._json("GET", self._path)

    def cancel(self):
        """Starts to cancel the job. Raises a Problem (409) if it has ended."""
        return self.client._json("POST", self._path + "/cancel", b"")

    def remove(self):
        """Removes the job and its results. Raises InUse if it has not ended."""
        self.client._remove("jobs", self.id)

    def wait(self, progress=None, timeout=None, poll=0.5, patience=60.0):
        """Waits until the job has succeeded. Returns its last document.

        progress(status) is called whenever the document changes; if it returns False, the job is
        cancelled. timeout: seconds until TimeoutError; the job continues. patience: seconds to wait
        for a daemon that does not answer, for example during a restart; jobs survive a restart.
        Raises JobFailed or JobCancelled.
        """
        until = None if timeout is None else time.monotonic() + timeout
        last, answered = None, time.monotonic()
        while True:
            try:
                status = self.status()
                answered = time.monotonic()
            except (Unreachable, Busy):
                if time.monotonic() - answered > patience:
                    raise
                status = last
            if status != last:
                last = status
                if progress and progress(status) is False and status["state"] not in _ENDED:
                    self.cancel()
            if status and status["state"] in _ENDED:
                return self._ended(status)
            if until is not None and time.monotonic() > until:
                raise TimeoutError("job %s did not end within %g s" % (self.id, timeout))
            time.sleep(poll)

    def _ended(self, status):
        if status["state"] == "failed":
            raise JobFailed(status.get("error") or {"title": "the job failed"})
        if status["state"] == "cancelled":
            raise JobCancelled("job %s was cancelled" % self.id)
        return status

    def result(self):
        """Returns result.json as a dict; for a running job with a goal, the intermediate result."""
        return self.client._json("GET", self._path + "/result")

    def links(self, files, seconds=300):
        """Returns URLs of result files that need no token, for example for the <img> of a page.

        Returns {name: url}. Anyone who has a URL can read that file until it expires.
        """
        body = json.dumps({"files": list(files), "seconds": seconds}).encode()
        links = self.client._json("POST", self._path + "/links", body,
                                  {"Content-Type": "application/json"})["links"]
        return {link["file"]: self.client.url + link["url"] for link in links}

    def fetch(self, folder):
        """Downloads all result files into folder; no partial files remain. Returns their paths."""
        _make_folder(folder)
        return [self._fetch_file(folder, file["name"]) for file in self.status().get("files", [])]

    def _fetch_file(self, folder, name):
        parts = name.split("/")
        if any(os.path.basename(part) != part or part.startswith(".") or not part for part in parts):
            raise OrielError("the daemon lists a file outside the output folder: %r" % name)
        path = os.path.join(folder, *parts)
        _make_folder(os.path.dirname(path))
        part = path + ".part"

        def keep(reply):
            length, size = reply.headers.get("Content-Length"), 0
            with _writing(part) as write:
                for chunk in iter(lambda: reply.read(_CHUNK), b""):
                    write(chunk)
                    size += len(chunk)
            if length is not None and size != int(length):
                raise http.client.IncompleteRead(b"", int(length) - size)
            return b""

        status, headers, body = self.client._send(
            "GET", self._path + "/files/" + urllib.parse.quote(name, safe=""), sink=keep)
        if status != 200:
            raise _problem(status, headers, body)
        os.replace(part, path)
        return path
