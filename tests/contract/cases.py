"""What each resource answers: one function a group of cases; run.py has their order, bounds.py what is
answered where there is too much, or too little left.

A new status or route: api/openapi first, then a few lines here that provoke it; what has not
been provoked is listed at the end and fails the test.
"""

import base64
import io
import json
import os
import re
import sqlite3
import zipfile

from daemons import Answer
from every import UNKNOWN

ROOM = """void plastic grey 0 0 5 .5 .5 .5 0 0
void glass pane 0 0 3 .9 .9 .9
grey polygon floor 0 0 12 0 0 0 3 0 0 3 4 0 0 4 0
grey polygon top 0 0 12 0 0 3 0 4 3 3 4 3 3 0 3
grey polygon west 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3
grey polygon east 0 0 12 3 0 0 3 0 3 3 4 3 3 4 0
grey polygon north 0 0 12 0 4 0 3 4 0 3 4 3 0 4 3
pane polygon window 0 0 12 3 0 0 0 0 0 0 0 3 3 0 3
"""
SKY = "void glow sky_glow 0 0 4 10 10 10 0\nsky_glow source sky 0 0 4 0 0 1 180\n"
MEASURED = "theta_in,phi_in,theta_out,phi_out,bsdf\n" + "".join(
    "%d,0,%d,%d,0.2\n" % (theta, out, phi) for theta in (0, 40) for out in range(3, 90, 6) for phi in range(0, 360, 15))
PANEL = "void plastic p 0 0 5 .5 .5 .5 0 0\np polygon s 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n"
SENSORS = [[1.5, 1, 0.8, 0, 0, 1], [1.5, 3, 0.8, 0, 0, 1]]
VIEW = {"name": "north", "view": "-vtv -vp 1.5 .5 1.5 -vd 0 1 0", "width": 16, "height": 12}
FIXTURES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../fixtures")
NEVER = 100000000  # photons: more than any test waits for


def bsdf(name):
    with open(os.path.join(FIXTURES, name), "rb") as stream:
        return stream.read()


def zipped(*names_and_texts):
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as writer:
        for name, text in zip(names_and_texts[::2], names_and_texts[1::2]):
            writer.writestr(name, text)
    return archive.getvalue()


def service(daemon):
    daemon.ask("POST", "/v1/session", want=409)
    daemon.ask("DELETE", "/v1/session", want=204)
    for path in ("/", "/healthz", "/readyz", "/metrics", "/openapi.yaml", "/v1/limits",
                 "/v1/session"):
        daemon.ask("GET", path, want=200)
        daemon.ask("HEAD", path, want=200)
    dashboard(daemon)
    guide(daemon)
    limits = daemon.ask("GET", "/v1/limits").json
    schemas = daemon.contract.document["components"]["schemas"]
    false_color, heat_map = (schemas[name]["properties"] for name in ("FalseColor", "HeatMap"))
    for bound, documented in (("picture_points", false_color["points"]["maxItems"]),
                              ("scale_divisions", schemas["Divisions"]["maximum"]),
                              ("heat_map_thresholds", heat_map["thresholds"]["maxItems"])):
        assert limits[bound] == documented, (bound, limits[bound], documented)


def dashboard(daemon):
    """The page by its Accept, plain and packed, and the files that it names."""
    browser = {"Accept": "text/html,application/xml;q=0.9,*/*;q=0.8"}
    page = daemon.ask("GET", "/", headers=browser, want=200)
    files = set(re.findall('/dashboard/[^"]+', page.body.decode()))
    assert {name.rsplit(".", 1)[1] for name in files} == {"css", "js", "svg"}, files
    folder = min(files).rsplit("/", 1)[0]
    for path in ("/", folder + "/index.html", *files):
        tag = daemon.ask("GET", path, headers=browser, want=200).headers["etag"]
        packed = daemon.ask("GET", path, headers={**browser, "Accept-Encoding": "gzip"}, want=200)
        assert (packed.headers["etag"] == tag) == ("content-encoding" not in packed.headers)
        daemon.ask("GET", path, headers={**browser, "If-None-Match": tag}, want=304)
        daemon.ask("HEAD", path, headers=browser, want=200)
    assert daemon.ask("GET", "/", headers={"Accept": "*/*"}).json["service"] == "oriel"


