"""What strangers do to a daemon in siege.py: each attack is a function that goes on until its process
is ended, with a port and the headers of a token of its own."""

import base64
import http.client
import io
import json
import os
import random
import select
import signal
import socket
import time
import zipfile

MIB = 1 << 20
_HEAD = "%s %s HTTP/1.1\r\nHost: localhost\r\n%s\r\n"
SLOW, STREAMS, FLOODERS = 200, 200, 16


def _dial(port):
    connection = socket.create_connection(("127.0.0.1", port), timeout=20)
    connection.setblocking(False)
    return connection


def _send(connection, data):
    """As much as goes at once. False: the connection has ended."""
    try:
        connection.send(data)
    except BlockingIOError:
        pass
    except OSError:
        return False
    return True


def _drain(connection):
    """False: the other side has hung up."""
    try:
        while True:
            if not connection.recv(1 << 16):
                return False
    except BlockingIOError:
        return True
    except OSError:
        return False


def _keep_open(port, count, begin, go_on, pause_s=0.1):
    """So many connections, each begun anew when it is cut off."""
    open_ones = []
    while True:
        open_ones = [one for one in open_ones if _drain(one)]
        for _ in range(min(count - len(open_ones), 20)):
            try:
                one = _dial(port)
            except OSError:
                break
            _send(one, begin(len(open_ones)))
            open_ones.append(one)
        for one in open_ones:
            _send(one, go_on())
        time.sleep(pause_s)


# ---- Connections -----------------------------------------------------------------------------

def malformed(port, token):
    """Requests that are wrong or never end, all kept open."""
    auth = "Authorization: %s\r\n" % token["Authorization"]
    chunked = "Transfer-Encoding: chunked\r\n"
    kinds = [
        _HEAD % ("GET", "/healthz", chunked) + "1;" + "x" * 33000,
        _HEAD % ("GET", "/healthz", chunked) + "1;" + "x" * 100000,
        _HEAD % ("POST", "/v1/bsdfs", auth + chunked) + "fffffff\r\n<",
        _HEAD % ("POST", "/v1/bsdfs", auth + chunked) + "zz\r\n",
        _HEAD % ("POST", "/v1/scenes", auth + "Content-Length: 1000000\r\n") + "{",
        _HEAD % ("POST", "/v1/jobs", auth + "Content-Length : 2\r\n") + "{}",
        "GET /healthz HTTP/1.1\r\nHost: localhost\r\nX: ", "GET /" + "a" * 30000,
        "GET /v1/jobs?" + "a&" * 5000 + " HTTP/1.1\r\nHost: localhost\r\n\r\n",
        "GET /healthz HTTP/1.1\r\n\0Host: localhost\r\n\r\n", "\x16\x03\x01\x02\0\x01", "",
        _HEAD % ("PUT", "/nowhere", "Content-Length: 500000000\r\n") + "x" * 1000,
    ]
    _keep_open(port, 130, lambda i: kinds[i % len(kinds)].encode("latin-1"), lambda: b"x")


def slow_clients(port, token):
    """Silent, or a byte now and then, in the headers or in the body."""
    auth = "Authorization: %s\r\n" % token["Authorization"]
    kinds = ["", "GET /healthz HTTP/1.1\r\nHost: localhost\r\nX-Slow: ",
             _HEAD % ("POST", "/v1/bsdfs", auth + "Content-Length: 100000\r\n") + "<"]
    _keep_open(port, SLOW, lambda i: kinds[i % 3].encode(), lambda: b"x", 0.25)


def healthz_flood(port, _token):
    """As many requests as are answered, on several connections."""
    burst = (_HEAD % ("GET", "/healthz", "")).encode() * 64
    poll, ones = select.poll(), {}
    while True:
        while len(ones) < FLOODERS:
            one = _dial(port)
            ones[one.fileno()] = one
            poll.register(one, select.POLLIN | select.POLLOUT)
        for fd, _ in poll.poll(1000):
            if not _drain(ones[fd]) or not _send(ones[fd], burst):
                poll.unregister(fd)
                ones.pop(fd).close()


