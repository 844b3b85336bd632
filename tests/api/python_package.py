"""The Python package with Honeybee models, results, settings and commands: one case a run.

Arguments and failures are as in python_client.py.
"""

import ast
import contextlib
import io
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import threading
import warnings

from python_desk import FIXTURES, OPENING, PACKAGE, ROOM, WINDOW, oriel, raises, run_case
from oriel import cli, documents, files, references, settings

OVERCAST = {"cie": {"type": "overcast", "diffuse_horizontal_lx": 10000}}
FAST = {"technique": "backward", "gather_samples": 16}
SLATS = "void plastic p 0 0 5 .5 .5 .5 0 0\np polygon s 0 0 12 0 0 0 1 0 0 1 .7 -.7 0 .7 -.7\n"


def write(desk, name, text):
    path = pathlib.Path(desk.folder, name)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return str(path)


def model_in(desk, is_static=False):
    """Writes the model of two rooms and its weather; static: without its group of windows."""
    text = pathlib.Path(FIXTURES, "honeybee/two_rooms.hbjson").read_text(encoding="utf-8")
    if is_static:
        text = text.replace('"dynamic_group_identifier": "south_glass",', "")
    shutil.copy(os.path.join(FIXTURES, "weather.epw"), os.path.join(desk.folder, "place.epw"))
    return write(desk, "office.hbjson", text)


def posts(desk):
    return [line for line in desk.sent if line.startswith("POST /v1/scenes") or line.startswith("POST /v1/bsdfs")]


def old_python(desk):
    """Python 3.8 can read all modules, which need nothing beyond the standard library, but for numpy."""
    modules = set()
    for path in pathlib.Path(oriel.__file__).parent.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"), feature_version=(3, 8))):
            if isinstance(node, ast.Import):
                modules |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and not node.level:
                modules.add(node.module.split(".")[0])
    own = set(getattr(sys, "stdlib_module_names", modules)) | {"numpy"}  # since Python 3.10
    assert {"http", "json"} <= modules <= own, modules - own
    posix = {"fcntl", "pwd", "grp", "termios", "pty", "resource"}
    assert not modules & posix, modules & posix


