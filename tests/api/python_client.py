"""The Python package against a live daemon: one case a run, named by the first argument.

The others: the daemon's URL; a folder of its own; a certificate and a token to submit, or "" twice.
What a case asserts and does not find ends it with a traceback and status 1.
"""

import hashlib
import json
import math
import os
import pathlib
import shutil
import ssl
import threading
import urllib.request
import zipfile

from python_desk import JOB, OPENING, ROOM, WINDOW, oriel, raises, run_case


def whole_way(desk):
    seen = []
    out = os.path.join(desk.folder, "out")
    result = desk.client.render(os.path.join(desk.folder, "job.json"), out, progress=seen.append)
    assert result["state"] == "succeeded" and len(result["sensors"]) == 2
    assert all(sensor["illuminance_lx"] > 0 for sensor in result["sensors"])
    assert seen[-1]["state"] == "succeeded" and seen[-1]["percent"] == 100
    names = {file["name"]: file["bytes"] for file in seen[-1]["files"]}
    assert {"result.json", "north.hdr", "north.png", "filed.png"} <= set(names)
    assert set(os.listdir(out)) == set(names)
    for name, size in names.items():
        assert os.path.getsize(os.path.join(out, name)) == size
    with open(os.path.join(out, "result.json")) as stream:
        assert json.load(stream) == result
    assert desk.client.jobs(state="succeeded")[0]["id"] == seen[-1]["id"]
    assert desk.client.job(seen[-1]["id"]).status()["state"] == "succeeded"
    assert desk.client.limits()["views"] > 0 and desk.client.health()["status"] == "ok"
    assert isinstance(desk.client.maps(), list)


def upload_if_absent(desk):
    first = desk.client.upload_scene(["room.rad"], folder=desk.folder)
    assert desk.sent[-1] == "POST /v1/scenes" or len(desk.sent) == 1
    desk.sent.clear()
    assert desk.client.upload_scene(["room.rad"], folder=desk.folder) == first
    assert desk.sent == ["HEAD /v1/scenes/" + first]
    with open(os.path.join(desk.folder, "window.rad"), "a") as stream:
        stream.write("# another\n")
    desk.sent.clear()
    other = desk.client.upload_scene(["room.rad"], folder=desk.folder)
    assert other != first and desk.sent == ["HEAD /v1/scenes/" + other, "POST /v1/scenes"]
    # The id that the daemon found is the one worked out here, with names beyond ASCII too.
    with open(os.path.join(desk.folder, "b\u00fcro 1.rad"), "w") as stream:
        stream.write(WINDOW)
    desk.sent.clear()
    name = desk.client.upload_scene(["window.rad", "b\u00fcro 1.rad"], [], desk.folder)
    assert desk.sent == ["HEAD /v1/scenes/" + name, "POST /v1/scenes"]
    assert desk.client.upload_scene(["window.rad", "b\u00fcro 1.rad"], [], desk.folder) == name
    assert desk.sent[2:] == ["HEAD /v1/scenes/" + name]
    with open(os.path.join(desk.folder, 'a"b.rad'), "w") as stream:
        stream.write(WINDOW)
    raises(oriel.OrielError, desk.client.upload_scene, ['a"b.rad'], [], desk.folder)


def zips(desk):
    """A zip of a folder is the scene that its files are."""
    path = os.path.join(desk.folder, "scene.zip")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in ("window.rad", "room.rad"):
            archive.write(os.path.join(desk.folder, name), "folder/" + name)
    scene = desk.client.upload_zip(path)
    assert scene == desk.client.upload_scene(["room.rad"], ["window.rad"], desk.folder)
    assert scene == desk.client.upload_zip(path, ["room.rad"])
    error = raises(oriel.Problem, desk.client.upload_zip, path, ["absent.rad"])
    assert error.status == 422 and error.primitive == "main"


def skies(desk):
    """Weather files that skies name go along; each sky's files are fetched like any others."""
    weather = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../fixtures/weather.epw")
    shutil.copy(weather, os.path.join(desk.folder, "place.epw"))
    hour = {"month": 3, "day": 22}
    with open(os.path.join(desk.folder, "skyless.rad"), "w") as stream:
        stream.write(ROOM.replace("void glow sky_glow\n0\n0\n4 10 10 10 0\n", "")
                     .replace("sky_glow source sky\n0\n0\n4 0 0 1 180\n", ""))
    document = dict(JOB, gather_samples=16, scene={"files": ["skyless.rad"]}, skies={
        "weather": {"file": "place.epw"}, "from": dict(hour, hour=10.5), "to": dict(hour, hour=11.5)})
    output = os.path.join(desk.folder, "hours")
    result = desk.client.render(document, output, desk.folder)
    assert [sky["name"] for sky in result["skies"]] == ["0322-1030", "0322-1130"]
    assert all(len(sky["illuminance_lx"]) == 2 and not sky["dark"] for sky in result["skies"])
    assert os.path.exists(os.path.join(output, "0322-1130.north.hdr"))