def streams(port, token):
    """Event streams of one job."""
    path = submit(port, token, upload(port, token, ROOM), seed=1)
    text = (_HEAD % ("GET", path + "/events", "Authorization: %s\r\n" % token["Authorization"]))
    _keep_open(port, STREAMS, lambda i: text.encode(), lambda: b"", 0.25)


def listings(port, token):
    """What takes long to tell."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    while True:
        for path in ("/v1/jobs?limit=1000", "/metrics", "/v1/maps", "/v1/limits", "/openapi.yaml"):
            _ask(connection, "GET", path, None, token)


def twins(port, token):
    """Identical jobs, and cancels of them."""
    scene = upload(port, token, ROOM)
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    for seed in range(1 << 30):
        for _ in range(40):
            path = submit(port, token, scene, seed=seed, connection=connection)
            if path and random.random() < 0.3:
                _ask(connection, "POST", path + "/cancel", None, token)
        time.sleep(0.2)


def endless_uploads(port, token):
    """Bodies without a length, as large as may be."""
    begin = (_HEAD % ("POST", "/v1/bsdfs", "Authorization: %s\r\nTransfer-Encoding: chunked\r\n" %
                      token["Authorization"])).encode()
    chunk = b"10000\r\n" + b" " * 65536 + b"\r\n"
    _keep_open(port, 8, lambda i: begin, lambda: chunk, 0.02)


# ---- Bombs: small to send, much to read --------------------------------------------------------

def _zip(entries):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in entries:
            archive.writestr(name, data)
    return stream.getvalue()


def _star(corners):
    """An outline that crosses itself at every edge."""
    points = " ".join("%d %d 0" % (i * 7919 % corners, i * i % corners) for i in range(corners))
    return "grey polygon p 0 0 %d %s\n" % (3 * corners, points)


def _scene(*files):
    return json.dumps({"files": [
        {"name": name, "text": text} for name, text in files]}).encode()


def bombs():
    """(path, type, body); the first six are known ways, the others more of the kind."""
    grey = "void plastic grey 0 0 5 .5 .5 .5 0 0\n"
    ball = "grey sphere s 0 0 4 0 0 0 .1\n"
    scene, kind = "/v1/scenes", "application/json"
    yield scene, kind, _scene(("a.rad", grey + "!xform -n %s -a 5000000 -t 0 0 1 b.rad\n" %
                               ("x" * 450)), ("b.rad", ball))
    yield "/v1/jobs", kind, b"[" + b"{}," * (5 * MIB) + b"{}]"
    yield scene, kind, _scene(("a.rad", grey + _star(19000)))
    yield scene, kind, _scene(("a.rad", "".join("void plastic n%d 0 0 5 .5 .5 .5 0 0\n" % i
                                                for i in range(40000))))
    yield "/v1/bsdfs", "application/xml", b"<?xml version='1.0'?><!--" + b" " * (20 * MIB)
    yield scene, kind, _scene(("a.rad", grey + "!xform -a 20000 %s b.rad\n" % ("-rx 1 " * 3000)),
                              ("b.rad", ball))
    yield scene, "application/zip", _zip([("a.rad", b"\n" * (60 * MIB))])
    yield scene, "application/zip", _zip([("%d.rad" % i, b"#") for i in range(4000)])
    yield scene, kind, b'{"files":' + b"[" * 100000
    yield scene, kind, _scene(("a.rad", grey + "!genbox grey b 1 1 1 -r .1\n" * 100000))
    yield scene, kind, _scene(*[("%d.rad" % i, "!xform -a 20 %d.rad\n" % (i + 1))
                                for i in range(6)], ("6.rad", grey + ball))
    yield scene, kind, _scene(("a.rad", "void plastic " + "x" * (10 * MIB)))
    yield scene, kind, json.dumps({"files": [{"name": "a.rad", "base64": base64.b64encode(
        b"( " * (4 * MIB)).decode()}]}).encode()
    yield "/v1/jobs", kind, json.dumps({"scene": "0" * 64, "sensors": [[0, 0, 0, 0, 0, 1]] *
                                        200000}).encode()
    yield "/v1/bsdfs", "application/xml", b"<WindowElement>" + b"<Layer>" * 1000000
    yield scene, "multipart/form-data; boundary=b", b"--b\r\nContent-Disposition: form-data; " \
        b"name=\"main\"\r\n\r\na.rad\r\n" * 30000 + b"--b--\r\n"


def _bombing(port, token, which):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=300)
    ready = list(bombs())[which]
    while True:
        for path, kind, body in ready:
            _ask(connection, "POST", path, body, dict(token, **{"Content-Type": kind}))


def known_bombs(port, token):
    """Those that once stopped a daemon."""
    _bombing(port, token, slice(0, 6))


def other_bombs(port, token):
    """More of the kind."""
    _bombing(port, token, slice(6, None))


# ---- Jobs -----------------------------------------------------------------------------------

def _is_ended(text):
    return any(b'"%s"' % state in text for state in (b"succeeded", b"failed", b"cancelled"))


def _wait_by_events(port, token, path):
    """Until the job's events say that it has ended, or they end themselves."""
    auth = "Authorization: %s\r\n" % token["Authorization"]
    stream = socket.create_connection(("127.0.0.1", port), timeout=60)
    stream.sendall((_HEAD % ("GET", path + "/events", auth)).encode())
    text = b""
    while not _is_ended(text):
        more = stream.recv(1 << 16)
        if not more:
            break
        text = (text + more)[-(1 << 16):]
    stream.close()


