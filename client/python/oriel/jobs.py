"""A job of a daemon: its state, waiting for its end, and its files."""

import contextlib
import http.client
import json
import os
import time
import urllib.parse
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, Iterator, List, Optional, Sequence, Tuple

from .errors import Busy, JobCancelled, JobFailed, Json, OrielError, Unreachable, problem_of
from .events import Watcher, stream
from .files import CHUNK, StrPath, make_folder, writing
from .results import Result
from .transport import Transport

ENDED = ("succeeded", "failed", "cancelled")

Progress = Callable[[Dict[str, Any]], Optional[bool]]


class Job:
    """A job of a daemon, identified by its id."""

    def __init__(self, transport: Transport, id: str, client: Any = None) -> None:
        self.id, self.client, self._transport = id, client, transport
        self._path = "/v1/jobs/" + urllib.parse.quote(id, safe="")

    def __repr__(self) -> str:
        return "Job(%r)" % self.id

    def status(self) -> Dict[str, Json]:
        """Returns the job's state: state, stage, percent, eta_s and other members (/openapi.yaml)."""
        return dict(self._transport.json("GET", self._path))

    def document(self) -> Dict[str, Json]:
        """Returns the document that was submitted."""
        return dict(self._transport.json("GET", self._path + "/document"))

    def cancel(self) -> Dict[str, Json]:
        """Starts to cancel the job. Raises a Problem (409) if it has ended."""
        return dict(self._transport.json("POST", self._path + "/cancel", b""))

    def remove(self) -> None:
        """Removes the job and its results. Raises InUse if it has not ended."""
        self._transport.remove("jobs", self.id)

    # ---- Waiting ---------------------------------------------------------------------------------

    def events(self) -> Iterator[Dict[str, Any]]:
        """Yields the job's state whenever it changes: id, state, stage, percent, eta_s. Ends with the job."""
        for _, state, _ in stream(self._transport, self._path + "/events"):
            yield state

    def wait(self, progress: Optional[Progress] = None, timeout: Optional[float] = None, poll: float = 0.5,
             patience: float = 60.0, cancel_on_interrupt: bool = False) -> Dict[str, Json]:
        """Waits until the job has succeeded. Returns its last state.

        progress(status) is called whenever the state changes; if it returns False, the job is
        cancelled. timeout: seconds until TimeoutError; the job continues. The daemon's events end
        the wait at once; without them the state is asked for every `poll` seconds. patience: seconds
        to wait for a daemon that does not answer, for example during a restart; jobs survive one.
        cancel_on_interrupt: Ctrl-C cancels the job, too.
        Raises JobFailed or JobCancelled.
        """
        until = None if timeout is None else time.monotonic() + timeout
        watcher = Watcher(self._transport, self._path + "/events", poll)
        try:
            return self._follow(watcher, progress, until, patience)
        except KeyboardInterrupt:
            if cancel_on_interrupt:
                with contextlib.suppress(OrielError):
                    self.cancel()
            raise
        finally:
            watcher.close()

    def _follow(self, watcher: Watcher, progress: Optional[Progress], until: Optional[float],
                patience: float) -> Dict[str, Json]:
        last: Dict[str, Json] = {}
        answered = time.monotonic()
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
                if progress and progress(status) is False and status["state"] not in ENDED:
                    self.cancel()
            if status.get("state") in ENDED:
                return self._end(status)
            left = None if until is None else until - time.monotonic()
            if left is not None and left <= 0:
                raise TimeoutError("job %s is not ready yet; it continues" % self.id)
            watcher.wait(left)

    def _end(self, status: Dict[str, Json]) -> Dict[str, Json]:
        if status["state"] == "failed":
            raise JobFailed(status.get("error") or {"title": "the job failed"})
        if status["state"] == "cancelled":
            raise JobCancelled("job %s was cancelled" % self.id)
        return status

    # ---- Results ---------------------------------------------------------------------------------

    def result(self) -> Result:
        """Returns the result; for a running job with a goal, the intermediate result."""
        return Result(self._transport.json("GET", self._path + "/result"), self.read, self._grid_sensors)

    def _grid_sensors(self) -> Dict[str, List[List[Optional[float]]]]:
        """Returns positions and directions of the sensors that the document has, by grid."""
        document = self.document()
        grids = document.get("grids") or [{"name": "sensors", "sensors": document.get("sensors")}]
        return {grid.get("name", ""): grid["sensors"] for grid in grids if isinstance(grid.get("sensors"), list)}

    def files(self) -> List[str]:
        """Returns the names of the result files. Slashes separate folders."""
        return [file["name"] for file in self.status().get("files", [])]

    def _file_path(self, name: str) -> str:
        return self._path + "/files/" + urllib.parse.quote(name, safe="")

    def read(self, name: str) -> bytes:
        """Returns the bytes of a result file."""
        reply = self._transport.repeat("GET", self._file_path(name))
        if reply.status != 200:
            raise problem_of(*reply)
        return reply.body

    def links(self, files: Iterable[str], seconds: int = 300) -> Dict[str, str]:
        """Returns URLs of result files that need no token, for example for the <img> of a page.

        Returns {name: url}. Anyone who has a URL can read that file until it expires.
        """
        links = self._transport.post_json(self._path + "/links", {"files": list(files), "seconds": seconds})["links"]
        return {link["file"]: self._transport.url + link["url"] for link in links}

    def fetch(self, folder: StrPath, patterns: Sequence[str] = ("*",)) -> List[str]:
        """Downloads result files into the folder; no partial files remain. Returns their paths.

        patterns: only files that match one of them, such as "*.png".
        """
        make_folder(Path(folder))
        names = [name for name in self.files() if any(fnmatchcase(name, one) for one in patterns)]
        return [self._fetch_file(Path(folder), name) for name in names]

    def pictures(self, folder: StrPath) -> List[str]:
        """Downloads the pictures (PNG, HDR, EXR and SVG) into the folder. Returns their paths."""
        return self.fetch(folder, ("*.png", "*.hdr", "*.exr", "*.svg"))

    def _fetch_file(self, folder: Path, name: str) -> str:
        path = folder.joinpath(*_parts(name))
        make_folder(path.parent)
        part = path.with_name(path.name + ".part")

        def keep(reply: http.client.HTTPResponse) -> bytes:
            length, size = reply.headers.get("Content-Length"), 0
            with writing(part) as write:
                for chunk in iter(lambda: reply.read(CHUNK), b""):
                    write(chunk)
                    size += len(chunk)
            if length is not None and size != int(length):
                raise http.client.IncompleteRead(b"", int(length) - size)
            return b""

        try:
            reply = self._transport.repeat("GET", self._file_path(name), sink=keep)
            if reply.status != 200:
                raise problem_of(*reply)
            os.replace(str(part), str(path))
        finally:
            with contextlib.suppress(OSError):
                part.unlink()
        return str(path)


def _parts(name: str) -> Tuple[str, ...]:
    """Splits a file's name. Refuses one that would leave the output folder, on any system."""
    parts = name.split("/")
    if any(not part or part.startswith(".") or any(c in part for c in '\\:\0') for part in parts):
        raise OrielError("the daemon lists a file outside the output folder: %r" % name)
    return tuple(parts)


def submit(transport: Transport, document: Dict[str, Json], key: str, client: Any = None) -> Job:
    """Submits a document. Repetitions of the request create no second job, because they have the same key."""
    body = json.dumps(document).encode("utf-8")
    headers = {"Content-Type": "application/json", "Idempotency-Key": key}
    return Job(transport, transport.json("POST", "/v1/jobs", body, headers)["id"], client)