def guide(daemon):
    """All pages of the guide, by their links, and their pictures; searches; the module."""
    browser = {"Accept": "text/html,*/*;q=0.8"}
    left, seen = ["/guide", "/guide/index", "/guide/search", "/guide/search?q=light", "/oriel.js"], set()
    while left:
        path = left.pop()
        seen.add(path)
        page = daemon.ask("GET", path, headers=browser, want=200)
        tag = page.headers["etag"]
        daemon.ask("GET", path, headers={**browser, "If-None-Match": tag}, want=304)
        daemon.ask("HEAD", path, headers=browser, want=200)
        if page.headers["content-type"].startswith("text/html"):
            links = re.findall('(?:href|src)="(/guide[^"#]*)', page.body.decode())
            left += sorted(set(links) - seen - set(left))
    assert len(seen) > 5, seen
    packed = {"Accept-Encoding": "gzip"}
    assert daemon.ask("GET", "/oriel.js", headers=packed).headers["content-encoding"] == "gzip"
    for query in ("", "?q=%22", "?q=NEAR(", "?q=" + "x" * 5000, "?q=%FF%00", "?q=a&q=b", "?q"):
        answer = daemon.ask("GET", "/guide/search" + query, want=200)
        assert b'role="status"' in answer.body and b"<script" not in answer.body
    for path in ("/guide/" + UNKNOWN, "/guide/howto/" + UNKNOWN, "/guide/%3Cscript%3E"):
        assert daemon.ask("GET", path, want=404).json["type"].endswith("no-such-resource")
        page = daemon.ask("GET", path, headers=browser, want=404)
        assert b"No such page" in page.body and b"<script" not in page.body


def scenes(daemon):
    first = daemon.ask("POST", "/v1/scenes", {"files": [{"name": "r.rad", "text": ROOM + SKY}]},
                       want=201)
    daemon.ask("POST", "/v1/scenes", {"files": [{"name": "r.rad", "text": ROOM + SKY}]}, want=200)
    path = "/v1/scenes/" + first.id
    assert first.headers["location"] == path
    looks(daemon, path + "/outline", ("", "?height=-1", "?height=1.5"), ("x", "1e99", ""), "height")
    other = daemon.upload(ROOM + "# to be removed\n")
    daemon.ask("DELETE", "/v1/scenes/" + other, want=204)
    daemon.ask("GET", path, want=200)
    daemon.ask("HEAD", path, want=200)
    daemon.ask("GET", path, headers={"If-None-Match": first.headers["etag"]}, want=304)
    boundary = "frontier"
    form = "".join('--%s\r\nContent-Disposition: form-data; name="%s"; filename="%s"\r\n\r\n%s\r\n'
                   % (boundary, *part) for part in (("file", "f.rad", ROOM + "# form\n"),
                                                    ("resource", "t.txt", "1 1 1 0 0 1\n")))
    kind = {"Content-Type": "multipart/form-data; boundary=" + boundary}
    daemon.ask("POST", "/v1/scenes", form + "--%s--\r\n" % boundary, kind, want=201)
    daemon.ask("POST", "/v1/scenes", form, kind, want=400)
    for files in ([], [{"name": "../r.rad", "text": ROOM}], [{"name": "r.rad", "text": "void x"}],
                  [{"name": "r.rad", "text": "a BSDF b 6 0 absent.xml 0 0 1 . 0 0\n"}],
                  [{"name": "r.rad", "text": "void prism1 a 0 0 0\na sphere s 0 0 4 0 0 0 1\n"}]):
        assert daemon.ask("POST", "/v1/scenes", {"files": files}).status in (400, 422)
    daemon.ask("POST", "/v1/scenes", {"files": [], "other": 1}, want=422)
    stored_lists(daemon, "scenes")
    zips(daemon, first)


def looks(daemon, path, queries, wrong, argument):
    """What is made of a stored thing to be looked at."""
    for query in queries:
        assert "max-age" in daemon.ask("GET", path + query, want=200).headers["cache-control"]
    for text in wrong:
        daemon.ask("GET", "%s?%s=%s" % (path, argument, text), want=400)


