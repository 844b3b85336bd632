#!/usr/bin/python3
"""`make eta`: what the daemon says of the time that jobs still take, beside the time they took.

Usage: eta.py BUILD_DIR [--own] [NAME...]

Ten jobs, one after the other, polled twenty times a second. A row of each: its seconds; what was
said to be left after a tenth and after half of them, beside the truth; the worst factor between the
two, either way, from the first tenth on; the share of polls by which it rose; when something was
said first, and the longest time that percent stood still. Fails when the factor is beyond 1.5 (half
a second is forgiven, or the end would be divided by nothing), when more than one poll in twenty saw
it rise, or when a job for a deadline left more than a tenth of it, unless its reason is that
nothing was to be gained.

With --own no daemon is asked: each job runs on one thread of a process of its own, by whose
processor time it is judged (eta_course.c), so that other work on the machine does not show.
"""

import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "../../client/python"))
sys.path.insert(0, os.path.join(HERE, "../contract"))
import oriel
from daemons import Daemon

FACTOR, RISES, FORGIVEN_S, POLL_S = 1.5, 0.05, 0.5, 0.05
OFFICE = os.path.join(HERE, "../../client/examples/office")
GLASS = ["materials.rad", "room.rad", "ground.rad", "sky.rad", "glazing.rad", "upper_glass.rad"]
PANEL = GLASS[:-1] + ["panel.rad"]
DARK = GLASS[:3] + GLASS[4:]
VIEW = {"name": "room", "view": "-vtv -vp .35 5.6 1.5 -vd .25 -1 .05 -vu 0 0 1 -vh 75.2 -vv 60"}
GLOSSY = "void plastic desk_gloss 0 0 5 .3 .3 .3 .02 0\n" \
         "desk_gloss polygon shine 0 0 12 .6 2 .76 2 2 .76 2 3.2 .76 .6 3.2 .76\n"


def render(files, **more):
    return dict({"kind": "render", "scene": {"files": files}, "seed": 1}, **more)


def view(width, height):
    return [dict(VIEW, width=width, height=height)]


def skies(count):
    """Of as many altitudes of the sun as there are skies."""
    return [{"name": "s%03d" % i, "perez": {
        "sun_altitude": 15 + 45 * i / count, "sun_azimuth": -60 + 120 * i / count,
        "direct_normal_w_m2": 500, "diffuse_horizontal_w_m2": 120}}
            for i in range(count)]


SENSORS = {"sensors": {"file": "sensors.txt"}}
JOBS = {
    "glass, sensors and a view": render(GLASS, photons={"global": 2000000, "caustic": 2000000},
                                        views=view(400, 300), **SENSORS),
    "panel, sensors and a view": render(PANEL, photons={"global": 2000000, "caustic": 2000000},
                                        views=view(400, 300), **SENSORS),
    "sensors by gather": render(PANEL, technique="gather", gather_samples=65536, **SENSORS),
    "sensors by backward": render(GLASS, technique="backward", gather_samples=65536, **SENSORS),
    "view by backward": render(PANEL, technique="backward", pixel_samples=64, views=view(320, 240)),
    "view by precomputed": render(PANEL, technique="precomputed", views=view(640, 480)),
    "200 skies": render(DARK, skies=skies(200), **SENSORS),
    "goal of 0.5 %": render(PANEL, accuracy={"relative_error": 0.005}, **SENSORS),
    "rare caustics": render(GLASS + ["gloss.rad"], views=view(200, 150), **SENSORS),
    "deadline of 20 s": render(PANEL, accuracy={"deadline_s": 20}, **SENSORS),
}


def prepare(build):
    folder = tempfile.mkdtemp(prefix="oriel-eta-")
    for name in set(GLASS + PANEL + ["upper_pane.rad", "sensors.txt"]):
        shutil.copy(os.path.join(OFFICE, name), folder)
    with open(os.path.join(folder, "gloss.rad"), "w") as stream:
        stream.write(GLOSSY)
    kept = os.path.join(build, "bench", "eta_panel_made.xml")
    if not os.path.exists(kept):
        os.makedirs(os.path.dirname(kept), exist_ok=True)
        subprocess.run([os.path.join(build, "oriel"), "bsdf", "make",
                        os.path.join(OFFICE, "lcp", "lcp.json"), "-o", kept + ".part"],
                       check=True, stdout=subprocess.DEVNULL)
        os.replace(kept + ".part", kept)
    shutil.copy(kept, os.path.join(folder, "lcp.xml"))
    return folder