def years(desk):
    """A year's files go along: weather, sensors, occupancy; what is made in folders stays in them."""
    weather = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../fixtures/weather.epw")
    shutil.copy(weather, os.path.join(desk.folder, "place.epw"))
    with open(os.path.join(desk.folder, "use.csv"), "w") as stream:
        stream.write("1\n" * 8760)
    with open(os.path.join(desk.folder, "skyless.rad"), "w") as stream:
        stream.write(ROOM.replace("void glow sky_glow\n0\n0\n4 10 10 10 0\n", "")
                     .replace("sky_glow source sky\n0\n0\n4 0 0 1 180\n", ""))
    document = {"kind": "annual", "scene": {"files": ["skyless.rad"]}, "weather": "place.epw",
                "grids": [{"name": "desks", "sensors": {"file": "sensors.txt"}},
                          {"name": "wall", "sensors": [[1.5, 2, 1.2, 0, -1, 0]]}],
                "occupancy": {"file": "use.csv"}, "samples": 16, "formats": ["honeybee"],
                "targets": ["sDA300/50 >= 1 %"]}
    output = os.path.join(desk.folder, "year")
    result = desk.client.render(document, output, desk.folder)
    assert [grid["sensors"] for grid in result["grids"]] == [2, 1]
    names = {one["name"] for one in result["provenance"]["inputs"]}
    assert names == {"skyless.rad", "window.rad", "place.epw", "sensors.txt", "use.csv"}
    for name in result["files"]:
        assert os.path.getsize(os.path.join(output, *name.split("/"))) > 0, name
    assert os.path.isfile(os.path.join(output, "results", "metrics", "da", "desks.da"))
    job = desk.client.job(desk.client.jobs()[0]["id"])
    for name in ("../x", "a/../x", "/x", "a//x", "", "a/.x", "a\\\\x", "c:x"):
        assert "outside" in str(raises(oriel.OrielError, job._fetch_file, pathlib.Path(output), name))


def bsdfs(desk):
    """Sent once, by themselves or with a scene; a scene then only names them."""
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../fixtures", "bsdf_klems41.xml")
    with open(path, "rb") as stream:
        data = stream.read()
    with open(os.path.join(desk.folder, "pane.xml"), "wb") as stream:
        stream.write(data)
    with open(os.path.join(desk.folder, "bsdf.rad"), "w") as stream:
        stream.write("void BSDF pane\n6 0 pane.xml 0 0 1 .\n0\n0\n" + OPENING)
    sha = desk.client.upload_bsdf(os.path.join(desk.folder, "pane.xml"))
    assert sha == hashlib.sha256(data).hexdigest()
    desk.sent.clear()
    assert desk.client.upload_bsdf(os.path.join(desk.folder, "pane.xml")) == sha
    assert desk.sent == ["HEAD /v1/bsdfs/" + sha]
    desk.sent.clear()
    scene = desk.client.upload_scene(["bsdf.rad"], folder=desk.folder)
    assert desk.sent == ["HEAD /v1/scenes/" + scene, "HEAD /v1/bsdfs/" + sha, "POST /v1/scenes"]
    assert desk.client.upload_scene(["bsdf.rad"], folder=desk.folder) == scene


def panels(desk):
    """A panel's BSDF is made, and a scene names it, though no file of it is here."""
    with open(os.path.join(desk.folder, "slats.rad"), "w") as stream:
        stream.write("void plastic p 0 0 5 .5 .5 .5 0 0\np polygon s 0 0 12 0 0 0 1 0 0 1 .7 -.7 0 .7 -.7\n")
    document = {"kind": "bsdf_make", "scene": {"files": ["slats.rad"]}, "basis": "klems_quarter", "paths": 64}
    output = os.path.join(desk.folder, "made")
    result = desk.client.render(document, output, desk.folder)
    id = result["bsdf"]["id"]
    with open(os.path.join(output, "bsdf.xml"), "rb") as stream:
        assert hashlib.sha256(stream.read()).hexdigest() == id
    with open(os.path.join(desk.folder, "made.rad"), "w") as stream:
        stream.write("void BSDF slats\n6 0 slats.xml 0 0 1 .\n0\n0\n" + OPENING.replace("pane", "slats", 1))
    scene = desk.client.upload_scene(["made.rad"], folder=desk.folder, bsdfs={"slats.xml": id})
    assert desk.client.upload_scene(["made.rad"], folder=desk.folder, bsdfs={"slats.xml": id}) == scene
    assert desk.client.render(document, None, desk.folder)["maps"][0]["cached"]