def plans(daemon):
    """Of a job, of one of two skies, of one that is none."""
    scene, dark = daemon.upload(ROOM + SKY), daemon.upload(ROOM)
    found = daemon.ask("POST", "/v1/plans", sensors_of(scene, views=[VIEW]), want=200).json
    assert len(found["plans"]) == 1 and found["plans"][0]["plan"]["technique"] == "gather"
    curve = found["plans"][0]["curve"]["points"]
    assert len(curve) > 1 and all(a["error"] > b["error"] and a["seconds"] <= b["seconds"]
                                  for a, b in zip(curve, curve[1:]))
    cie = {"name": "grey", "cie": {"type": "overcast", "diffuse_horizontal_lx": 10000}}
    several = sensors_of(dark, skies=[cie, {**cie, "name": "gray"}])
    found = daemon.ask("POST", "/v1/plans", several, want=200).json
    assert [one["sky"] for one in found["plans"]] == ["grey", "gray"]
    daemon.ask("POST", "/v1/plans", sensors_of(UNKNOWN), want=422)
    daemon.ask("POST", "/v1/plans", {"kind": "study", "scene": scene}, want=422)
    daemon.ask("POST", "/v1/plans", sensors_of(scene, seed=-1), want=422)


def stored_lists(daemon, name):
    """All of them, by pages of one; 400 for what is no cursor or limit."""
    path, found = "/v1/%s?limit=1" % name, []
    while path:
        answer = daemon.ask("GET", path, want=200)
        found += answer.json[name]
        path = answer.headers["link"][1:].split(">")[0] if answer.json["more"] else None
    assert found == daemon.ask("GET", "/v1/" + name, want=200).json[name] and len(found) > 1
    for query in ("cursor=x", "cursor=1-2", "limit=0"):
        daemon.ask("GET", "/v1/%s?%s" % (name, query), want=400)


def zips(daemon, same):
    """The scene once more, as a zip; one that climbs out; one that is cut short."""
    kind = {"Content-Type": "application/zip"}
    folder, climbing = zipped("folder/r.rad", ROOM + SKY), zipped("../r.rad", ROOM)
    assert daemon.ask("POST", "/v1/scenes", folder, kind, want=200).id == same.id
    assert daemon.ask("POST", "/v1/scenes?main=r.rad", folder, kind, want=200).id == same.id
    daemon.ask("POST", "/v1/scenes?main=absent.rad", folder, kind, want=422)
    daemon.ask("POST", "/v1/scenes", climbing, kind, want=422)
    daemon.ask("POST", "/v1/scenes", folder[:-30], kind, want=400)
    daemon.ask("POST", "/v1/scenes", zipped("r.rad", " " * (80 << 20)), kind, want=413)


def bsdfs_of_scenes(daemon, window):
    """One that a scene brings along is listed, checked and drawn; an XML file that is none is not."""
    files = {"r.rad": window.encode(), "k.xml": bsdf("bsdf_lcp8.xml"), "other.xml": b"<x/>"}
    scene = daemon.ask("POST", "/v1/scenes", {"files": [
        {"name": name, "base64": base64.b64encode(data).decode(), "resource": name != "r.rad"}
        for name, data in files.items()]}, want=201).id
    listed = daemon.ask("GET", "/v1/bsdfs?scene=" + scene, want=200).json["bsdfs"]
    found = {one["name"]: one for one in listed}
    assert sorted(found) == ["k.xml", "other.xml"]
    assert all(not one["by_itself"] and one["scenes"] == [scene] for one in listed)
    path = "/v1/bsdfs/" + found["k.xml"]["id"]
    first = daemon.ask("GET", path, want=200)
    assert first.json["summary"]["check"]["verdicts"]
    daemon.ask("GET", path, headers={"If-None-Match": first.headers["etag"]}, want=304)
    daemon.ask("GET", path + "/polar", want=200)
    daemon.ask("DELETE", path, want=404)
    none = daemon.ask("GET", "/v1/bsdfs/" + found["other.xml"]["id"], want=404)
    assert "other.xml" in none.json["detail"]
    daemon.ask("GET", "/v1/bsdfs?scene=x", want=400)
    assert daemon.ask("GET", "/v1/bsdfs?scene=" + UNKNOWN, want=200).json["bsdfs"] == []


