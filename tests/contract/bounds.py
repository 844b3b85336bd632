"""What is answered where there is too much of something, or too little left: streams, jobs, bytes, the
disk, files that were damaged.
"""

import os
import socket
import sqlite3
import time

from cases import NEVER, ROOM, SKY, VIEW, bsdf, events, sensors_of


def waiting(daemon):
    """A job that runs for good, and others behind it; more streams and jobs than there may be."""
    scene = daemon.upload(ROOM + SKY)
    daemon.wait(daemon.submit(sensors_of(scene)))
    blocker = daemon.submit(sensors_of(scene, photons={"global": NEVER}))
    daemon.wait(blocker, ("running",), lambda job: job["stage"] == "photons")
    same = daemon.submit(sensors_of(scene, photons={"global": NEVER}))
    events(daemon, blocker, 1)
    daemon.ask("DELETE", blocker, want=409)
    topped = [one for one in daemon.ask("GET", "/v1/maps").json["maps"] if one["in_use"]]
    daemon.ask("DELETE", "/v1/maps/%(kind)s/%(key)s" % topped[0], want=409)
    daemon.ask("DELETE", "/v1/scenes/" + scene, want=409)
    daemon.ask("GET", blocker + "/result", want=409)
    daemon.ask("GET", blocker + "/files/north.png", want=409)
    behind = daemon.submit(sensors_of(scene, seed=9))
    assert daemon.wait(behind, ("queued",))["queue_position"] == 1
    events(daemon, behind, 1)
    too_many_streams(daemon, behind)
    daemon.ask("POST", behind + "/cancel", want=200)
    daemon.ask("POST", same + "/cancel", want=200)
    full_queue(daemon, scene)
    daemon.ask("POST", blocker + "/cancel", want=202)


def too_many_streams(daemon, path):
    """429: of streams."""
    request = ("GET %s/events HTTP/1.1\r\nHost: localhost\r\n\r\n" % path).encode()
    streams = []
    for _ in range(daemon.ask("GET", "/v1/limits").json["event_streams"]):
        streams.append(socket.create_connection(("127.0.0.1", daemon.port), timeout=60))
        streams[-1].sendall(request)
    for stream in streams:  # one whose client has gone may count until it is written to
        assert stream.recv(12) in (b"HTTP/1.1 200", b"HTTP/1.1 429")
    daemon.ask("GET", path + "/events", want=429)
    daemon.ask("GET", "/v1/events", want=429)
    for stream in streams:
        stream.close()


def full_queue(daemon, scene):
    """429: of jobs. readyz says so too."""
    job, connections, taken = sensors_of(scene, seed=10), [daemon.connect() for _ in range(16)], True
    while taken:  # many at once: the disk is waited for once for all of them
        for connection in connections:
            daemon.send("POST", "/v1/jobs", job, connection=connection)
        answers = [daemon.receive("POST", "/v1/jobs", connection=connection) for connection in connections]
        taken = all(answer.status == 202 for answer in answers)
    for connection in connections:
        connection.close()
    daemon.ask("POST", "/v1/jobs", sensors_of(scene, seed=10), want=429)
    daemon.ask("GET", "/readyz", want=503)


def damage(daemon):
    """500: what is stored is gone or cannot be written. The last thing that happens to a daemon."""
    scene = daemon.upload(ROOM + SKY)
    item = daemon.ask("POST", "/v1/bsdfs", bsdf("bsdf_klems41.xml")).id
    path = daemon.submit(sensors_of(scene))
    job = daemon.wait(path)
    found = daemon.ask("GET", "/v1/maps", want=200).json["maps"][0]
    os.rename(os.path.join(daemon.folder, "results", job["id"]),
              os.path.join(daemon.folder, "lost"))
    daemon.ask("GET", path + "/result", want=500)
    daemon.ask("GET", path + "/files/result.json", want=500)
    with sqlite3.connect(os.path.join(daemon.folder, "oriel.db"), timeout=30) as database:
        for table in ("scenes", "bsdfs", "listed_bsdfs", "jobs", "maps"):
            database.execute("ALTER TABLE %s RENAME TO lost_%s" % (table, table))
    database.close()
    daemon.ask("GET", "/v1/scenes/" + scene, want=500)
    daemon.ask("GET", "/v1/bsdfs/" + item, want=500)
    daemon.ask("GET", "/v1/scenes/%s/outline" % scene, want=500)
    daemon.ask("GET", "/v1/bsdfs/%s/polar" % item, want=500)
    daemon.ask("GET", "/v1/scenes", want=500)
    daemon.ask("GET", "/v1/bsdfs", want=500)
    daemon.ask("POST", "/v1/bsdfs", bsdf("bsdf_klems41.xml"), want=500)
    daemon.ask("POST", "/v1/scenes", {"files": [{"name": "r.rad", "text": ROOM}]}, want=500)
    daemon.ask("POST", "/v1/jobs", sensors_of(scene), want=500)
    with sqlite3.connect(os.path.join(daemon.folder, "oriel.db"), timeout=30) as database:
        database.execute("ALTER TABLE scene_files RENAME TO lost_scene_files")
    database.close()
    daemon.ask("POST", "/v1/plans", sensors_of(scene), want=500)
    for thing in ("/v1/scenes/" + scene, "/v1/bsdfs/" + item, path,
                  "/v1/maps/%(kind)s/%(key)s" % found):
        daemon.ask("DELETE", thing, want=500)


