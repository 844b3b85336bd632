"""What the tests of the Python package share: a scene, a job, and a client that notes what it sends."""

import json
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
PACKAGE = os.path.join(HERE, "../../client/python")
FIXTURES = os.path.join(HERE, "../fixtures")
sys.path.insert(0, PACKAGE)
import oriel  # noqa: E402

ROOM = """void plastic grey\n0\n0\n5 0.5 0.5 0.5 0 0
void glow sky_glow\n0\n0\n4 10 10 10 0
sky_glow source sky\n0\n0\n4 0 0 1 180
grey polygon floor\n0\n0\n12 0 0 0  3 0 0  3 4 0  0 4 0
grey polygon top\n0\n0\n12 0 0 3  0 4 3  3 4 3  3 0 3
grey polygon west\n0\n0\n12 0 0 0  0 4 0  0 4 3  0 0 3
grey polygon east\n0\n0\n12 3 0 0  3 0 3  3 4 3  3 4 0
grey polygon north\n0\n0\n12 0 4 0  3 4 0  3 4 3  0 4 3
!xform -t 0 0 0 window.rad\n"""
OPENING = "pane polygon window\n0\n0\n12 3 0 0  0 0 0  0 0 3  3 0 3\n"
WINDOW = "void glass pane\n0\n0\n3 0.96 0.96 0.96\n" + OPENING
JOB = {"kind": "render", "scene": {"files": ["room.rad"]}, "seed": 1, "technique": "gather",
       "photons": {"global": 20000, "caustic": 1000}, "gather_samples": 64,
       "sensors": {"file": "sensors.txt"},
       "views": [{"name": "north", "view": "-vtv -vp 1.5 0.5 1.5 -vd 0 1 0", "width": 16,
                  "height": 12},
                 {"name": "filed", "file": "views.vf", "width": 8, "height": 6}]}


class Desk:
    """A client that notes what it sends, and a folder with a scene and a job."""

    def __init__(self, url, folder, ca_file, token):
        self.url, self.folder, self.ca_file, self.token = url, folder, ca_file or None, token
        self.client = self.connect(token)
        for name, text in (("room.rad", ROOM), ("window.rad", WINDOW),
                           ("sensors.txt", "1.5 1 0.8 0 0 1\n\n1.5 3 0.8 0 0 1 # back\n"),
                           ("views.vf", "rvu -vtv -vp 1.5 0.5 1.5 -vd 0 1 0\n"),
                           ("job.json", json.dumps(JOB))):
            with open(os.path.join(folder, name), "w") as stream:
                stream.write(text)

    def connect(self, token):
        client = oriel.Client(self.url, token=token, ca_file=self.ca_file, timeout=30)
        self.sent, send = [], client._transport.send

        def noted(method, path, *rest, **named):
            self.sent.append(method + " " + path)
            return send(method, path, *rest, **named)

        client._transport.send = noted
        return client

    def long_job(self):
        scene = self.client.upload_scene(["room.rad"], folder=self.folder)
        return self.client.submit({"kind": "render", "scene": scene, "technique": "gather",
                                   "photons": {"global": 100000000},
                                   "sensors": [[1.5, 1, 0.8, 0, 0, 1]]})


def raises(kind, call, *arguments, **named):
    try:
        call(*arguments, **named)
    except kind as error:
        return error
    raise AssertionError("no %s" % kind.__name__)


def run_case(cases):
    """Runs the case that the command line names, without the user's own settings."""
    for variable in ("ORIEL_URL", "ORIEL_TOKEN", "ORIEL_CA", "ORIEL_CLIENT", "RAYPATH"):
        os.environ.pop(variable, None)
    os.environ["XDG_CONFIG_HOME"] = sys.argv[3]
    cases[sys.argv[1]](Desk(*sys.argv[2:6]))