def bsdfs(daemon):
    data = bsdf("bsdf_klems41.xml")
    first = daemon.ask("POST", "/v1/bsdfs?name=klems.xml", data, want=201)
    daemon.ask("POST", "/v1/bsdfs", data, want=200)
    path = "/v1/bsdfs/" + first.id
    daemon.ask("GET", path, want=200)
    daemon.ask("GET", path, headers={"If-None-Match": first.headers["etag"]}, want=304)
    looks(daemon, path + "/polar", ("", "?from=back&theta_deg=45&phi_deg=90"), ("90", "-1"),
          "theta_deg")
    daemon.ask("GET", path + "/polar?from=above", want=400)
    other = daemon.ask("POST", "/v1/bsdfs", bsdf("bsdf_lcp8.xml"), want=201)
    daemon.ask("DELETE", "/v1/bsdfs/" + other.id, want=204)
    daemon.ask("POST", "/v1/bsdfs", b"<WindowElement>", want=400)
    daemon.ask("POST", "/v1/bsdfs?name=../x", data, want=422)
    window = "void BSDF pane 6 0 k.xml 0 0 1 . 0 0\n" + ROOM.split("void glass")[0]
    daemon.ask("POST", "/v1/scenes", {"files": [{"name": "r.rad", "text": window}],
                                      "bsdfs": {"k.xml": first.id}}, want=201)
    daemon.ask("DELETE", path, want=409)
    bsdfs_of_scenes(daemon, window)
    daemon.ask("POST", "/v1/bsdfs", bsdf("bsdf_lcp8.xml"), want=201)
    stored_lists(daemon, "bsdfs")
    daemon.ask("POST", "/v1/scenes", {"files": [{"name": "r.rad", "text": window}],
                                      "bsdfs": {"k.xml": UNKNOWN}}, want=422)


def sensors_of(scene, **more):
    return {"scene": scene, "technique": "gather", "photons": {"global": 5000, "caustic": 500},
            "gather_samples": 16, "sensors": SENSORS, **more}


def renders(daemon):
    scene = daemon.upload(ROOM + SKY)
    path = daemon.submit(sensors_of(scene, views=[VIEW], priority=7, kind="render"),
                         X_Oriel_Client="contract")
    job = daemon.wait(path)
    assert job["state"] == "succeeded", job
    results(daemon, path, job)
    tag = daemon.ask("GET", path + "/document", want=200).headers["etag"]
    daemon.ask("GET", path + "/document", headers={"If-None-Match": tag}, want=304)
    daemon.ask("POST", path + "/cancel", want=409)
    daemon.ask("DELETE", path, want=204)
    eye = {"name": "eye", "view": "-vta -vp 2 2 1.5 -vd 0 -1 0 -vh 180 -vv 180", "width": 24,
           "height": 24, "metrics": ["all"], "glare": {"threshold": 1}}
    backward = daemon.submit({"scene": scene, "technique": "backward", "gather_samples": 32,
                              "pixel_samples": 4, "sensors": SENSORS, "views": [VIEW, eye]})
    assert daemon.wait(backward)["state"] == "succeeded"
    daemon.ask("GET", backward + "/result", want=200)
    for technique in ("direct", "precomputed", "auto"):
        again = daemon.submit({"scene": scene, "technique": technique, "sensors": SENSORS,
                               "photons": {"global": 5000}})
        daemon.wait(again)
        daemon.ask("GET", again + "/result", want=200)
    found = daemon.ask("GET", "/v1/maps", want=200).json["maps"][0]
    daemon.ask("DELETE", "/v1/maps/%(kind)s/%(key)s" % found, want=204)
    views(daemon, scene)


def views(daemon, scene):
    """One view done, another under way."""
    large = dict(VIEW, name="large", width=1024, height=1024)
    path = daemon.submit({"scene": scene, "technique": "backward", "pixel_samples": 64,
                          "views": [VIEW, large]})
    job = daemon.wait(path, ("running",), lambda job: job["links"].get("files"))
    events(daemon, path, 1)
    for link in job["links"]["files"]:
        assert "etag" not in daemon.ask("GET", link, want=200).headers
    daemon.ask("POST", path + "/cancel", want=202)
    daemon.wait(path)
    pictures(daemon, scene)


def pictures(daemon, scene):
    """All that is made of a view, and of sensors in a plane."""
    colors = {"draw": ["fill", "lines", "bands"], "points": [{"name": "p", "x": 2, "y": 3}]}
    view = dict(VIEW, formats=["hdr", "png", "png16", "exr", "exr_float"], false_color=colors)
    grid = [[x, y, 1, 0, 0, 1] for y in (1, 2, 3) for x in (1, 2)]
    path = daemon.submit({"scene": scene, "technique": "backward", "pixel_samples": 1,
                          "gather_samples": 16, "views": [view], "sensors": grid, "heat_map": {}})
    job = daemon.wait(path)
    assert len(job["files"]) == 14, job["files"]
    results(daemon, path, job)


