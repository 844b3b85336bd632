"""HTTP requests to a daemon: connections, retries with back-off, and errors."""

import http.client
import ipaddress
import json
import ssl
import time
import urllib.parse
from email.message import Message
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Union

from .errors import Json, OrielError, Unreachable, problem_of

Body = Union[bytes, Callable[[], Iterable[bytes]], None]  # a function starts the body again for a retry


class Reply(NamedTuple):
    """The answer to a request."""

    status: int
    headers: Message
    body: bytes


def _is_loopback(host: str) -> bool:
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


class Transport:
    """Sends requests to one daemon. It keeps no connection, so that threads may share it.

    timeout: seconds without data after which a request fails. retries: repetitions of a request
    that can be repeated safely, after `backoff` seconds, then twice as many, and so on.
    """

    def __init__(self, url: str, token: Optional[str], ca_file: Optional[str], name: Optional[str],
                 timeout: float, retries: int, backoff: float) -> None:
        self.url = url.rstrip("/")
        parts = urllib.parse.urlsplit(self.url)
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise OrielError("%r is not an http:// or https:// URL" % self.url)
        self._https, self._host, self._port = parts.scheme == "https", parts.hostname, parts.port
        self._base, self.timeout = parts.path, timeout
        self.retries, self.backoff = retries, backoff
        if token and not self._https and not _is_loopback(self._host):
            raise OrielError("a token sent over plain HTTP could be intercepted", "use https://")
        self._headers = {"User-Agent": "oriel-python"}
        if token:
            self._headers["Authorization"] = "Bearer " + token
        if name:
            self._headers["X-Oriel-Client"] = name
        self._context = ssl.create_default_context() if self._https else None
        if self._context and ca_file:
            self._context.load_verify_locations(ca_file)

    def connect(self, timeout: Optional[float] = None) -> http.client.HTTPConnection:
        """Returns a connection that is not open yet."""
        seconds = timeout or self.timeout
        if self._context:
            return http.client.HTTPSConnection(self._host, self._port, timeout=seconds, context=self._context)
        return http.client.HTTPConnection(self._host, self._port, timeout=seconds)

    def start(self, connection: http.client.HTTPConnection, method: str, path: str,
              body: Union[bytes, Iterable[bytes], None] = None,
              headers: Optional[Dict[str, str]] = None) -> http.client.HTTPResponse:
        """Sends a request and returns the response, whose body is not read yet."""
        merged = dict(self._headers, **(headers or {}))
        try:
            connection.request(method, self._base + path, body=body, headers=merged)
        except (BrokenPipeError, ConnectionResetError, ConnectionAbortedError):
            pass  # refused before the whole body was sent: the response, if any, has the reason
        return connection.getresponse()

    def unreachable(self, error: Exception) -> Unreachable:
        """Returns the exception for an error of the connection."""
        if isinstance(error, ssl.SSLCertVerificationError):
            return Unreachable("the certificate of %s is not trusted: %s" % (self.url, error),
                               "name the certificate of its issuer by ca_file or $ORIEL_CA")
        return Unreachable("no answer from %s: %s" % (self.url, error or type(error).__name__))

    def send(self, method: str, path: str, body: Body = None, headers: Optional[Dict[str, str]] = None,
             sink: Optional[Callable[[http.client.HTTPResponse], bytes]] = None) -> Reply:
        """Sends one request, once. sink(response), if given, reads the body of a 200."""
        connection = self.connect()
        try:
            content = body() if callable(body) else body
            reply = self.start(connection, method, path, content, headers)
            data = sink(reply) if sink and reply.status == 200 else reply.read()
            return Reply(reply.status, reply.headers, data)
        except (OSError, http.client.HTTPException) as error:
            raise self.unreachable(error) from error
        finally:
            connection.close()

    def repeat(self, method: str, path: str, body: Body = None, headers: Optional[Dict[str, str]] = None,
               sink: Optional[Callable[[http.client.HTTPResponse], bytes]] = None) -> Reply:
        """Sends a request that may be repeated, until there is an answer or `retries` are used up."""
        attempt = 0
        while True:
            pause = self.backoff * 2 ** attempt
            try:
                reply = self.send(method, path, body, headers, sink)
                if reply.status not in (429, 503) or attempt >= self.retries:
                    return reply
                after = reply.headers.get("Retry-After") or ""
                pause = max(pause, min(int(after), 60) if after.isdigit() else 0)
            except Unreachable as broken:
                if attempt >= self.retries or isinstance(broken.__cause__, ssl.SSLCertVerificationError):
                    raise
            time.sleep(pause)
            attempt += 1

    def json(self, method: str, path: str, body: Body = None, headers: Optional[Dict[str, str]] = None) -> Json:
        """Sends a request that may be repeated. Returns its JSON, or raises a Problem."""
        reply = self.repeat(method, path, body, headers)
        if reply.status // 100 != 2:
            raise problem_of(*reply)
        return json.loads(reply.body.decode("utf-8"))

    def post_json(self, path: str, document: Json, headers: Optional[Dict[str, str]] = None) -> Json:
        """Posts a document as JSON."""
        merged = dict({"Content-Type": "application/json"}, **(headers or {}))
        return self.json("POST", path, json.dumps(document).encode("utf-8"), merged)

    def pages(self, path: str, member: str, limit: int) -> List[Dict[str, Any]]:
        """Returns the first items of a list, which may have several pages."""
        found: List[Dict[str, Any]] = []
        at: Optional[str] = path
        while at and len(found) < limit:
            reply = self.repeat("GET", at)
            if reply.status != 200:
                raise problem_of(*reply)
            found += json.loads(reply.body.decode("utf-8"))[member]
            link = reply.headers.get("Link") or ""
            at = link[1:link.index(">")] if 'rel="next"' in link else None
        return found[:limit]

    def remove(self, *path: str) -> None:
        """Deletes an item."""
        reply = self.send("DELETE", "/v1/" + "/".join(urllib.parse.quote(part, safe="") for part in path))
        if reply.status // 100 != 2:
            raise problem_of(*reply)

    def has(self, path: str) -> bool:
        """Asks whether an item exists."""
        reply = self.repeat("HEAD", path)
        if reply.status in (200, 404):
            return reply.status == 200
        if not reply.body:  # the response to a HEAD has no body: request the reason
            reply = self.repeat("GET", path)
        raise problem_of(*reply)
