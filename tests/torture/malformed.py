"""Requests that are wrong: each gets a 4xx, soon, and costs the daemon nothing that stays.

    python3 tests/torture/malformed.py BUILD [--count N] [--seed N]

Generated from good ones by a seed: members of other types, numbers beyond all bounds, deep nesting,
text that is no UTF-8, bodies shorter or longer than they say, paths that climb, zips that swell or
lie, multipart and HTTP that break off. Raw bytes go out, on a connection for each; what counts is
the answer's status. libmicrohttpd speaks first, and by its own rules, which leave two exceptions:

- HTTP/x.y with an x other than 1 gets a 505, as RFC 9110 has it (15.6.6);
- the connection is closed without an answer when what comes has no request line at all, that is, no
  method, space and target (a TLS handshake, one word, a blank in front; RFC 9112, 3, has the server
  answer or close), or when the client stops sending before its request is complete (RFC 9112, 8).

Any other bytes that get a 5xx or no answer fail the run.
"""

import argparse
import io
import json
import os
import random
import re
import shutil
import socket
import sys
import tempfile
import time
import zipfile

from daemon import Client, Daemon, Failure, computed_s
from faults import has_sanitizer
from load import FIRST_SCENE, upload_scene

SLOW_S = 5.0  # of processors, which is generous: most take a millisecond; a hang ends after HANG_S
HANG_S = 60
READ_S = 0.002  # for the bytes to be read; an end that comes with them is found within a second
GROWTH_BYTES = 24 << 20
WRONG = (None, True, -1, 0.5, 1e308, -1e308, 1 << 70, "", "x" * 5000, "\u0000", "../../etc/passwd",
         [], [[]], {}, {"": {}}, [None] * 2000)


def head(method, path, length, kind="application/json", extra=""):
    return ("%s %s HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\nContent-Type: %s\r\n"
            "Content-Length: %s\r\n%s\r\n" % (method, path, kind, length, extra)).encode("latin-1")


def post(path, body, kind="application/json", extra=""):
    return head("POST", path, len(body), kind, extra) + body


def get(path, method="GET"):
    return ("%s %s HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n" %
            (method, path)).encode()


def part(name, data, boundary="b"):
    return ("--%s\r\nContent-Disposition: form-data; name=\"file\"; filename=\"%s\"\r\n\r\n" %
            (boundary, name)).encode("utf-8", "surrogateescape") + data + b"\r\n"


