"""The client of a daemon."""

import os
import urllib.parse
from typing import Any, Dict, Iterator, List, Optional, Sequence

from .errors import Json, Unreachable
from .events import Event, stream
from .jobs import Job
from .kinds import Kinds
from .settings import read_settings
from .transport import Transport
from .uploads import Uploads


class Client(Kinds, Uploads):
    """A daemon at a URL.

    url: URL, or name of a server in oriel.toml (see oriel.settings); default $ORIEL_URL, then the
    file's `server`, then http://127.0.0.1:8423.
    token: default $ORIEL_TOKEN, then the server's token_file; over plain HTTP it is only sent to this
    machine.
    ca_file: certificates in PEM to trust in addition to the system's; default $ORIEL_CA.
    name: identifies the client in the daemon's queue if it requires no token; default $ORIEL_CLIENT.
    timeout: seconds without data after which a request fails.
    retries: repetitions of a request that found no answer, or a busy daemon; the first after
    `backoff` seconds, each other after twice the time before it.

    Several threads may share a Client: it keeps no connection.
    """

    def __init__(self, url: Optional[str] = None, token: Optional[str] = None, ca_file: Optional[str] = None,
                 name: Optional[str] = None, timeout: float = 60.0, retries: int = 3, backoff: float = 0.25) -> None:
        server = read_settings().choose(url)
        self.url = server.url
        self._transport = Transport(server.url, token or server.token, ca_file or os.environ.get("ORIEL_CA"),
                                    name or os.environ.get("ORIEL_CLIENT"), timeout, retries, backoff)
        self._known = {}
        self.uploads = self

    def __repr__(self) -> str:
        return "Client(%r)" % self.url

    def job(self, id: str) -> Job:
        """Returns an earlier job by its id, or by enough first digits to be unique."""
        return Job(self._transport, id, self)

    def jobs(self, state: Optional[str] = None, limit: int = 100, scene: Optional[str] = None,
             tags: Sequence[str] = (), since: Optional[str] = None, summary: bool = False) -> List[Dict[str, Json]]:
        """Returns the latest jobs' states, newest first, from as many pages as needed.

        tags: only jobs that have all of them. since: only jobs submitted at that time or later, in UTC
        such as "2024-03-22T11:30:00Z". summary: short states without files, maps and links.
        """
        query = [("limit", str(min(limit, 1000)))] + [("tag", tag) for tag in tags]
        query += [(key, one) for key, one in (("state", state), ("scene", scene), ("since", since),
                                              ("fields", "summary" if summary else None)) if one]
        return self._transport.pages("/v1/jobs?" + urllib.parse.urlencode(query), "jobs", limit)

    def events(self, jobs: Sequence[str] = (), tags: Sequence[str] = (),
               last_id: Optional[str] = None) -> Iterator[Event]:
        """Iterates over events of jobs from now on, as tuples (kind, data, id).

        kind "job": data is the job's summary, as from jobs(summary=True). "removed": data has the id.
        "reset": earlier events are lost, so request lists again. jobs, tags: only these jobs. last_id:
        continue after this event. Raises Unreachable when the connection ends.
        """
        query = urllib.parse.urlencode([("job", one) for one in jobs] + [("tag", one) for one in tags])
        yield from stream(self._transport, "/v1/events" + ("?" + query if query else ""), last_id)
        raise Unreachable("the daemon ended the stream of events")

    def scenes(self, limit: int = 100) -> List[Dict[str, Json]]:
        """Returns the stored scenes, latest first, with bytes, last_used, jobs and jobs_under_way."""
        return self._transport.pages("/v1/scenes?limit=%d" % min(limit, 1000), "scenes", limit)

    def bsdfs(self, limit: int = 100) -> List[Dict[str, Json]]:
        """Returns the stored BSDFs, latest first, with the number of scenes that use them."""
        return self._transport.pages("/v1/bsdfs?limit=%d" % min(limit, 1000), "bsdfs", limit)

    def maps(self) -> List[Dict[str, Json]]:
        """Returns the photon maps and loaded BSDFs that the daemon stores for later jobs."""
        return list(self._transport.json("GET", "/v1/maps")["maps"])

    def remove_scene(self, id: str) -> None:
        """Removes a scene. Raises InUse while a waiting or running job needs it. Finished jobs stay."""
        self._transport.remove("scenes", id)

    def remove_bsdf(self, id: str) -> None:
        """Removes a BSDF. Raises InUse while a scene contains it."""
        self._transport.remove("bsdfs", id)

    def remove_map(self, kind: str, key: str) -> None:
        """Removes an item of maps(). Raises InUse while a job uses it. Later jobs build it again."""
        self._transport.remove("maps", kind, key)

    def limits(self) -> Dict[str, Any]:
        """Returns the daemon's limits by name."""
        return dict(self._transport.json("GET", "/v1/limits"))

    def health(self) -> Dict[str, Any]:
        """Returns the daemon's version and uptime_s. Raises Unreachable if it does not answer."""
        return dict(self._transport.json("GET", "/healthz"))
