"""Daemons for the contract's test, each a process on a folder of its own, and requests to them."""

import http.client
import json
import os
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import urllib.parse

ENDED = ("succeeded", "failed", "cancelled")


def find_program():
    return os.path.join(os.environ.get("ORIEL_BUILD", "build"), "orield")


def is_sanitized():
    """Then it is slow, and nothing may be loaded before its library."""
    with open(find_program(), "rb") as stream:
        program = stream.read()
    return b"__asan_init" in program or b"__tsan_init" in program


class Answer:
    """status, headers (by their names in lower case), body; json on demand."""

    def __init__(self, status, headers, body):
        self.status, self.body = status, body
        self.headers = {}
        for name, value in headers:  # of one name, as RFC 9110, 5.3 joins them
            before = self.headers.get(name.lower())
            self.headers[name.lower()] = "%s, %s" % (before, value) if before else value

    @property
    def json(self):
        return json.loads(self.body.decode("utf-8"))

    @property
    def id(self):
        return self.json["id"]


class Daemon:
    """$ORIEL_BUILD/orield, whose every answer the contract judges."""

    def __init__(self, contract, *options, environment=None):
        self.contract, self.options = contract, options
        self.environment = dict(os.environ, **(environment or {}))
        self.folder = tempfile.mkdtemp(prefix="oriel-test-")
        self.program = find_program()
        self.patience_s = 300 if is_sanitized() else 60
        self.header = {}
        self.process = None
        if "--tokens" in options:
            self.token = {scope: self._run("token", "add", scope, "--scope", scope)
                          for scope in ("read", "submit", "admin")}
        self._start()

    def _run(self, *arguments):
        return subprocess.check_output([self.program, *arguments, "--data", self.folder],
                                       text=True, timeout=30).split()[0]

    def _start(self):
        with open(self.folder + ".log", "ab") as log:
            self.process = subprocess.Popen(
                ["setpriv", "--pdeathsig", "KILL", self.program, "--data", self.folder, "--port",
                 "0", *self.options], stdout=subprocess.PIPE, stderr=log, text=True,
                env=self.environment)
        line = self.process.stdout.readline()
        assert line.startswith("listening on "), "no daemon: %s.log" % self.folder
        self.port = urllib.parse.urlsplit(line.split()[-1]).port
        self.connection = self.connect()

    def connect(self):
        return http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)

    def end(self):
        """Stops it; expects that this goes well."""
        self.process.send_signal(signal.SIGTERM)
        self.ended()

    def ended(self):
        status = self.process.wait(60)
        self.process.stdout.close()
        assert status == 0, "the daemon ended with %d: %s.log" % (status, self.folder)
        shutil.rmtree(self.folder)
        os.unlink(self.folder + ".log")

    def ask(self, method, path, body=None, headers=None, want=None, connection=None):
        """One request. body: bytes, text, or what goes out as JSON. want: the status expected."""
        self.send(method, path, body, headers, connection)
        return self.receive(method, path, want, connection)

    def send(self, method, path, body=None, headers=None, connection=None):
        own = dict(self.header)
        if body is not None and not isinstance(body, (bytes, str)):
            body = json.dumps(body)
            own["Content-Type"] = "application/json"
        own.update(headers or {})
        data = body.encode() if isinstance(body, str) else body
        (connection or self.connection).request(method, path, body=data, headers=own)

    def receive(self, method, path, want=None, connection=None):
        """The answer to a request that was sent."""
        reply = (connection or self.connection).getresponse()
        return self._judged(method, path, reply, want)

    def _judged(self, method, path, reply, want):
        answer = Answer(reply.status, reply.getheaders(), reply.read())
        self.contract.judge(method, path, answer)
        assert want is None or answer.status == want, \
            "%s %s: %d instead of %s: %.500r" % (method, path, answer.status, want, answer.body)
        return answer

    def announce(self, method, path, headers, want=None):
        """Sends the headers of a request alone, as a client that waits for 100 Continue does."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=60) as stream:
            lines = ["%s %s HTTP/1.1" % (method, path), "Host: 127.0.0.1"]
            lines += ["%s: %s" % pair for pair in {**self.header, **headers}.items()]
            stream.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
            reply = http.client.HTTPResponse(stream, method=method)
            reply.begin()
            return self._judged(method, path, reply, want)

    # -- Jobs -----------------------------------------------------------------------------------

    def upload(self, *texts, resources=None):
        """A scene of main files and named resources; its id."""
        files = [{"name": "%d.rad" % i, "text": text} for i, text in enumerate(texts)]
        files += [{"name": name, "text": text, "resource": True}
                  for name, text in (resources or {}).items()]
        return self.ask("POST", "/v1/scenes", {"files": files}).id

    def submit(self, document, **headers):
        """A job that must be taken; its path."""
        faults = self.contract.judge_request(document)
        answer = self.ask("POST", "/v1/jobs", document,
                          {name.replace("_", "-"): value for name, value in headers.items()}, 202)
        assert not faults, "the daemon takes what the contract forbids: %s" % faults
        return "/v1/jobs/" + answer.id

    def wait(self, path, state=ENDED, until=lambda job: True):
        """Polls until the job is in one of the states, and what until says; its last document."""
        patience = time.monotonic() + self.patience_s
        while True:
            job = self.ask("GET", path, want=200).json
            if job["state"] in state and until(job):
                return job
            assert job["state"] not in ENDED, job
            assert time.monotonic() < patience, job
            time.sleep(0.02)