def early_fetches(port, token):
    """Results and files, asked for the moment that events say a job has ended; hung up at random."""
    auth = "Authorization: %s\r\n" % token["Authorization"]
    scene = upload(port, token, ROOM)
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    fetches = [socket.create_connection(("127.0.0.1", port), timeout=60) for _ in range(8)]
    for seed in range(1 << 30):
        path = submit(port, token, scene, seed=seed, connection=connection, samples=8)
        if not path:
            time.sleep(0.2)
            continue
        _wait_by_events(port, token, path)
        which = seed % len(fetches)
        for name in ("/result", "/files/result.json", "/files/none.hdr"):
            if not _send(fetches[which], (_HEAD % ("GET", path + name, auth)).encode()) or \
                    random.random() < 0.3:
                fetches[which].close()
                fetches[which] = socket.create_connection(("127.0.0.1", port), timeout=60)
            elif random.random() < 0.5:
                fetches[which].recv(1 << 16)


_WEATHER = "place x\nlatitude 47\nlongitude -8\ntime_zone -15\nsite_elevation 0\n" \
    "weather_data_file_units 1\n3 21 11.5 800 100\n"


def _year_scene(connection, token, files):
    """The id of a scene whose first file alone is a main one."""
    document = {"files": [dict({"name": name, "text": text}, resource=i > 0)
                          for i, (name, text) in enumerate(files)]}
    status, body = _ask(connection, "POST", "/v1/scenes", json.dumps(document).encode(),
                        dict(token, **{"Content-Type": "application/json"}))
    return json.loads(body)["id"] if status in (200, 201) else None


def _post_year(connection, token, document):
    """The path of the job, or None where it is refused."""
    status, body = _ask(connection, "POST", "/v1/jobs", json.dumps(document).encode(),
                        dict(token, **{"Content-Type": "application/json"}))
    return "/v1/jobs/" + json.loads(body)["id"] if status == 202 else None