def results(daemon, path, job):
    """All files of a job that has succeeded, and what else may be asked of them."""
    for link in [job["links"]["result"], *job["links"]["files"]]:
        answer = daemon.ask("GET", link, want=200)
        tag = answer.headers["etag"]
        daemon.ask("HEAD", link, want=200)
        daemon.ask("GET", link, headers={"If-None-Match": tag}, want=304)
        daemon.ask("GET", link, headers={"Range": "bytes=0-", "If-Range": tag}, want=206)
        daemon.ask("GET", link, headers={"Range": "bytes=99999999-"}, want=416)
    daemon.ask("GET", path + "/files/other.json", want=404)


def skies(daemon):
    weather = bsdf("weather.epw").decode("latin-1")
    scene = daemon.upload(ROOM, resources={"w.epw": weather, "s.txt": "1 1 1 0 0 1\n"})
    moment = {"month": 3, "day": 22}
    place = {**moment, "hour": 12, "latitude": 38, "longitude": 27, "time_zone": 2}
    for sky in ({"perez": {**place, "direct_normal_w_m2": 800, "diffuse_horizontal_w_m2": 120}},
                {"cie": {"type": "overcast", "diffuse_horizontal_lx": 10000}},
                {"cie": {"type": "clear", **place}, "normalise": "gendaylit"},
                {"weather": {"file": "w.epw", "month": 3, "day": 22, "hour": 11.5}}):
        document = sensors_of(scene, sky=sky, sensors={"file": "s.txt"},
                              effects={"caustics": "skip", "interreflection": "force"})
        daemon.submit(document)
    hours = {"weather": {"file": "w.epw"}, "from": {**moment, "hour": 11.5},
             "to": {**moment, "hour": 12.5}}
    cie = {"name": "grey", "cie": {"type": "overcast", "diffuse_horizontal_lx": 10000}}
    for several in (hours, [cie, {**cie, "name": "gray"}]):
        document = sensors_of(scene, skies=several, views=[{**VIEW, "width": 48, "height": 48}])
        path = daemon.submit(document)
        daemon.wait(path, ("running", "succeeded"),
                    lambda job: job.get("skies", {}).get("done", 0) > 0)
        job = daemon.wait(path)
        assert len(job["files"]) == 11 and job["skies"] == {"count": 2, "done": 2}
        daemon.ask("GET", path + "/result", want=200)
        for file in job["files"]:
            daemon.ask("GET", path + "/files/" + file["name"], want=200)
    daemon.ask("POST", "/v1/jobs", sensors_of(scene, skies=[]), want=422)
    eye = dict(VIEW, view="-vta -vp 1 1 1 -vd 0 1 0 -vh 180 -vv 180", metrics=["dgp"])
    path = daemon.submit({"scene": scene, "technique": "backward", "pixel_samples": 2, "views": [eye],
                          "skies": several, "sequence": {}})
    results(daemon, path, daemon.wait(path))


def accuracy(daemon):
    """A job by rounds, whose results show while it runs."""
    scene = daemon.upload(ROOM + SKY)
    path = daemon.submit({"scene": scene, "accuracy": {"deadline_s": 200}, "views": [VIEW],
                          "sensors": SENSORS})
    job = daemon.wait(path, ("running",), lambda job: "result" in job["links"])
    daemon.ask("GET", job["links"]["result"], want=200)
    events(daemon, path, 2)
    daemon.ask("POST", path + "/cancel", want=202)
    daemon.wait(path)
    path = daemon.submit({"scene": scene, "accuracy": {"relative_error": 0.2, "at": 0.9},
                          "sensors": SENSORS})
    assert daemon.wait(path)["state"] == "succeeded"
    daemon.ask("GET", path + "/result", want=200)


def studies(daemon):
    scene = daemon.upload(ROOM + SKY)
    study = {"kind": "study", "scene": scene, "title": "t", "note": "n", "seed": 3,
             "techniques": ["backward", "gather", "direct"], "photons": [500, 1000, 2000],
             "gather_samples": [8, 16], "repeats": 2, "sensors": SENSORS,
             "reference": {"samples": 4096, "runs": 2},
             "points": [{"name": "other", "seconds": 1, "rms": 0.1, "rays_per_s": 1e6}]}
    path = daemon.submit(study)
    daemon.wait(path, ("running", "succeeded"),
                lambda job: job["state"] == "succeeded" or job.get("study", {}).get("points"))
    events(daemon, path, 1)
    job = daemon.wait(path)
    assert job["state"] == "succeeded", job
    results(daemon, path, job)


