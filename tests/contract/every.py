"""What every operation answers, by the contract alone: a new route is asked all of this as soon as
api/openapi has it."""

import http.client
import re
import select
import signal
import socket
import time

from recorder import METHODS

UNKNOWN = "0" * 64
BEYOND = str(1 << 50)


def url_of(template, **values):
    """An instance of the path: parameters without a value name what there is not."""
    return re.sub(r"{(\w+)}", lambda match: values.get(match.group(1), UNKNOWN), template)


def bodies(contract, operation):
    """The types of body that an operation takes."""
    request = contract.operations[operation].get("requestBody")
    return list(request["content"]) if request else []


def verb(contract, operation):
    """Its method; of a stream without an end that of its headers alone."""
    answer = contract.responses(operation).get("200", {}).get("content", {})
    endless = "text/event-stream" in answer and "{" not in operation[1]
    return "HEAD" if endless else operation[0]


def things_unknown(daemon):
    """404: of a path with a parameter that names nothing."""
    for operation in daemon.contract.documented(404):
        takes_json = "application/json" in bodies(daemon.contract, operation)
        daemon.ask(operation[0], url_of(operation[1]), {} if takes_json else None, want=404)


def strays(daemon):
    """404 and 405: paths and methods that are none of the contract's."""
    for path in ("/nowhere", "/v1", "/v1/", "/v1/jobs/", "/v1/jobs/a/b/c/d", "/../etc/passwd"):
        daemon.ask("GET", path, want=404)
    for template in daemon.contract.document["paths"]:
        known = {method for method, path in daemon.contract.operations if path == template}
        for method in {name.upper() for name in METHODS} - known - {"HEAD"}:
            daemon.ask(method, url_of(template), want=405)
        if "GET" not in known and "HEAD" not in known:
            daemon.ask("HEAD", url_of(template), want=405)


def web_pages(daemon):
    """403 without tokens: another site's page, or another name for this machine."""
    for method, template in daemon.contract.operations:
        for headers in ({"Origin": "https://example.org"}, {"Host": "example.org"}):
            daemon.ask(method, url_of(template), headers=headers, want=403)


def pages_let_in(daemon):
    """Of --allow-origin: every answer, an error's too, says that the page may read it."""
    page = {"Origin": "https://tool.example"}
    for operation in daemon.contract.operations:
        method, template = verb(daemon.contract, operation), operation[1]
        answer = daemon.ask(method, url_of(template), headers=page)
        assert answer.headers["access-control-allow-origin"] == page["Origin"], (method, template)
        assert answer.headers["vary"].endswith("Origin") and answer.status != 403
        assert "vary" in daemon.ask(method, url_of(template)).headers


def bodies_refused(daemon):
    """413 by the length stated, 415 by the type, 400 for what is no JSON."""
    for operation in daemon.contract.documented(413):
        kinds = bodies(daemon.contract, operation)
        kind = "application/xml" if not kinds or kinds[0] == "*/*" else kinds[0]
        daemon.announce(operation[0], url_of(operation[1]),
                        {"Content-Type": kind, "Content-Length": BEYOND,
                         "Expect": "100-continue"}, want=413)
    for method, template in daemon.contract.documented(415):
        daemon.ask(method, url_of(template), "x", {"Content-Type": "text/x-oriel"}, want=415)
    for operation in daemon.contract.operations:
        if "application/json" in bodies(daemon.contract, operation):
            for text in ("{", "", "[]{}", "\xff\xfe"):
                daemon.ask(*operation[:1], url_of(operation[1]), text.encode("latin-1"),
                           {"Content-Type": "application/json"}, want=400)


def tokens(daemon):
    """401 without a token or with a wrong one, 403 with one that may do less; else neither."""
    scopes = ("read", "submit", "admin")
    for (method, template), operation in daemon.contract.operations.items():
        path, ends = url_of(template), verb(daemon.contract, (method, template))
        needs = operation.get("x-scope")
        assert (needs is None) == (operation.get("security") == []), (method, template)
        daemon.header = {}
        if needs is None:
            assert daemon.ask(method, path).status in (200, 204, 404)
            continue
        daemon.ask(method, path, want=401)
        daemon.header = {"Authorization": "Bearer oriel_0123456789abcdef_" + "A" * 43}
        daemon.ask(method, path, want=401)
        for scope in scopes:
            daemon.header = {"Authorization": "Bearer " + daemon.token[scope]}
            allowed = scopes.index(scope) >= scopes.index(needs)
            # What is taken apart only beyond the door is refused there for other reasons.
            answer = daemon.ask(ends, path)
            assert (answer.status == 403) != allowed and answer.status != 401, \
                "%s %s as %s: %d" % (method, path, scope, answer.status)


class EndedTooSoon(Exception):
    """The daemon had done its work before it could be halted."""


def ended_too_soon(daemon, work):
    work()
    daemon.ended()
    raise EndedTooSoon


def run_until_stopping(daemon, connection):
    """Lets the daemon run for a few milliseconds at a time until it answers that it stops, and leaves it halted: it ends
    soon after its upload has, but must first get all requests."""
    until = time.monotonic() + daemon.patience_s
    status = None
    daemon.process.send_signal(signal.SIGSTOP)
    while status != 503:
        assert time.monotonic() < until, "the daemon does not stop"
        daemon.send("GET", "/healthz", connection=connection)
        while not select.select([connection.sock], [], [], 0)[0] and time.monotonic() < until:
            daemon.process.send_signal(signal.SIGCONT)
            time.sleep(0.002)
            daemon.process.send_signal(signal.SIGSTOP)
        status = daemon.receive("GET", "/healthz", connection=connection).status


def stopping(daemon, busy):
    """503 of everything, on connections from before: busy(daemon) keeps the daemon from ending. Raises EndedTooSoon
    where a loaded machine let the daemon end first."""
    asks = [(operation, daemon.connect()) for operation in daemon.contract.operations]
    for _, connection in asks:
        daemon.ask("GET", "/healthz", connection=connection)
    spare = daemon.connect()
    daemon.ask("GET", "/healthz", connection=spare)
    work = busy(daemon)
    # Begun last, so that the daemon does not give them up for being slow before it is stopped.
    begun = [socket.create_connection(("127.0.0.1", daemon.port), timeout=60) for _ in range(2)]
    for one in begun:
        one.sendall(b"POST /v1/bsdfs HTTP/1.1\r\nHost: localhost\r\nContent-Length: 4\r\n\r\n<x")
    later = daemon.connect()
    for _ in range(2):  # connections are accepted in order: those begun have been read when this one is answered
        daemon.ask("GET", "/healthz", connection=later)
    daemon.process.send_signal(signal.SIGTERM)
    try:
        run_until_stopping(daemon, spare)
    except (http.client.RemoteDisconnected, ConnectionResetError):
        ended_too_soon(daemon, work)
    for one in begun:
        one.sendall(b"/>")
    for (method, template), connection in asks:
        daemon.send(method, url_of(template), connection=connection)
    daemon.process.send_signal(signal.SIGCONT)
    for one in begun:
        answer = one.recv(12, socket.MSG_WAITALL)
        if answer == b"":
            ended_too_soon(daemon, work)
        assert answer == b"HTTP/1.1 503", answer
        one.close()
    for (method, template), connection in asks:
        daemon.receive(method, url_of(template), 503, connection)
    work()
    daemon.ended()