def measurements(desk):
    """Measurements travel like a scene, and a BSDF comes of them."""
    with open(os.path.join(desk.folder, "paper.csv"), "w") as stream:
        stream.write("theta_in,phi_in,theta_out,phi_out,bsdf\n")
        stream.writelines("%d,0,%d,%d,0.2\n" % (theta, out, phi)
                          for theta in (0, 40) for out in range(3, 90, 6) for phi in range(0, 360, 15))
    document = {"kind": "bsdf_fit", "measurements": {"files": ["paper.csv"]}, "basis": "klems_quarter"}
    result = desk.client.render(document, None, desk.folder)
    share = result["components"]["reflection_front"]["diffuse"]["value"]
    assert abs(share - 0.2 * math.pi) < 0.005, share  # the cosine's sum over six degrees
    assert desk.client.render(document, None, desk.folder)["maps"][0]["cached"]


def labels(desk):
    """Jobs by names and tags, in several pages; one by the beginning of its id."""
    scene = desk.client.upload_scene(["room.rad"], folder=desk.folder)
    document = {"scene": scene, "technique": "backward", "gather_samples": 4, "name": "of its own",
                "sensors": [[1.5, 1, 0.8, 0, 0, 1]]}
    jobs = [desk.client.submit(dict(document, seed=seed), name="Büro %d" % seed,
                               tags=["labels", "x, y"[:1], "%d" % (seed % 2)]) for seed in range(4)]
    jobs.append(desk.client.submit(document))
    names = [job["name"] for job in desk.client.jobs(tags=["labels", "1"], summary=True)]
    assert names == ["Büro 3", "Büro 1"]
    assert desk.client.job(jobs[-1].id[:12]).status()["name"] == "of its own"
    desk.sent.clear()
    paged = desk.client._transport.pages("/v1/jobs?tag=labels&limit=1", "jobs", 3)
    assert [job["name"] for job in paged] == ["Büro 3", "Büro 2", "Büro 1"]
    assert len(desk.sent) == 3 and "cursor=" in desk.sent[1]
    assert not desk.client.jobs(scene="0" * 64) and not desk.client.jobs(since="2999-01-01T00:00:00Z")
    raises(oriel.Problem, desk.client.submit, document, tags=["a,b"])
    seen, stream = [], desk.client.events(tags=["watched"])
    assert next(stream)[0] == "reset"
    watched = desk.client.submit(dict(document, seed=99), tags=["watched"])
    while "succeeded" not in seen:
        kind, job, last = next(stream)
        assert kind == "job" and job["id"] == watched.id and last
        seen.append(job["state"])
    stream.close()
    watched.remove()
    stream = desk.client.events(jobs=[watched.id], last_id=last)
    assert next(stream)[:2] == ("removed", {"id": watched.id})
    stream.close()
    raises(oriel.Problem, next, desk.client.events(tags=["a,b"]))
    plans = desk.client.plan(document)
    assert len(plans) == 1 and plans[0]["plan"]["technique"] == "backward"
    found = [one for one in desk.client.scenes() if one["id"] == scene]
    assert len(found) == 1 and found[0]["jobs"] >= 5
    assert isinstance(desk.client.bsdfs(), list)


def cancel(desk):
    job = desk.long_job()
    threading.Timer(0.3, job.cancel).start()
    raises(oriel.JobCancelled, job.wait, poll=0.05)
    assert job.status()["state"] == "cancelled"
    other = desk.long_job()
    raises(oriel.JobCancelled, other.wait, progress=lambda status: status["state"] != "running",
           poll=0.05)
    third = desk.long_job()
    raises(TimeoutError, third.wait, timeout=0.2, poll=0.05)
    assert third.status()["state"] in ("queued", "running")
    third.cancel()