def years(daemon):
    """A year of two days, with all files that there are of one."""
    weather = bsdf("weather.epw").decode("latin-1")
    scene = daemon.upload(ROOM, resources={"w.epw": weather, "s.txt": "1 1 1 0 0 1\n2 1 1 0 0 1\n"})
    year = {"kind": "annual", "scene": scene, "weather": "w.epw", "samples": 16, "title": "t",
            "grids": [{"name": "a b", "sensors": {"file": "s.txt"}}, {"sensors": SENSORS}],
            "targets": ["sDA300/50 >= 1 %"], "rules": ["EN 17037"],
            "accuracy": {"verdict": "DA300 >= 50 %"}, "formats": ["honeybee", "ill"],
            "exposure": {"points": [{"at": [1, 1, 1.5]}]},
            "view_out": {"points": [{"at": [1, 1, 1.5]}], "above_sensors": 0.4},
            "glare": {"seats": [{"at": [1, 1, 1.2], "towards": [0, -1, 0]}]},
            "shades": [{"name": "wall", "windows": ["pane"], "control": {"by": "LM-83"},
                        "states": [{"name": "open"}, {"name": "shut", "dark": True}]}]}
    path = daemon.submit(year)
    daemon.wait(path, ("running", "succeeded"))
    events(daemon, path, 1)
    job = daemon.wait(path)
    assert job["state"] == "succeeded", job
    results(daemon, path, job)
    alone = daemon.submit({"kind": "annual", "scene": scene, "weather": "w.epw", "samples": 4096,
                           "sensors": SENSORS * 200, "occupancy": {"from": 9},
                           "formats": ["coefficients"]})
    daemon.wait(alone, ("running",), lambda job: job["stage"] == "render")
    daemon.ask("POST", alone + "/cancel", want=202)
    daemon.ask("POST", "/v1/jobs", dict(year, weather="s.txt"), want=400)


def panels(daemon):
    """A panel's BSDF, made, found again, and named by a scene."""
    make = {"kind": "bsdf_make", "scene": daemon.upload(PANEL), "basis": "klems_quarter", "paths": 64}
    for cached in (False, True):
        path = daemon.submit(make)
        events(daemon, path, 1)
        job = daemon.wait(path)
        assert job["state"] == "succeeded" and job["maps"][0]["cached"] == cached, job
    results(daemon, path, job)
    daemon.ask("GET", path + "/document", want=200)
    daemon.ask("GET", job["links"]["bsdf"], want=200)
    daemon.ask("POST", "/v1/scenes", {"files": [{"name": "r.rad", "text": "void BSDF k 6 0 k.xml 0 0 1 . 0 0\n"}],
                                      "bsdfs": {"k.xml": job["bsdf"]["id"]}}, want=201)
    alone = daemon.submit(dict(make, paths=16777216, accuracy=0.0001, paths_most=16777216))
    daemon.wait(alone, ("running",), lambda job: job["stage"] == "render")
    daemon.ask("POST", alone + "/cancel", want=202)
    daemon.ask("DELETE", "/v1/maps/made/" + job["maps"][0]["key"], want=204)


def measurements(daemon):
    """A BSDF of measurements, made and found again; what is no scene suits no other kind of job."""
    measured = daemon.upload(MEASURED)
    fit = {"kind": "bsdf_fit", "measurements": measured, "basis": "klems_quarter"}
    for cached in (False, True):
        path = daemon.submit(fit)
        job = daemon.wait(path)
        assert job["state"] == "succeeded" and job["maps"][0]["cached"] == cached, job
    results(daemon, path, job)
    daemon.ask("GET", path + "/document", want=200)
    daemon.ask("GET", job["links"]["bsdf"], want=200)
    daemon.ask("POST", "/v1/jobs", {"scene": measured, "sensors": SENSORS}, want=422)
    daemon.ask("POST", "/v1/jobs", {"kind": "bsdf_fit", "measurements": daemon.upload(PANEL)}, want=422)
    daemon.ask("GET", "/v1/scenes/" + measured, want=200)


def events(daemon, path, wanted):
    """The first events of a job's stream."""
    connection = daemon.connect()
    connection.request("GET", path + "/events", headers=daemon.header)
    reply = connection.getresponse()
    found = 0
    while found < wanted:
        line = reply.readline()
        if not line:
            break
        if line.startswith(b"data: "):
            daemon.contract.judge_event(line[6:])
            found += 1
    connection.close()
    assert found, "no event of %s" % path