def follow(job):
    """[(seconds since it started, eta_s or None, percent)] and its last status."""
    seen, began = [], None
    while True:
        status = job.status()
        now = time.monotonic()
        if status["state"] in ("succeeded", "failed", "cancelled"):
            return seen, now - began if began else 0, status
        if status["state"] == "running":
            began = began or now
            seen.append((now - began, status.get("eta_s"), status.get("percent") or 0))
        time.sleep(POLL_S)


def run_alone(build, document, folder):
    """The same of a job by its own processor time."""
    with open(os.path.join(folder, "job.json"), "w") as stream:
        json.dump(document, stream)
    course = subprocess.run([os.path.join(build, "tests/bench/eta_course"), folder],
                            stdout=subprocess.PIPE, text=True)
    lines = [line.split() for line in course.stdout.splitlines()]
    seen = [(float(t), None if eta == "nan" else float(eta), 100 * float(fraction))
            for kind, t, fraction, eta in (line for line in lines if line[0] == "poll")]
    if course.returncode != 0:
        return seen, seen[-1][0], {"state": "failed"}
    return seen, float(lines[-1][1]), {"state": "succeeded"}


def at(seen, moment):
    told = [eta for t, eta, percent in seen if t >= moment]
    return told[0] if told and told[0] is not None else math.nan


def factor(told, left):
    if told is None:
        return math.inf
    low, high = sorted((told, left))
    return 1 if high - low <= FORGIVEN_S else high / max(low, 1e-3)


def longest_still(seen):
    longest = since = 0
    for (_, _, before), (t, _, percent) in zip(seen, seen[1:]):
        since = t if percent > before else since
        longest = max(longest, t - since)
    return longest


def judge(seen, seconds, status, deadline_s):
    late = [(t, eta) for t, eta, percent in seen if t >= 0.1 * seconds]
    told = [eta for t, eta in late if eta is not None]
    worst = max([factor(eta, seconds - t) for t, eta in late], default=1)
    rises = sum(b > a + POLL_S for a, b in zip(told, told[1:])) / max(len(told) - 1, 1)
    first = next((t for t, eta, percent in seen if eta is not None), math.inf)
    good = worst <= FACTOR and rises <= RISES and status["state"] == "succeeded"
    if deadline_s:
        good = good and 0.9 * deadline_s <= seconds <= 1.05 * deadline_s + FORGIVEN_S
    return worst, rises, first, good


def main():
    build, names = sys.argv[1], [name for name in sys.argv[2:] if name != "--own"]
    own = "--own" in sys.argv
    os.environ["ORIEL_BUILD"] = build
    folder, failed = prepare(build), 0
    daemon = None if own else Daemon(None, "--threads", "2")
    client = daemon and oriel.Client("http://127.0.0.1:%d" % daemon.port)
    print("  %-26s %7s %15s %15s %7s %6s %7s %7s" % (
        "job", "s", "left at 10 %", "left at 50 %", "factor", "rises", "first s", "still s"))
    try:
        for name, document in JOBS.items():
            if names and name not in names:
                continue
            seen, seconds, status = (
                run_alone(build, document, folder) if own
                else follow(client.submit(document, folder=folder)))
            deadline_s = document.get("accuracy", {}).get("deadline_s")
            worst, rises, first, good = judge(seen, seconds, status, deadline_s)
            failed += not good
            print("  %-26s %7.1f %7.1f %7.1f %7.1f %7.1f %7.2f %5.1f%% %7.1f %7.1f   %s" % (
                name, seconds, at(seen, 0.1 * seconds), 0.9 * seconds, at(seen, 0.5 * seconds),
                0.5 * seconds, worst, 100 * rises, first, longest_still(seen),
                "ok" if good else "FAIL %s" % (status["state"] if status["state"] != "succeeded"
                                               else "")), flush=True)
            if os.environ.get("ORIEL_ETA_TRACE"):
                with open(os.environ["ORIEL_ETA_TRACE"], "a") as stream:
                    stream.write(json.dumps({"name": name, "seen": seen, "s": seconds}) + "\n")
    finally:
        shutil.rmtree(folder)
        if daemon:
            daemon.process.kill()
            shutil.rmtree(daemon.folder, ignore_errors=True)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
