"""Server-sent events: states of one job, or of all jobs, as they change."""

import contextlib
import http.client
import json
import socket
import threading
from typing import Any, Callable, Dict, Iterator, Optional, Tuple

from .errors import problem_of
from .transport import Transport

Event = Tuple[str, Dict[str, Any], Optional[str]]


def read_events(response: http.client.HTTPResponse) -> Iterator[Event]:
    """Yields (name, data, id) of a response until it ends (HTML Living Standard, 9.2.6)."""
    event: Dict[str, str] = {}
    for line in iter(response.readline, b""):
        name, _, value = line.decode("utf-8").rstrip("\r\n").partition(":")
        if name in ("id", "event", "data"):
            event[name] = value[1:] if value.startswith(" ") else value
        elif not name and not value and "data" in event:
            yield event.get("event", "message"), json.loads(event["data"]), event.get("id")
            event = {}


def stream(transport: Transport, path: str, last_id: Optional[str] = None,
           opened: Optional[Callable[[socket.socket], None]] = None) -> Iterator[Event]:
    """Yields the events of a path until the stream ends. Raises a Problem, or Unreachable if it breaks.

    opened(socket), if given, is called once there is a connection.
    """
    connection = transport.connect()
    headers = {"Accept": "text/event-stream"}
    if last_id:
        headers["Last-Event-ID"] = last_id
    try:
        connection.connect()
        if opened:
            opened(connection.sock)
        reply = transport.start(connection, "GET", path, None, headers)
        if reply.status == 204:  # the last state is known already
            return
        if reply.status != 200:
            raise problem_of(reply.status, reply.headers, reply.read())
        if "text/event-stream" not in (reply.headers.get("Content-Type") or ""):
            raise http.client.HTTPException("the answer is no stream of events")
        yield from read_events(reply)
    except (OSError, ValueError, http.client.HTTPException) as error:
        raise transport.unreachable(error) from error
    finally:
        connection.close()


class Watcher:
    """Watches a job in a thread, so that Ctrl-C and time limits work on every system while it waits.

    `wait` returns when the job may have changed, at the latest after some seconds. Without a stream
    (proxies may break it, and a daemon limits their number) the caller polls.
    """

    IDLE_S = 5.0  # between polls while the stream is open, in case it is silently lost
    REOPEN_S = 10.0  # before a stream that has ended is opened again

    def __init__(self, transport: Transport, path: str, poll: float) -> None:
        self._transport, self._path, self._poll = transport, path, poll
        self._changed, self._closed, self._is_open = threading.Event(), threading.Event(), False
        self._socket: Optional[socket.socket] = None
        threading.Thread(target=self._run, name="oriel-events", daemon=True).start()

    def _keep(self, opened: socket.socket) -> None:
        self._socket = opened

    def _run(self) -> None:
        while not self._closed.is_set():
            try:
                for _ in stream(self._transport, self._path, opened=self._keep):
                    self._is_open = True
                    self._changed.set()
            except Exception:  # the polls find out, and say, what is wrong with the daemon
                pass
            self._is_open = False
            self._changed.set()
            self._closed.wait(self.REOPEN_S)

    def wait(self, seconds: Optional[float]) -> None:
        """Waits for a change, but no longer than the seconds."""
        longest = self.IDLE_S if self._is_open else self._poll
        self._changed.wait(longest if seconds is None else max(0.0, min(seconds, longest)))
        self._changed.clear()

    def close(self) -> None:
        """Ends the watch."""
        self._closed.set()
        if self._socket:
            with contextlib.suppress(OSError):
                self._socket.shutdown(socket.SHUT_RDWR)