class Generator:
    """Each kind makes one request that no daemon should take."""

    def __init__(self, scene, chance):
        self.chance = chance
        self.job = {"kind": "render", "scene": scene, "seed": 1, "technique": "gather",
                    "photons": {"global": 1000, "caustic": 1000}, "gather_samples": 64,
                    "priority": 5, "sensors": [[2, 1, 0.8, 0, 0, 1]],
                    "effects": {"caustics": "skip"},
                    "views": [{"name": "v", "view": "-vtv -vp 2 4 1 -vd 0 -1 0", "width": 8,
                               "height": 8}]}
        self.kinds = (self.wrong_member, self.unknown_member, self.broken_json, self.deep,
                      self.huge, self.bad_text, self.wrong_length, self.climbing_path,
                      self.bad_query, self.nul_in_target, self.bad_multipart, self.bad_name, self.bad_scene,
                      self.bad_bsdf, self.bad_zip, self.bad_http, self.bad_header,
                      self.bad_framing, self.bad_line, self.cut_short)
        self.last = None  # of these

    def __call__(self):
        self.last = self.chance.choice(self.kinds)
        return self.last()

    def wrong_member(self):
        document = json.loads(json.dumps(self.job))
        at, name = self.chance.choice((
            (document, "kind"), (document, "scene"), (document, "technique"),
            (document, "photons"), (document["photons"], "global"), (document, "sensors"),
            (document["sensors"], 0), (document["sensors"][0], 3), (document, "views"),
            (document["views"], 0), (document["views"][0], "name"), (document["views"][0], "view"),
            (document["views"][0], "width"), (document, "effects"), (document, "priority")))
        good = json.dumps(document)
        fits = {"photons": ({},), "global": (None,), "sensors": ([],), "views": ([],),
                "effects": ({},), 3: (-1, 0.5)}
        for _ in range(100):
            value = self.chance.choice(WRONG)
            if value not in fits.get(name, ()):
                break
        at[name] = value
        text = json.dumps(document)
        return post("/v1/jobs", (text if text != good else "{}").encode())

    def unknown_member(self):
        document = dict(self.job)
        document[self.chance.choice(("photon", "Sensors", "\u00e4", "x" * 300))] = 1
        return post("/v1/jobs", json.dumps(document).encode())

    def broken_json(self):
        text = json.dumps(self.job).encode()
        at = self.chance.randrange(len(text) - 1)
        return post("/v1/jobs", self.chance.choice((text[:at], text + b"}", text[:at] + b"\x00",
                                                    b"\xef\xbb\xbf{", b"NaN", b"[1e99999]", b"")))

    def deep(self):
        depth = self.chance.choice((100, 3000, 200000))
        opening = self.chance.choice((b"[", b'{"a":'))
        return post("/v1/jobs", b'{"kind":' + opening * depth)

    def huge(self):
        """Numbers whose sum or product would not fit."""
        document = dict(self.job)
        big = self.chance.choice((1 << 31, 1 << 32, 1 << 62, (1 << 63) - 1, 1e300))
        document.update(self.chance.choice((
            {"photons": {"global": big}}, {"gather_samples": big}, {"priority": big},
            {"views": [dict(self.job["views"][0], width=big)]},
            {"views": [dict(self.job["views"][0], width=16384, height=16384)]},
            {"sensors": [[1e300, big, 1e308, 0, 0, 1]]}, {"sensors": [[1, 1, 1, 0, 0, 0]]},
            {"accuracy": {"relative_error": big}}, {"accuracy": {"deadline_s": big}})))
        return post("/v1/jobs", json.dumps(document).encode())

    def bad_text(self):
        bad = self.chance.choice((b"\xff", b"\xc0\xaf", b"\xed\xa0\x80", b"\xf4\x90\x80\x80",
                                  b"\xe2"))
        text = json.dumps(self.job).encode()
        return post("/v1/jobs", text.replace(b"gather", b"ga" + bad, 1))

    def wrong_length(self):
        body = json.dumps(self.job).encode()
        length = self.chance.choice(("-1", "x", "99999999999999999999", "1e3", "0x10", " ", "5,6",
                                     str(1 << 40)))
        return head("POST", "/v1/jobs", length) + body

    def climbing_path(self):
        path = self.chance.choice((
            "/v1/jobs/../../etc/passwd", "/v1/jobs/%2e%2e%2f%2e%2e", "/v1/scenes/..",
            "//etc/passwd",
            "/v1/jobs/" + "a" * 3000, "/v1/jobs/%00", "/v1/jobs/x/files/..%2f..%2foriel.db",
            "/v1/scenes/%ff%fe", "/v1/maps/global/..%2f..%2foriel.db", "/v1/jobs/x/files/%2e%2e",
            "/v1/bsdfs/'; DROP TABLE jobs; --".replace(" ", "%20"), "/v2/jobs", "/v1/jobs/"))
        method = self.chance.choice(("GET", "DELETE", "HEAD"))
        return get(path, method)

    def nul_in_target(self):
        """A query behind it is more than there is room for, or not."""
        target = self.chance.choice((b"/v1/jobs\x00", b"/v1/jobs\x00x?a=1", b"/\x00?" + b"a&" * 4000,
                                     b"/healthz?\x00" + b"a&" * 4000, b"/v1/jobs%00",
                                     b"/\x00" + b"x" * 20000 + b"?" + b"a=1&" * 900))
        return b"GET " + target + b" HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n"

    def bad_query(self):
        query = self.chance.choice(("a&" * 4000, "&" * 9000, "limit=0", "limit=-1",
                                    "limit=99999999999999999999", "limit=x",
                                    "limit=", "state=done", "state=%00", "limit=1e3"))
        return get("/v1/jobs?" + query)

    def bad_multipart(self):
        good = part("a.rad", FIRST_SCENE) + b"--b--\r\n"
        kind, body = self.chance.choice((
            ("multipart/form-data", good), ("multipart/form-data; boundary=", good),
            ("multipart/form-data; boundary=c", good),
            ("multipart/form-data; boundary=b", good[:99]),
            ("multipart/form-data; boundary=b", b""),
            ("multipart/form-data; boundary=b", b"--b--\r\n"),
            ("multipart/form-data; boundary=b", part("a.rad", b"") + b"--b--\r\n"),
            ("multipart/form-data; boundary=b", good[:-7] + good), ("text/plain", good),
            ("multipart/form-data; boundary=" + "b" * 3000, good)))
        return post("/v1/scenes", body, kind)

    def bad_name(self):
        name = self.chance.choice(("../a.rad", "/etc/passwd", "a/../../b", "a\\b", "", ".", "a//b",
                                   "a\x01b", "x" * 300, "\udcff.rad", "a/./b"))
        return post("/v1/scenes", part(name, FIRST_SCENE) + b"--b--\r\n",
                    "multipart/form-data; boundary=b")

    def bad_scene(self):
        text = self.chance.choice((
            b"void plastic", b"!rm -rf /\n", b"void plastic a 0 0 99999999999 1\n",
            b"void plastic a 0 0 5 nan inf 1e999 0 0\n", b"\x00" * 1000, b"( " * 5000,
            b"void polygon p 0 0 9 0 0 0 1 0 0 1 1 0\n" * 3 + b"x", b"!xform -a 99999999 b.rad\n",
            b"!xform a.rad\n", FIRST_SCENE[:-9], b"void mesh m 1 /etc/passwd 0 0\n"))
        return post("/v1/scenes", part("a.rad", text) + b"--b--\r\n",
                    "multipart/form-data; boundary=b")

    def bad_bsdf(self):
        text = self.chance.choice((
            b"", b"<", b"<a>" * 5000, b"<!DOCTYPE a [<!ENTITY b 'c'>]><WindowElement/>",
            b"<WindowElement>" + b"<Layer>" * 100, b"\xff\xfe<", b"<WindowElement/>",
            b'<?xml version="1.0" encoding="UTF-7"?><WindowElement/>'))
        return post("/v1/bsdfs", text, "application/xml")

    def bad_zip(self):
        stream = io.BytesIO()
        how = self.chance.randrange(6)
        with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
            if how == 0:
                archive.writestr("../a.rad", FIRST_SCENE)
            elif how == 1:
                archive.writestr("a.rad", b"\0" * (48 << 20))
            elif how == 2:
                for i in range(2000):
                    archive.writestr("%d.rad" % i, b"#")
            elif how == 3:
                link = zipfile.ZipInfo("a.rad")
                link.external_attr = 0o120777 << 16
                archive.writestr(link, "/etc/passwd")
            else:
                archive.writestr("a.rad", FIRST_SCENE)
        data = stream.getvalue()
        if how == 4:
            data = data[:len(data) // 2]
        if how == 5:
            data = b"PK\x03\x04" + bytes(self.chance.randrange(256) for _ in range(200))
        return post("/v1/scenes", data, "application/zip")

    def bad_http(self):
        return self.chance.choice((
            b"GET\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n",
            b"GET /v1/jobs HTTP/9.9\r\n\r\n", b"GET  HTTP/1.1\r\n\r\n",
            b"PUT /v1/jobs HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n",
            b"GET /v1/jobs HTTP/1.1\r\nHost: 127.0.0.1\r\nX: " + b"a" * 80000 + b"\r\n\r\n",
            b"GET /" + b"a" * 80000 + b" HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n",
            b"BREW /v1/jobs HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n",
            b"POST /v1/jobs HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\nContent-Type: "
            b"application/json\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n{}\r\n0\r\n\r\n"))

    def bad_line(self):
        line = self.chance.choice((
            b"GET", b" GET / HTTP/1.1", b"GET ", b"GET /", b"GET / HTTP/0.9", b"GET / HTTP/2.0",
            b"GET / http/1.1", b"GET / HTTX/1.1", b"GET / HTTP/1", b"GET / HTTP/11.1", b"\x00\xff",
            b"PRI * HTTP/2.0", b"\x80\x2e\x01\x03\x01", b"G\x00T /nowhere HTTP/1.1",
            bytes(self.chance.randrange(128, 256) for _ in range(40))))
        return line + b"\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n"

    def bad_framing(self):
        """What a proxy in front could read otherwise."""
        headers = self.chance.choice((
            b"Host: a\r\nHost: b\r\nContent-Length: 2\r\n", b"Content-Length: 2\r\n",
            b"Host: 127.0.0.1\r\nContent-Length: 2\r\nContent-Length: 20\r\n",
            b"Host: 127.0.0.1\r\nContent-Length: 2\r\nContent-Length: 2\r\n",
            b"Host: 127.0.0.1\r\nContent-Length: 2\r\nTransfer-Encoding: chunked\r\n",
            b"Host: 127.0.0.1\r\nTransfer-Encoding: gzip\r\n",
            b"Host: 127.0.0.1\r\nContent-Length : 2\r\n",
            b"Host: 127.0.0.1\r\nContent-: 2\r\n Length\r\n",
            b"Host: 127.0.0.1\r\nX: a\x00b\r\nContent-Length: 2\r\n",
            b"Host: 127.0.0.1\r\n\x00Content-Length: 2\r\n",
            b"Host: 127.0.0.1\r\n: 2\r\nContent-Length: 2\r\n",
            b"Host: 127.0.0.1\r\nX: a\rContent-Length: 9\r\nContent-Length: 2\r\n",
            b"Host: 127.0.0.1\r\nTransfer-Encoding: gzip, chunked\r\n",
            b"Host: 127.0.0.1\r\nTransfer-Encoding: chunked\r\nTransfer-Encoding: gzip\r\n"))
        return (b"POST /v1/jobs HTTP/1.1\r\nContent-Type: application/json\r\n" + headers +
                b"\r\n{}")

    def cut_short(self):
        request = post("/v1/jobs", json.dumps(self.job).encode())
        return request[:self.chance.randrange(1, len(request))]

    def bad_header(self):
        extra = self.chance.choice((
            "Idempotency-Key: \r\n", "Idempotency-Key: %s\r\n" % ("k" * 300),
            "Idempotency-Key: a\tb\r\n", "X-Oriel-Client: %s\r\n" % ("c" * 300),
            "X-Oriel-Client: \xff\r\n", "Origin: http://elsewhere.example\r\n",
            "Idempotency-Key: \"\"\r\n"))
        return post("/v1/jobs", json.dumps(self.job).encode(), extra=extra)


def exceptions(request, cut):
    """The statuses that are none of ours, and still right; 0: closed without an answer."""
    version = re.match(rb"[^ \r\n]+ [^\r\n]* HTTP/(\d)\.\d\r\n", request)
    if version and version.group(1) != b"1":
        return (505,)
    hidden = re.match(rb"[^\r\n?]*\x00[^\r\n]*\?", request)  # a query behind a NUL
    return (0,) if cut or hidden or not re.match(rb"[^ \r\n]+ +[^ \r\n]", request) else ()


def ask(port, request, ends):
    """The status; 0 when the connection ends without an answer."""
    with socket.create_connection(("127.0.0.1", port), timeout=HANG_S) as connection:
        answer = b""
        try:
            connection.sendall(request)
            if ends:
                time.sleep(READ_S)
                connection.shutdown(socket.SHUT_WR)
        except OSError:
            pass  # refused before all was sent
        try:
            while chunk := connection.recv(1 << 16):
                answer += chunk
        except OSError:
            pass
    line = answer.split(b"\r\n", 1)[0].split()
    return int(line[1]) if len(line) > 1 else 0


def resident(pid):
    with open("/proc/%d/status" % pid, encoding="ascii") as stream:
        return next(int(line.split()[1]) << 10 for line in stream if line.startswith("RssAnon:"))


def run(daemon, arguments):
    sanitized = has_sanitizer(arguments.build)  # it is slow, and keeps memory of its own
    slow_s = SLOW_S * (5 if sanitized else 1)
    client = Client(daemon.port, "malformed")
    scene = upload_scene(client, FIRST_SCENE).json()["id"]
    client.close()
    chance = random.Random(arguments.seed)
    generate = Generator(scene, chance)
    statuses, slowest, early = {}, 0.0, 0
    for number in range(arguments.count):
        request = generate()
        started, before = time.monotonic(), computed_s(daemon.process.pid)
        cut = generate.last == generate.cut_short
        ends = cut or generate.last == generate.wrong_length
        status = ask(daemon.port, request, ends)
        took, computed = time.monotonic() - started, computed_s(daemon.process.pid) - before
        slowest = max(slowest, took)
        statuses[status] = statuses.get(status, 0) + 1
        if not (400 <= status < 500 or status in exceptions(request, cut)) or (
                computed > slow_s or took >= HANG_S):
            raise Failure("number %d: status %d after %.1f s, of which %.1f computed: %r ... %r" % (
                number, status, took, computed, request[:400], request[-100:]))
        if number == arguments.count // 2:
            early = resident(daemon.process.pid)
    growth = resident(daemon.process.pid) - early
    if not sanitized and growth > GROWTH_BYTES:
        raise Failure("the second half left %d bytes behind" % growth)
    if client.request("GET", "/v1/jobs").json()["jobs"]:
        raise Failure("one of them became a job")
    client.close()
    daemon.stop()
    print("malformed: %d requests, seed %d: %s; slowest %.2f s; memory %+.1f MiB over the second "
          "half" % (arguments.count, arguments.seed,
                    ", ".join("%d x %d" % (statuses[s], s) for s in sorted(statuses)), slowest,
                    growth / 2**20))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("build")
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    folder = tempfile.mkdtemp(prefix="oriel-malformed-")
    os.mkdir(os.path.join(folder, "data"))
    daemon = Daemon(arguments.build, os.path.join(folder, "data"), ["--threads", "1"])
    try:
        daemon.wait_listening()
        run(daemon, arguments)
    except Failure as failure:
        print("malformed: FAILED (seed %d): %s" % (arguments.seed, failure))
        return 1
    finally:
        if daemon.process.returncode is None:
            daemon.kill()
            daemon.wait()
        shutil.rmtree(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