def storage(daemon):
    """410 and 507, of a daemon with little room."""
    scene = daemon.upload(ROOM + SKY)
    first, jobs, status = None, 0, 202
    while not first or "evicted" not in daemon.ask("GET", first).json:
        jobs += 1
        path = daemon.submit(sensors_of(scene, seed=jobs, views=[VIEW]))
        assert daemon.wait(path)["state"] == "succeeded" and jobs < 30
        first = first or path
        daemon.ask("GET", path + "/result")
    daemon.ask("GET", first + "/result", want=410)
    daemon.ask("GET", first + "/files/north.hdr", want=410)
    while status == 202:  # nobody asks for these
        jobs += 1
        answer = daemon.ask("POST", "/v1/jobs", sensors_of(scene, seed=jobs, views=[VIEW]))
        status = answer.status
        if status == 202:
            daemon.wait("/v1/jobs/" + answer.id)
        assert jobs < 60
    assert status == 507
    daemon.ask("POST", "/v1/scenes", {"files": [{"name": "l.rad", "text": ROOM + "#" * 200000}]},
               want=507)
    daemon.ask("POST", "/v1/bsdfs", bsdf("bsdf_klems41.xml") + b" " * 200000, want=507)


def too_much_under_way(daemon):
    """429, of one client's uploads among several clients."""
    daemon.header = {"Authorization": "Bearer " + daemon.token["submit"]}
    with socket.create_connection(("127.0.0.1", daemon.port)) as first:
        first.sendall(("POST /v1/bsdfs HTTP/1.1\r\nHost: a\r\nAuthorization: %s\r\n"
                       "Expect: 100-continue\r\nContent-Length: %d\r\n\r\n"
                       % (daemon.header["Authorization"], 7 << 20)).encode())
        assert first.recv(12) == b"HTTP/1.1 100"  # its length counts from here on
        for path, kind in (("/v1/scenes", "application/zip"), ("/v1/bsdfs", "application/xml"),
                           ("/v1/plans", "application/json")):
            daemon.announce("POST", path, {"Content-Type": kind, "Content-Length": str(2 << 20),
                                           "Expect": "100-continue"}, want=429)


def full_disk(daemon, fill):
    """507, of a disk that is full from fill(True) to fill(False)."""
    daemon.header = {"Authorization": "Bearer " + daemon.token["admin"]}
    scene = daemon.upload(ROOM + SKY)
    other = daemon.upload(ROOM + SKY + "# other\n")
    item = daemon.ask("POST", "/v1/bsdfs", bsdf("bsdf_klems41.xml")).id
    path = daemon.submit(sensors_of(scene))
    daemon.wait(path)
    found = daemon.ask("GET", "/v1/maps", want=200).json["maps"][0]
    things = (path, "/v1/scenes/" + other, "/v1/bsdfs/" + item,
              "/v1/maps/%(kind)s/%(key)s" % found)
    fill(True)
    for method, where, body in (
            ("POST", "/v1/scenes", {"files": [{"name": "l.rad", "text": ROOM + "# full"}]}),
            ("POST", "/v1/bsdfs", bsdf("bsdf_klems41.xml") + b"<!-- full -->"),
            ("POST", "/v1/jobs", sensors_of(scene, seed=2)), ("POST", "/v1/session", None), ("POST", "/v1/plans", sensors_of(scene)),
            *(("DELETE", thing, None) for thing in things)):
        answer = daemon.ask(method, where, body, want=507)
        assert answer.json["type"] == "urn:oriel:error:disk-full", answer.body
    fill(False)
    assert daemon.wait(daemon.submit(sensors_of(scene, seed=2)))["state"] == "succeeded"
    for thing in things:
        daemon.ask("DELETE", thing, want=204)


def busy_upload(daemon):
    """Keeps a pool thread busy for a while, taking parts apart: the returned function waits for
    that. (Checks would not do: they end when the daemon stops.)"""
    connection = daemon.connect()
    body = (b'--bb\r\nContent-Disposition: form-data; name="f"; filename="big.rad"\r\n\r\n' +
            b"#" * (256 << 20) + b"\r\n--bb--\r\n")
    connection.request("POST", "/v1/scenes", body,
                       {"Content-Type": "multipart/form-data; boundary=bb"})
    until = time.monotonic() + daemon.patience_s
    while b"\noriel_pool_requests 0\n" in daemon.ask("GET", "/metrics").body:
        assert time.monotonic() < until, "the upload is not on the pool"
        time.sleep(0.005)
    return lambda: connection.getresponse().read()