def all_events(daemon):
    """The stream of all jobs: a reset, then each as it changes; taken up again where it broke off."""
    scene = daemon.upload(ROOM + SKY)
    connection = daemon.connect()
    connection.request("GET", "/v1/events?tag=seen", headers=daemon.header)
    reply = connection.getresponse()
    daemon.contract.judge("GET", "/v1/events", Answer(reply.status, reply.getheaders(), b""))
    assert reply.status == 200
    daemon.submit(sensors_of(scene))
    path = daemon.submit(sensors_of(scene, tags=["seen"], name="n"))
    kinds, last, states = [], None, []
    while "succeeded" not in states:
        line = reply.readline().decode()
        if line.startswith("event: "):
            kinds.append(line[7:].strip())
        elif line.startswith("id: "):
            last = line[4:].strip()
        elif line.startswith("data: ") and kinds[-1] == "job":
            daemon.contract.judge_event(line[6:], "JobSummary")
            states.append(json.loads(line[6:])["state"])
            assert path.endswith(json.loads(line[6:])["id"])
    connection.close()
    assert kinds[0] == "reset" and set(kinds[1:]) == {"job"}, kinds
    daemon.ask("DELETE", path, want=204)
    connection = daemon.connect()
    connection.request("GET", "/v1/events?job=" + path[-32:-20],
                       headers={**daemon.header, "Last-Event-ID": last})
    reply = connection.getresponse()
    assert [reply.readline() for _ in range(2)][1] == b"event: removed\n"
    connection.close()
    daemon.ask("HEAD", "/v1/events", want=200)
    for query in ("job=x", "job=" + "0" * 33, "tag=", "tag=a,b"):
        daemon.ask("GET", "/v1/events?" + query, want=400)


def ended_events(daemon):
    scene = daemon.upload(ROOM + SKY)
    path = daemon.submit(sensors_of(scene))
    daemon.wait(path)
    last = daemon.ask("GET", path + "/events", want=200).body.decode().split("\n")[0]
    assert last.startswith("id: ")
    daemon.ask("GET", path + "/events", headers={"Last-Event-ID": last[4:]}, want=204)


def failures(daemon):
    gap = ("place here\nlatitude 47\nlongitude -8\ntime_zone -15\nsite_elevation 4\n"
           "weather_data_file_units 1\n3 21 11.5 9999 9999\n")
    scene = daemon.upload(ROOM, resources={"w.wea": gap, "s.txt": "1 1 1 0 0 1\n1 1 x 0 0 1\n"})
    answer = daemon.ask("POST", "/v1/jobs", {"scene": scene, "sensors": {"file": "s.txt"}},
                        want=400)
    assert answer.json["line"] == 2
    path = daemon.submit(sensors_of(scene, sky={
        "weather": {"file": "w.wea", "month": 3, "day": 21, "hour": 11.5}}))
    assert daemon.wait(path)["error"]["line"] == 7
    daemon.ask("GET", path + "/result", want=409)
    daemon.ask("GET", path + "/files/result.json", want=409)


def refusals(daemon):
    """Jobs that are none; each member of the wrong type."""
    scene = daemon.upload(ROOM + SKY)
    good = sensors_of(scene, views=[VIEW], seed=1, priority=5, effects={}, kind="render",
                      name="Südzimmer", tags=["a b", "c"])
    named = daemon.submit(good)
    daemon.ask("GET", named[:-20], want=200)
    daemon.ask("GET", named[:-20] + "/events", want=200)
    good = dict(good, name="other", tags=["d"])
    for name in good:
        for wrong in (None, True, "x" * 70, 1.5e300, -1, {}, [[]], {"unknown": 1}):
            document = dict(good, **{name: wrong})
            answer = daemon.ask("POST", "/v1/jobs", document)
            if answer.status == 202:
                assert not daemon.contract.judge_request(document), document
                daemon.ask("POST", answer.headers["location"] + "/cancel")
            else:
                assert answer.status in (400, 413, 422), document
    daemon.ask("POST", "/v1/jobs", dict(good, unknown=1), want=422)
    daemon.ask("POST", "/v1/jobs", dict(good, scene=UNKNOWN), want=422)
    daemon.ask("POST", "/v1/jobs", good, {"Idempotency-Key": "x" * 300}, want=400)
    daemon.ask("POST", "/v1/jobs", good, {"Idempotency-Key": "once"}, want=202)
    daemon.ask("POST", "/v1/jobs", dict(good, seed=2), {"Idempotency-Key": "once"}, want=422)
    daemon.ask("GET", "/v1/jobs?state=lost", want=400)
    daemon.ask("GET", "/v1/jobs?limit=0", want=400)
    job_lists(daemon)
    for state in ("queued", "running", "cancelling", "succeeded", "failed", "cancelled"):
        jobs = daemon.ask("GET", "/v1/jobs?limit=1000&state=" + state, want=200).json["jobs"]
        assert all(job["state"] == state for job in jobs)