def readme(desk):
    """The examples of the README, one after the other; the first is the LEED verdict in ten lines."""
    text = pathlib.Path(PACKAGE, "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```(python|sh)\n(.*?)```", text, re.S)
    assert len(blocks) >= 8 and "LEED" in blocks[0][1] and blocks[0][1].count("\n") <= 10
    model_in(desk, is_static=True)
    for name, content in (("materials.rad", "# none\n"), ("sky.rad", "# in the room\n"), ("slats.rad", SLATS)):
        write(desk, name, content)
    write(desk, "window.rad", "void BSDF slats\n6 0 slats.xml 0 0 1 .\n0\n0\n" + OPENING.replace("pane", "slats", 1))
    shutil.copy(os.path.join(desk.folder, "room.rad"), os.path.join(desk.folder, "kept.rad"))
    write(desk, "room.rad", ROOM.replace("!xform -t 0 0 0 window.rad\n", WINDOW))
    environment = dict(os.environ, ORIEL_URL=desk.url, PYTHONPATH=os.path.abspath(PACKAGE))
    printed = []
    for language, code in blocks:
        code = code.replace("http://127.0.0.1:8423", desk.url).replace("python3", sys.executable)
        code = code.replace("import oriel\n", "import oriel, example_size\n", 1)
        command = [sys.executable, "-c", code] if language == "python" else ["sh", "-ec", code]
        write(desk, "example_size.py", SMALLER)
        done = subprocess.run(command, cwd=desk.folder, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, code + done.stdout + done.stderr
        printed.append(done.stdout)
    assert "LEED v4.1, 1 point, sDA300/50 >= 40 %" in printed[0] and "95 % interval" in printed[0]
    assert printed[1].startswith("desks ")
    assert "19 4 19" in printed[3] and "imperceptible" in printed[4]
    assert "overcast" in printed[6]  # the hint or the detail names the right word
    assert os.path.getsize(os.path.join(desk.folder, "sensors.csv")) > 100
    assert os.path.isfile(os.path.join(desk.folder, "year", "results", "sun-up-hours.txt"))


# Examples run with less light and smaller pictures, but with every call as it stands.
SMALLER = '''
import oriel.kinds
oriel.kinds.VIEW_SIDE = 32
before = oriel.Client.document
def smaller(self, subject, kind=None, folder=None, **members):
    small = {"annual": {"samples": 16, "metrics": ["DA300"]}}.get(kind, {})
    return before(self, subject, kind, folder, **dict(small, **members))
oriel.Client.document = smaller
'''


def models(desk):
    """A model as a path, a dict, an object and a zip; its grids, states and weather; sent once."""
    path, client = model_in(desk), desk.client
    scene = client.upload(path, weather=os.path.join(desk.folder, "place.epw"))
    assert scene.grids == ["desks", "store/floor"] and scene.views == ["from_door"]
    assert scene.states == {"south_glass": ["0_south_glass", "1_south_glass"]} and scene.weather == "place.epw"
    desk.sent.clear()
    assert client.upload(path, weather=os.path.join(desk.folder, "place.epw")) == scene
    assert desk.sent == ["HEAD /v1/scenes/" + scene]
    model = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    plain = client.upload(model)
    assert plain != scene and client.upload(path) == plain

    class Honeybee:
        def to_dict(self):
            return model

    assert client.upload(Honeybee()) == plain
    dark = client.render(path, sky=OVERCAST, grids=["desk*"], views=[], states={"south_glass": "1_south_glass"}, **FAST)
    light = client.render(model, sky=OVERCAST, grids=["desks"], views=[], **FAST)
    assert dark.grids == light.grids == ["desks"] and len(light.values("desks")) == 4
    assert sum(dark.values()) < sum(light.values())
    error = raises(oriel.OrielError, client.render, path, sky=OVERCAST, grids=["desk"])
    assert "desks, store/floor" in error.hint
    error = raises(oriel.Problem, client.upload, path, states={"south_glass": "closed"})
    assert "no state 'closed'" in error.detail
    error = raises(oriel.OrielError, client.upload, os.path.join(desk.folder, "place.epw"))
    assert "weather=" in error.hint
    raises(oriel.OrielError, client.upload, os.path.join(desk.folder, "absent.hbjson"))
    raises(oriel.OrielError, client.upload, 3)
    document = client.document(path, "annual", weather=os.path.join(desk.folder, "place.epw"), rules=["LEED"])
    assert document["weather"] == "place.epw" and len(document["grids"]) == 2 and "views" not in document
    assert document["shades"][0]["control"] == {"by": "LM-83"} and len(document["shades"][0]["states"]) == 2
    stored = client.upload(path, weather=os.path.join(desk.folder, "place.epw"), states={"south_glass": "1_south_glass"})
    document = client.document(stored, "annual", rules=["LEED"], grids=["desks"])
    assert document["weather"] == "place.epw" and len(document["grids"]) == 1 and "shades" not in document
    document = client.document({"kind": "render", "scene": {"project": "office.hbjson", "files": ["more.rad"]},
                                "sky": {"weather": {"file": os.path.join(desk.folder, "place.epw")}}},
                               folder=folder_with(desk, "more.rad", "void plastic more 0 0 5 .5 .5 .5 0 0\n"))
    assert document["sky"]["weather"]["file"] == "place.epw" and document["views"][0]["width"] == 800
    summary = oriel.Scene.of(client._transport, document["scene"]).summary
    assert summary["main"][-1] == "more.rad" and summary["materials"] == plain.summary["materials"] + 1


def folder_with(desk, name, text):
    write(desk, name, text)
    return desk.folder


def folders(desk):
    """A folder is sent as a zip, without hidden files; Radiance files with all that they refer to."""
    client = desk.client
    for name, text in (("model/room.rad", ROOM), ("model/window.rad", WINDOW), ("model/.hidden.rad", "wrong")):
        write(desk, name, text)
    scene = client.upload(os.path.join(desk.folder, "model"))
    assert scene.summary["main"] == ["room.rad"]
    desk.sent.clear()
    assert client.upload(os.path.join(desk.folder, "model")) == scene and not posts(desk)
    assert client.upload(os.path.join(desk.folder, "model/room.rad")) == scene and not posts(desk)
    raises(oriel.OrielError, client.upload, folder_with(desk, "empty/.hidden", "x") + "/empty")
    raises(oriel.OrielError, client.render, os.path.join(desk.folder, "model"), sky=OVERCAST, grids=["desks"])
    program = os.path.join(os.environ.get("ORIEL_BUILD", "build"), "oriel")
    exported = os.path.join(desk.folder, "exported")
    subprocess.run([program, "project", model_in(desk), "-o", exported], check=True, capture_output=True)
    os.unlink(exported + "/job.json")
    model = client.upload(os.path.join(desk.folder, "office.hbjson"))
    assert client.upload(exported) == client.upload(exported + "/model") == model and len(model.grids) == 2
    library = folder_with(desk, "library/dim.cal", "dim = 0.5;\n") + "/library"
    write(desk, "cal.rad", "void brightfunc b\n2 dim dim.cal\n0\n0\nb plastic m 0 0 5 .5 .5 .5 0 0\n"
          "!xform -f none 'inner.rad' | xform -s 1\n")
    write(desk, "inner.rad", "void BSDF pane\n6 0 sub/pane.xml 0 0 1 .\n0\n0\n")
    os.makedirs(os.path.join(desk.folder, "sub"))
    shutil.copy(os.path.join(FIXTURES, "bsdf_klems41.xml"), os.path.join(desk.folder, "sub/pane.xml"))
    os.environ["RAYPATH"] = library
    found = references.referenced(desk.folder, ["cal.rad"])
    del os.environ["RAYPATH"]
    assert set(found) == {"dim.cal", "inner.rad", "sub/pane.xml"} and str(found["dim.cal"]).startswith(library)
    bsdf = client.upload(os.path.join(desk.folder, "sub/pane.xml"))
    assert bsdf == files.LocalFile(desk.folder, "sub/pane.xml").sha
    named = references.NamedFiles({"weather": os.path.join(desk.folder, "sub/pane.xml"), "sky": {"perez": {}},
                                   "views": [{"file": "views.vf"}, {}]}, desk.folder, True)
    assert named.document["weather"] == "pane.xml" and set(named.paths) == {"pane.xml", "views.vf"}
    raises(oriel.OrielError, references.NamedFiles, {"weather": "absent.epw"}, desk.folder, True)


def years(desk):
    """A year of a model: verdicts with intervals, metrics, hours and arrays, with and without numpy."""
    path, output = model_in(desk), os.path.join(desk.folder, "year")
    result = desk.client.annual(path, output, weather=os.path.join(desk.folder, "place.epw"), samples=16,
                                metrics=["DA300"], states={"south_glass": "0_south_glass"}, rules=["LEED"], formats=["honeybee"],
                                targets=["DA300 of desks >= 1 %"])
    assert result.grids == ["desks", "store/floor"]
    mine = [one for one in result.verdicts() if one.rule is None]
    assert [(one.target, one.grid) for one in mine] == [("DA300 of desks >= 1 %", "desks")], mine
    assert mine[0].interval_95[0] <= mine[0].value <= mine[0].interval_95[1] and str(mine[0]).count("95 %") == 1
    assert str(mine[0]).startswith("DA300 of desks >= 1 %: undecided, ")
    leed = result.verdicts("leed", "desks")
    assert leed and all(one.rule.startswith("LEED") and one.verdict == "undecided" for one in leed)
    assert len(result.metrics("desks")) == 4 and len(result.table()) == 5
    assert result.figures("desks")["name"][0] == "sDA300/50" and result.figures()["value"][0] >= 0
    hours = result.hours()
    assert len(hours) == 48 and max(lux for lux in hours["desks"] if lux == lux) > 100 and set(hours["month"]) == {3, 12}
    lux = result.hourly("store/floor")
    assert len(lux) == 1 and len(lux[0]) == len(result.sun_up_hours()) == 19
    raises(oriel.OrielError, result.hourly, "nowhere")
    raises(KeyError, result.metrics().__getitem__, "nothing")
    again = oriel.load_result(output)
    assert again == result and list(again.hourly("desks")[0]) == list(result.hourly("desks")[0])
    numpy, oriel.results.numpy = oriel.results.numpy, None
    try:
        plain = again.hourly("desks")
        assert isinstance(plain, list) and isinstance(again.sun_up_hours(), list)
    finally:
        oriel.results.numpy = numpy
    if numpy is not None:
        assert result.hourly("desks").shape == (4, 19) and result.hourly("desks").tolist() == plain
    error = raises(oriel.OrielError, desk.client.glare, path, weather="place.epw")
    assert "seats" in str(error)


def kinds(desk):
    """Glare at a moment, a study and a plan, from keyword arguments."""
    client = desk.client
    path = model_in(desk)
    small = {"width": 24, "height": 24}
    seats = [{"name": "up", "at": [2, 2, 1.2], "towards": [0, 0, 1]}, {"at": [2, 2, 1.2], "towards": [0, -1, 0]}]
    oriel.kinds.VIEW_SIDE = 24
    result = client.glare(path, seats, sky=OVERCAST, grids=["desks"], pixel_samples=4, **FAST)
    assert 0 < result.glare("seat2")["metrics"]["dgp"]["value"] < 1
    raises(oriel.OrielError, result.glare, "seat3")
    result = client.glare(client.upload(path), sky=OVERCAST, grids=["desks"], pixel_samples=4, **FAST)
    assert result.glare()["class"] == "imperceptible" and abs(result.glare()["field_sr"] - 6.283) < 0.3
    view = dict(small, name="v", view="-vta -vp 2 2 1.2 -vd 0 -1 0 -vh 180 -vv 180", metrics=["ugr"])
    result = client.glare(path, views=[view], sky=OVERCAST, grids=["desks"], pixel_samples=4, **FAST)
    assert set(result.glare("v")["metrics"]) == {"ugr"}
    plans = client.plan(path, sky=OVERCAST, grids=["desks"], views=[], **FAST)
    assert plans[0]["plan"]["technique"] == "backward"
    skies = [dict(OVERCAST, name="grey"), {"name": "bright", "cie": {"type": "uniform", "diffuse_horizontal_lx": 20000}}]
    result = client.render(path, skies=skies, grids=["desks"], views=[], **FAST)
    assert result.grids == ["desks"] and sum(result.values("desks", "bright")) > sum(result.values("desks", "grey"))
    assert len(result.table(sky="grey")) == 4 and raises(oriel.OrielError, result.values)
    result = client.study(os.path.join(desk.folder, "room.rad"), techniques=["backward"], gather_samples=[16],
                          repeats=2, reference={"samples": 16384, "runs": 2}, sensors=[[1.5, 1, 0.8, 0, 0, 1]])
    assert len(result["points"]) == 1
    write(desk, "paper.csv", "theta_in,phi_in,theta_out,phi_out,bsdf\n" + "".join(
        "%d,0,%d,%d,0.2\n" % (theta, out, phi)
        for theta in (0, 40) for out in range(3, 90, 6) for phi in range(0, 360, 15)))
    fitted = client.fit_bsdf(["paper.csv"], folder=desk.folder, basis="klems_quarter")
    assert fitted["bsdf"]["id"] in [one["id"] for one in client.bsdfs()]
    assert len(fitted.read("bsdf.xml")) > 1000


def tables(desk):
    """Sensors of a file have positions in the table; CSV; text stays text."""
    result = desk.client.render({"scene": {"files": ["room.rad"]}, "grids": [
        {"name": "7", "sensors": {"file": "sensors.txt"}}, {"name": "wall", "sensors": [[1.5, 2, 1.2, 0, -1, 0]]}],
        **FAST}, folder=desk.folder)
    table = result.table("7")
    assert [row["y"] for row in table] == [1, 3] and list(table["grid"]) == ["7", "7"]
    row = next(iter(table))
    assert row["low_95_lx"] <= row["illuminance_lx"] <= row["high_95_lx"] and row["standard_error_lx"] > 0
    lines = pathlib.Path(result.table().to_csv(os.path.join(desk.folder, "t.csv"))).read_text().splitlines()
    assert lines[0].startswith("grid,x,y,z,") and lines[3].startswith("wall,1.5,2") and len(lines) == 4
    raises(oriel.OrielError, desk.client.render, os.path.join(desk.folder, "room.rad"), sky="noon")
    write(desk, "sub/room.rad", ROOM.replace("!xform -t 0 0 0 window.rad\n", WINDOW))
    os.chdir(desk.folder)
    rows = desk.client.render("sub/room.rad", sensors={"file": "sensors.txt"}, **FAST).table()
    assert [(row["grid"], row["y"]) for row in rows] == [("sensors", 1), ("sensors", 3)]
    for text, found in (("1,2,3,0,0,1\n\n", [[1, 2, 3, 0, 0, 1]]), ("1; 2;3;0;0;1 # up", [[1, 2, 3, 0, 0, 1]]),
                        ("0,5 1 2 0 1\n", None), ("1 2 3 0 0 nan", None), ("1 2 3 0 0", None)):
        assert documents._sensor_rows(pathlib.Path(write(desk, "s.txt", text))) == found, text
    stored = desk.client.render(model_in(desk), sky=OVERCAST, grids=["desks"], views=[], heat_map={}, **FAST).table()
    assert [(row["x"], row["y"], row["dz"]) for row in stored] == [(1, 1, 1), (1, 2, 1), (1, 3, 1), (1, 4, 1)]
    again = oriel.results.read_table(b'grid,"DA (%)",low_95,"x, y"\n"3",1,,a\n')
    assert again.columns == ["grid", "DA (%)", "DA (%) low_95", "x, y"] and again.rows == [["3", 1.0, None, "a"]]
    raises(oriel.OrielError, result.table().to_csv, os.path.join(desk.folder, "absent/t.csv"))


class Proxy:
    """Forwards connections to the daemon, but breaks or delays those that it is told to."""

    def __init__(self, url, rule):
        self.host, port = re.match(r"https?://([^:/]+):(\d+)", url).groups()
        self.port, self.rule, self.requests = int(port), rule, []
        self.server = socket.create_server(("127.0.0.1", 0))
        self.url = "http://127.0.0.1:%d" % self.server.getsockname()[1]
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            client = self.server.accept()[0]
            threading.Thread(target=self.serve, args=(client,), daemon=True).start()

    def serve(self, client):
        with client, contextlib.suppress(OSError):
            first = client.recv(65536)
            line = first.split(b"\r\n")[0].decode()
            self.requests.append(line)
            what = self.rule(line, self.requests)
            if what == "break":
                return
            if what == "busy":
                client.sendall(b"HTTP/1.1 503 Busy\r\nRetry-After: 0\r\nContent-Length: 0\r\n\r\n")
                return
            with socket.create_connection((self.host, self.port)) as daemon:
                daemon.sendall(first)
                threading.Thread(target=self.pump, args=(client, daemon), daemon=True).start()
                self.pump(daemon, None if what == "lose" else client)
                client.shutdown(socket.SHUT_RDWR)  # closing alone does not end the other pump

    @staticmethod
    def pump(source, sink):
        with contextlib.suppress(OSError):
            while True:
                data = source.recv(65536)
                if not data or sink is None:
                    return
                sink.sendall(data)


def broken(desk):
    """Connections break: an upload is sent again, a submission makes one job, events are replaced by polls."""
    def rule(line, before):
        first = sum(one == line for one in before) == 1
        if line.startswith("POST /v1/scenes") and first:
            return "break"
        if line.startswith("POST /v1/jobs ") and first:
            return "lose"  # the daemon has taken the job; the client never hears of it
        return "break" if "/events" in line or ("/result" in line and first) else "forward"

    proxy = Proxy(desk.url, rule)
    client = oriel.Client(proxy.url, backoff=0.05)
    write(desk, "window.rad", WINDOW + "# by a broken connection\n")
    scene = client.upload(os.path.join(desk.folder, "room.rad"))
    before = len(client.jobs())
    job = client.submit(scene, sensors=[[1.5, 1, 0.8, 0, 0, 1]], seed=77, **FAST)
    assert job.wait(poll=0.05)["state"] == "succeeded" and job.result()["state"] == "succeeded"
    assert len(client.jobs()) == before + 1
    count = [sum(line.startswith(one) for line in proxy.requests) for one in
             ("POST /v1/scenes", "POST /v1/jobs ", "GET /v1/jobs/%s/result" % job.id)]
    assert count == [2, 2, 2], (count, proxy.requests)
    proxy = Proxy(desk.url, lambda line, before: "break")
    raises(oriel.Unreachable, oriel.Client(proxy.url, retries=2, backoff=0.05).jobs)
    assert len(proxy.requests) == 3
    proxy = Proxy(desk.url, lambda line, before: "busy" if len(before) == 1 else "forward")
    assert oriel.Client(proxy.url, backoff=0.05).jobs() and len(proxy.requests) == 2
    proxy = Proxy(desk.url, lambda line, before: "busy")
    assert raises(oriel.Busy, oriel.Client(proxy.url, retries=0).jobs).retry_after == 0


def restarts(desk):
    """A wait goes on while the daemon does not answer, as during a restart, but for no longer than its patience."""
    job = desk.client.submit(os.path.join(desk.folder, "room.rad"), sensors=[[1.5, 1, 0.8, 0, 0, 1]], seed=6, **FAST)
    proxy = Proxy(desk.url, lambda line, before: "break" if len(before) < 8 or "/events" in line else "forward")
    assert oriel.Client(proxy.url, retries=0).job(job.id).wait(poll=0.02)["state"] == "succeeded"
    assert len(proxy.requests) >= 8
    raises(oriel.Unreachable, oriel.Client(Proxy(desk.url, lambda line, before: "break").url, retries=0).job(job.id).wait,
           poll=0.02, patience=0)


def followed(desk):
    """The daemon's events alone end a wait: there is no poll before the test's time is over."""
    oriel.events.Watcher.IDLE_S = 1e6
    job = desk.client.submit(os.path.join(desk.folder, "room.rad"), sensors=[[1.5, 1, 0.8, 0, 0, 1]], seed=5, **FAST)
    seen = []
    job.wait(progress=lambda status: seen.append(status["state"]), poll=1e6)
    assert seen[-1] == "succeeded"
    states = [state["state"] for state in job.events()]
    assert states == ["succeeded"], states


def interrupts(desk):
    """Ctrl-C cancels the job of `run`, and raises KeyboardInterrupt."""
    document = {"scene": {"files": ["room.rad"]}, "technique": "gather", "photons": {"global": 100000000},
                "sensors": [[1.5, 1, 0.8, 0, 0, 1]], "tags": ["interrupted"]}

    def interrupt(status):
        if status["state"] == "running":
            signal.raise_signal(signal.SIGINT)

    raises(KeyboardInterrupt, desk.client.render, document, folder=desk.folder, progress=interrupt)
    job = desk.client.job(desk.client.jobs(tags=["interrupted"])[0]["id"])
    raises(oriel.JobCancelled, job.wait)
    other = desk.long_job()
    raises(KeyboardInterrupt, other.wait, progress=interrupt)
    assert other.status()["state"] == "running"
    other.cancel()


def hints(desk):
    """Exceptions carry title, detail, hint, file and line of the daemon."""
    write(desk, "wrong.rad", "void plastic grey\n0\n0\n5 0.5 0.5 0.5 0 0\ngrey polygon a\n0\n0\n9 0 0 0 1 0 0 2 0 0\n"
          "void gloss x 0 0 0\n")
    error = raises(oriel.Problem, desk.client.upload, os.path.join(desk.folder, "wrong.rad"))
    assert error.title and error.detail and error.file == "wrong.rad" and error.line, error.document
    assert str(error).startswith("wrong.rad:%d: " % error.line)
    error = raises(oriel.Problem, desk.client.render, {"scene": {"files": ["room.rad"]}, "sensors": [[1, 1, 1, 0, 0, 1]],
                                                       "sky": {"weather": {"file": "window.rad", "month": 3, "day": 2,
                                                                           "hour": 12}}}, folder=desk.folder)
    assert error.status == 400 and error.title and (error.file, error.line) == ("window.rad", 1) and "EPW" in error.hint
    write(desk, "dark.rad", "void plastic g 0 0 5 .5 .5 .5 0 0\ng polygon f 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n")
    error = raises(oriel.JobFailed, desk.client.render, os.path.join(desk.folder, "dark.rad"),
                   sensors=[[1, 1, 1, 0, 0, 1]], **FAST)
    assert error.type == "urn:oriel:error:unlit" and error.hint and error.hint in str(error)


def named_servers(desk):
    """oriel.toml names servers and their tokens; everything outside its syntax is refused by line."""
    path = pathlib.Path(desk.folder, "oriel.toml")
    assert settings.settings_path() == path
    path.write_text('# servers\nserver = "%s/"\n\n[servers.far]   # one\nurl = \'https://far.example\'\n'
                    'token_file = "far.token"\n[servers . b-2]\r\nurl = "http://127.0.0.1:2\\\\"\n' % desk.url)
    pathlib.Path(desk.folder, "far.token").write_text("oriel_secret\n")
    os.chmod(os.path.join(desk.folder, "far.token"), 0o600)
    assert oriel.Client().health()["status"] == "ok"
    read = settings.read_settings()
    assert read.choose("far") == read.choose("https://far.example/") == ("https://far.example", "oriel_secret")
    assert read.choose(None) == (desk.url, None) and read.choose("b-2").url == "http://127.0.0.1:2\\"
    os.environ["ORIEL_URL"], os.environ["ORIEL_TOKEN"] = "https://other.example", "oriel_mine"
    assert read.choose(None) == ("https://other.example", "oriel_mine")
    del os.environ["ORIEL_URL"], os.environ["ORIEL_TOKEN"]
    assert "servers.near" in raises(oriel.SettingsError, read.choose, "near").hint
    if os.name == "posix":
        os.chmod(os.path.join(desk.folder, "far.token"), 0o644)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            read.choose("far")
        assert "chmod 600" in str(caught[0].message)
    for line, text in ((1, "server = 5"), (1, "server = http://x"), (2, '\nurl = "x"'), (1, "[other]"), (1, '[servers."x"]'),
                       (2, 'server = "a"\nserver = "b"'), (3, "[servers.a]\nurl = 'x'\n[servers.a]"), (1, 'server = "\\n"'),
                       (1, 'server = "a" b'), (1, 'server = """a"""'), (1, "server = 'a"), (1, "server"), (1, 'server = ""')):
        error = raises(oriel.SettingsError, settings.Settings, path, text)
        assert "oriel.toml:%d: " % line in str(error), (text, error)
    assert "url" in str(raises(oriel.SettingsError, settings.Settings, path, "[servers.a]\n"))


def command(desk, *arguments):
    """Runs `python -m oriel` in this process. Returns its status and what it printed."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            status = cli.main(list(arguments))
        except SystemExit as ended:
            status = ended.code
    return status, out.getvalue().strip(), err.getvalue().strip()


def commands(desk):
    """Each command of `python -m oriel`, its JSON, and its exit status."""
    os.environ["ORIEL_URL"] = desk.url
    path = model_in(desk)
    os.chdir(desk.folder)
    status, scene, _ = command(desk, "upload", "office.hbjson", "--weather", "place.epw")
    assert status == 0 and re.fullmatch("[0-9a-f]{64}", scene)
    reply = json.loads(command(desk, "upload", "office.hbjson", "--weather", "place.epw", "--json")[1])
    assert reply["id"] == scene and reply["summary"]["project"]["grids"]
    submit = ["submit", path, "--sky", json.dumps(OVERCAST), "--set", "views=[]", "--set", 'grids=["desks"]',
              "--set", "gather_samples=16", "--set", 'technique="backward"', "--tag", "cli", "--name", "By hand"]
    status, id, _ = command(desk, *submit)
    assert status == 0 and command(desk, "wait", id)[:2] == (0, id)
    assert json.loads(command(desk, "status", id[:12], "--json")[1])["name"] == "By hand"
    status, printed, _ = command(desk, "fetch", id, "-o", "got", "--only", "results/*.res")
    assert status == 0 and printed == os.path.join("got", "results", "desks.res") and os.path.isfile(printed)
    status, again, err = command(desk, *submit, "--output", "all", "--json")
    assert status == 0 and json.loads(again)["state"] == "succeeded" and "succeeded" in err
    assert os.path.isfile("all/result.json") and "By hand" in command(desk, "status")[1]
    assert {one["id"] for one in json.loads(command(desk, "status", "--json")[1])["jobs"]} >= {id}
    job = desk.long_job()
    assert command(desk, "cancel", job.id)[1].startswith(job.id)
    raises(oriel.JobCancelled, job.wait)
    status, _, err = command(desk, "wait", job.id)
    assert status == 1 and "cancelled" in err
    status, _, err = command(desk, "submit", path, "--sky", '{"cie": {"type": "overcasst"}}')
    assert status == 1 and err.startswith("oriel: ") and "overcast" in err
    assert command(desk, "submit", path, "--set", "views")[0] == 2 and command(desk)[0] == 2
    assert command(desk, "--version")[1] == "oriel " + oriel.__version__
    os.environ["ORIEL_URL"] = "http://127.0.0.1:1"
    status, _, err = command(desk, "status")
    assert status == 1 and "no answer from" in err


def wheel(desk):
    """The wheel builds without network, has the version of the C header, and works by pip and by its path alone."""
    build = os.environ.get("ORIEL_BUILD", "build")
    plain = {name: one for name, one in os.environ.items() if not name.startswith(("MAKE", "MFLAGS", "PYTHON"))}
    subprocess.run(["make", "-s", "BUILD=" + build, "wheel"], check=True, env=plain, stdout=subprocess.DEVNULL)
    found = list(pathlib.Path(build, "python").glob("oriel-*-py3-none-any.whl"))
    assert [one.name for one in found] == ["oriel-%s-py3-none-any.whl" % oriel.__version__]
    file, room = str(found[0].resolve()), os.path.join(desk.folder, "room")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", room], check=True)
    inside = os.path.join(room, "bin", "python3")
    subprocess.run([sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check", "--python", inside,
                    "install", "--no-index", "--no-deps", file], check=True, env=plain)
    say = "import oriel; print(oriel.__file__, oriel.__version__, oriel.Client(%r).health()['status'])" % desk.url
    for python, code in ((inside, say), (sys.executable, "import sys; sys.path.insert(0, %r); " % file + say)):
        done = subprocess.run([python, "-I", "-c", code], check=True, env=plain, capture_output=True, text=True)
        place, version, status = done.stdout.split()
        assert place.startswith((room, file)) and version == oriel.__version__ and status == "ok", done.stdout
    done = subprocess.run([inside, "-I", "-m", "oriel", "--version"], check=True, env=plain, capture_output=True, text=True)
    assert done.stdout == "oriel %s\n" % oriel.__version__
    numbers = "import oriel, oriel.results; assert oriel.results.numpy is None; print(oriel.load_result(%r).values())"
    write(desk, "old/result.json", json.dumps({"sensors": [{"illuminance_lx": 5.5}, {"illuminance_lx": None}]}))
    done = subprocess.run([inside, "-I", "-c", numbers % os.path.join(desk.folder, "old")], check=True, env=plain,
                          capture_output=True, text=True)
    assert done.stdout == "[5.5, nan]\n"


if __name__ == "__main__":
    run_case(globals())