def state_file_bombs(port, token):
    """Years whose states of shades are small files that make millions of surfaces."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=300)
    bomb = "".join("!xform -a 100000 -t .003 %d 0 slat.rad\n" % i for i in range(4))
    scene = _year_scene(connection, token, [
        ("room.rad", ROOM.split("void glow")[0] + ROOM.split("180\n")[1]), ("place.wea", _WEATHER),
        ("one.rad", bomb), ("two.rad", "!xform -t 0 0 1 one.rad\n"),
        ("slat.rad", 8 * "grey sphere s 0 0 4 .1 .1 .1 .001\n")])
    while scene:
        _post_year(connection, token, {
            "kind": "annual", "scene": scene, "weather": "place.wea",
            "sensors": [[1, 1, 1, 0, 0, 1]], "shades": [{"name": "south", "states": [
                {"name": "open"}, {"name": "half", "files": ["one.rad"]},
                {"name": "shut", "files": ["one.rad", "two.rad"]}]}]})


def glare_seats(port, token):
    """A seat between sixty half-mirrors, for which light has many ways; cancelled after a while."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    panes = "".join("half polygon pane%d 0 0 12 -50 %d -50 50 %d -50 50 %d 50 -50 %d 50\n" %
                    ((i,) + (i + 1,) * 4) for i in range(60))
    text = "void trans half 0 0 7 1 1 1 .5 0 1 1\n" + panes
    scene = _year_scene(connection, token, [("panes.rad", text), ("place.wea", _WEATHER)])
    while scene:
        path = _post_year(connection, token, {
            "kind": "annual", "scene": scene, "weather": "place.wea",
            "sensors": [[0, 0, 0, 0, 0, 1]], "glare": {"seats": [
                {"at": [0, 0, 0], "towards": [0, 1, 0]}]}})
        time.sleep(random.uniform(0.2, 3))
        if path:
            _ask(connection, "POST", path + "/cancel", None, token)


def hangup_storms(_port, _token):
    """SIGHUP, by which the daemon reads its certificate anew, many times a second."""
    daemon = int(os.environ["SIEGE_DAEMON"])
    while True:
        try:
            os.kill(daemon, signal.SIGHUP)
        except ProcessLookupError:
            pass
        time.sleep(0.002)


# ---- Shared ----------------------------------------------------------------------------------

ROOM = """void plastic grey 0 0 5 .5 .5 .5 0 0
void glow sky_glow 0 0 4 10 10 10 0
sky_glow source sky 0 0 4 0 0 1 180
grey polygon floor 0 0 12 0 0 0 3 0 0 3 4 0 0 4 0
"""


def _ask(connection, method, path, body, headers):
    """The answer's status and body; 0 when there is none."""
    try:
        connection.request(method, path, body, headers)
        answer = connection.getresponse()
        return answer.status, answer.read()
    except (OSError, http.client.HTTPException):
        connection.close()
        return 0, b""


def upload(port, token, text):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    while True:
        status, body = _ask(connection, "POST", "/v1/scenes", _scene(("room.rad", text)),
                            dict(token, **{"Content-Type": "application/json"}))
        if status in (200, 201):
            return json.loads(body)["id"]
        time.sleep(0.5)


def submit(port, token, scene, seed, connection=None, samples=2000):
    """The job's path, or None where it is refused."""
    connection = connection or http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    document = {"scene": scene, "seed": seed, "technique": "backward", "gather_samples": samples,
                "sensors": [[1, 1, 1, 0, 0, 1]] * 20}
    status, body = _ask(connection, "POST", "/v1/jobs", json.dumps(document).encode(),
                        dict(token, **{"Content-Type": "application/json"}))
    return "/v1/jobs/" + json.loads(body)["id"] if status == 202 else None


ATTACKS = (malformed, slow_clients, healthz_flood, streams, listings, twins, endless_uploads,
           known_bombs, other_bombs, early_fetches, state_file_bombs, hangup_storms, glare_seats)


def run(attack, port, token):
    """In a process of its own, behind the daemon in the machine's favour."""
    os.nice(10)
    while True:
        try:
            attack(port, token)
        except (OSError, ValueError, KeyError):
            time.sleep(0.2)