def problems(desk):
    error = raises(oriel.Problem, desk.client.submit, {"scene": "0" * 64, "sedd": 1})
    assert error.status == 422 and "sedd" in str(error)
    error = raises(oriel.NotFound, desk.client.job("0" * 32).status)
    assert error.status == 404 and error.type == "urn:oriel:error:no-such-resource"
    with open(os.path.join(desk.folder, "wrong.rad"), "w") as stream:
        stream.write("void plastic grey\n0\n0\n5 0.5 0.5\n")
    error = raises(oriel.Problem, desk.client.upload_scene, ["wrong.rad"], folder=desk.folder)
    assert error.file == "wrong.rad" and error.line and error.detail and "wrong.rad:" in str(error)
    error = raises(oriel.OrielError, desk.client.upload_scene, ["absent.rad"], [], desk.folder)
    assert "absent.rad" in str(error)
    raises(oriel.OrielError, desk.client.upload_scene, ["absent.rad"], folder=desk.folder)
    away = oriel.Client("http://127.0.0.1:1", timeout=5)
    assert "127.0.0.1:1" in str(raises(oriel.Unreachable, away.health))
    assert isinstance(raises(oriel.OrielError, oriel.Client, "ftp://x"), oriel.OrielError)
    raises(oriel.OrielError, oriel.Client, "http://example.org", token="oriel_x")
    job = desk.long_job()
    error = raises(oriel.Problem, job.result)
    assert error.status == 409
    job.cancel()


def repeated_submission(desk):
    """A connection that breaks after the job was taken makes no second one."""
    scene = desk.client.upload_scene(["room.rad"], folder=desk.folder)
    before, send, broken = len(desk.client.jobs()), desk.client._transport.send, []

    def breaking(method, path, *rest, **named):
        answer = send(method, path, *rest, **named)
        if method == "POST" and not broken:
            broken.append(answer)
            raise oriel.Unreachable("broken")
        return answer

    desk.client._transport.send = breaking
    job = desk.client.submit({"kind": "render", "scene": scene, "technique": "backward",
                              "gather_samples": 16, "sensors": [[1.5, 1, 0.8, 0, 0, 1]]})
    assert broken and job.id == json.loads(broken[0][2].decode())["id"]
    assert len(desk.client.jobs()) == before + 1


def removal(desk):
    """What the daemon keeps goes, once nothing needs it; asked once more, it is not there."""
    client = desk.client
    job = desk.long_job()
    scene = job.status()["scene"]
    raises(oriel.InUse, job.remove)
    raises(oriel.InUse, client.remove_scene, scene)
    job.cancel()
    raises(oriel.JobCancelled, job.wait)
    job.remove()
    raises(oriel.NotFound, job.status)
    raises(oriel.NotFound, job.remove)
    small = client.submit({"kind": "render", "scene": scene, "technique": "gather",
                           "photons": {"global": 2000}, "sensors": [[1.5, 1, 0.8, 0, 0, 1]]})
    small.wait()
    kept = len(client.maps())
    first = client.maps()[0]
    client.remove_map(first["kind"], first["key"])
    assert len(client.maps()) == kept - 1
    client.remove_scene(scene)
    raises(oriel.NotFound, client.remove_scene, scene)
    raises(oriel.NotFound, client.remove_bsdf, "0" * 64)
    assert small.result()["state"] == "succeeded"
    raises(oriel.Problem, client.submit, {"scene": scene, "sensors": [[1, 1, 1, 0, 0, 1]]})


def tokens(desk):
    """Over HTTPS, to a daemon that asks for tokens."""
    assert desk.client.health()["status"] == "ok"
    desk.client.jobs()
    error = raises(oriel.Unauthorized, desk.connect("oriel_wrong").jobs)
    assert error.status == 401
    raises(oriel.Unauthorized, desk.connect("oriel_wrong").upload_scene, ["room.rad"],
           folder=desk.folder)
    raises(oriel.Unreachable, oriel.Client(desk.url, token=desk.token).health)  # who signed that?
    scene = desk.client.upload_scene(["room.rad"], folder=desk.folder)
    job = desk.client.submit({"scene": scene, "technique": "backward", "gather_samples": 4,
                              "sensors": [[1.5, 1, 0.8, 0, 0, 1]]})
    job.wait(poll=0.05)
    url = job.links(["result.json"], seconds=60)["result.json"]
    trusting = ssl.create_default_context(cafile=desk.ca_file)
    with urllib.request.urlopen(url, context=trusting) as reply:
        assert json.load(reply)["state"] == "succeeded"
    reader = desk.connect(os.environ["READ_TOKEN"])
    reader.jobs()
    raises(oriel.Forbidden, reader.submit, {"scene": "0" * 64})
    raises(oriel.Forbidden, reader.upload_bsdf, os.path.join(desk.folder, "sensors.txt"))


if __name__ == "__main__":
    run_case(globals())
