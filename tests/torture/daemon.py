"""A daemon under test: the process, and plain HTTP to it.

Whatever breaks while a request is under way is a Gone: the daemon was killed, or refuses to
connect. An answer, whichever, is an Answer, and none within a minute a Failure.
"""

import ctypes
import http.client
import json
import os
import signal
import socket
import subprocess

_PR_SET_PDEATHSIG = 1
_LIBC = ctypes.CDLL(None)


class Gone(Exception):
    """No answer: the daemon is not there any more."""


class Failure(Exception):
    """The daemon did what it must not do."""


def computed_s(pid):
    """Processor seconds so far of a process and its descendants, those that it has waited for included."""
    try:
        with open("/proc/%d/stat" % pid, encoding="ascii") as stream:
            fields = stream.read().rsplit(")", 1)[1].split()
        with open("/proc/%d/task/%d/children" % (pid, pid), encoding="ascii") as stream:
            children = [int(child) for child in stream.read().split()]
    except OSError:  # it has ended
        return 0.0
    return sum(int(ticks) for ticks in fields[11:15]) / os.sysconf("SC_CLK_TCK") + sum(map(computed_s, children))


class Answer:
    def __init__(self, status, headers, body):
        self.status, self.headers, self.body = status, headers, body

    def json(self):
        return json.loads(self.body.decode("utf-8"))

    def problem(self):
        """What a problem document says, as one line."""
        try:
            document = self.json()
            return "%s %s: %s" % (self.status, document["title"], document.get("detail"))
        except (ValueError, KeyError, TypeError):
            return "%s %r" % (self.status, self.body[:200])


class Client:
    """One connection, kept alive. For one thread."""

    def __init__(self, port, name):
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        self.name = name

    def request(self, method, path, body=None, headers=None):
        headers = dict(headers or {}, **{"X-Oriel-Client": self.name})
        try:
            self.connection.request(method, path, body, headers)
            response = self.connection.getresponse()
            return Answer(response.status, response.headers, response.read())
        except socket.timeout as error:
            self.connection.close()
            raise Failure("no answer to %s %s within a minute" % (method, path)) from error
        except (OSError, http.client.HTTPException) as error:
            self.connection.close()
            raise Gone(repr(error)) from error

    def post_json(self, path, document, headers=None):
        headers = dict(headers or {}, **{"Content-Type": "application/json"})
        return self.request("POST", path, json.dumps(document).encode(), headers)

    def close(self):
        self.connection.close()


def _die_with_parent():
    _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


class Daemon:
    """orield on a data folder, on a free port. Dies with this program."""

    def __init__(self, build, root, arguments=(), environment=None):
        with open(root + ".log", "ab") as log:
            self.process = subprocess.Popen(
                [os.path.join(build, "orield"), "--port", "0", "--data", root,
                 "--drain-timeout", "0", *arguments],
                stdout=subprocess.PIPE, stderr=log, preexec_fn=_die_with_parent,
                env=dict(os.environ, **(environment or {})))
        self.port = None

    def wait_listening(self):
        """Returns False when it ended before it listened."""
        line = self.process.stdout.readline().decode()
        if line.startswith("listening on "):
            self.port = int(line.rsplit(":", 1)[1])
        return self.port is not None

    def kill(self):
        self.process.send_signal(signal.SIGKILL)

    def wait(self):
        status = self.process.wait()
        self.process.stdout.close()
        return status

    def stop(self):
        """Orderly."""
        self.process.send_signal(signal.SIGTERM)
        status = self.wait()
        if status != 0:
            raise Failure("the daemon ended with status %d after SIGTERM" % status)

    def client(self, name="torture"):
        return Client(self.port, name)