def job_lists(daemon):
    """Pages of all jobs, and of those that have a name; as a table, which may not have changed."""
    for fields in ("all", "summary"):
        path, found = "/v1/jobs?limit=7&fields=" + fields, []
        while path:
            answer = daemon.ask("GET", path, want=200)
            found += [job["id"] for job in answer.json["jobs"]]
            assert ("link" in answer.headers) == answer.json["more"]
            path = answer.headers["link"][1:].split(">")[0] if "link" in answer.headers else None
        assert len(found) == len(set(found)) > 7
    named = daemon.ask("GET", "/v1/jobs?fields=summary&tag=a%20b&tag=c&since=2020-01-01T00:00:00Z",
                       want=200)
    assert [job["name"] for job in named.json["jobs"]] == ["Südzimmer"]
    daemon.ask("GET", "/v1/jobs?fields=summary&tag=a%20b&tag=c&since=2020-01-01T00:00:00Z",
               headers={"If-None-Match": named.headers["etag"]}, want=304)
    for query in ("cursor=x", "since=yesterday", "scene=0", "tag=", "fields=some",
                  "before=" + UNKNOWN):
        daemon.ask("GET", "/v1/jobs?" + query, want=400)


def sessions(daemon):
    """A browser's way in and out, and what it may be given instead; at last without its table."""
    bearer = {"Authorization": "Bearer " + daemon.token["submit"]}
    daemon.header = {}
    cookie = daemon.ask("POST", "/v1/session", headers=bearer, want=201).headers["set-cookie"]
    browser = {"Cookie": cookie.split(";")[0]}
    assert daemon.ask("GET", "/v1/session", headers=browser, want=200).json["signed_in"]
    own = dict(browser, Origin="http://127.0.0.1:%d" % daemon.port)
    scene = daemon.ask("POST", "/v1/scenes", {"files": [{"name": "r.rad", "text": ROOM + SKY}]},
                       own, want=201).id
    daemon.ask("POST", "/v1/scenes", {"files": [{"name": "r.rad", "text": ROOM}]}, browser, want=403)
    path = "/v1/jobs/" + daemon.ask("POST", "/v1/jobs", sensors_of(scene), own, want=202).id
    admin = {"Authorization": "Bearer " + daemon.token["admin"]}
    others = "/v1/jobs/" + daemon.ask("POST", "/v1/jobs", sensors_of(scene, seed=5), admin,
                                      want=202).id
    daemon.ask("POST", others + "/cancel", headers=bearer, want=403)
    daemon.ask("DELETE", others, headers=bearer, want=403)
    daemon.header = bearer
    daemon.wait(path)
    daemon.header = {}
    links = daemon.ask("POST", path + "/links", {"files": ["result.json"]}, own, want=201).json
    url = links["links"][0]["url"]
    daemon.ask("GET", url, want=200)
    daemon.ask("GET", url.replace("result.json", "other.json"), want=403)
    daemon.ask("POST", path + "/links", {"files": []}, own, want=422)
    daemon.ask("DELETE", "/v1/session", headers=browser, want=403)
    daemon.ask("DELETE", "/v1/session", headers=own, want=204)
    assert not daemon.ask("GET", "/v1/session", headers=browser, want=200).json["signed_in"]
    daemon.ask("GET", "/v1/jobs", headers=browser, want=401)
    daemon.ask("POST", "/v1/session", headers=own, want=401)
    with sqlite3.connect(os.path.join(daemon.folder, "oriel.db"), timeout=30) as database:
        database.execute("ALTER TABLE sessions RENAME TO lost_sessions")
    database.close()
    daemon.ask("POST", "/v1/session", headers=bearer, want=500)
    daemon.ask("GET", "/v1/session", headers=browser, want=500)
    daemon.ask("DELETE", "/v1/session", headers=own, want=500)
