"""Stops every kind of work at random moments, and measures how soon it has ended.

    python3 tests/torture/cancel_kinds.py BUILD [--moments N] [--seed N] [--quick]

The command (run, plan, annual, study, bsdf make, fit and convert) gets SIGTERM and SIGINT by turns, a
daemon's jobs of each kind are cancelled, and a daemon that runs one gets SIGTERM. Moments are spread
over what the work takes when nothing stops it, measured first, LONGEST_S at most. Prints a table of
latencies; one above 2 s fails the run.

With --quick nothing is measured first, and what is bounded is not the time but what the process
computes after the stop: 2 s of all its threads together. So other load does not matter.
"""

import argparse
import json
import math
import os
import random
import resource
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

from daemon import Daemon, computed_s

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(TOP, "client", "python"))
import oriel  # noqa: E402  pylint: disable=wrong-import-position,wrong-import-order

WORST_S = 2.0
LONGEST_S = 5.0
QUICK_S = 0.5
QUICK_PANES_S = 2.0  # its sensors come after a map of sunlight
GIVE_UP_S = 60.0
POLL_S = 0.002
SCENE = ["materials.rad", "room.rad", "ground.rad", "sky.rad", "glazing.rad", "upper_glass.rad"]
VIEW = "-vtv -vp 0.35 5.6 1.5 -vd 0.25 -1 0.05 -vu 0 0 1 -vh 75.2 -vv 60"


# ---- Inputs -------------------------------------------------------------------------------------

def write_measurements(path, scans, rows):
    """A glossy sample, measured from so many directions."""
    with open(path, "w", encoding="ascii") as out:
        out.write("theta_in,phi_in,theta_out,phi_out,bsdf\n")
        for k in range(scans):
            theta_in, phi_in = math.acos(1 - 0.98 * (k + 0.5) / scans), math.radians(233.75 * k)
            for i in range(rows):
                theta = math.acos(1 - 0.97 * (i + 0.5) / rows)
                phi = math.radians(137.508 * i)
                cosine = (math.cos(theta) * math.cos(theta_in) - math.sin(theta) *
                          math.sin(theta_in) * math.cos(phi - phi_in))
                out.write("%.3f,%.2f,%.3f,%.2f,%.6f\n" % (
                    math.degrees(theta_in), math.degrees(phi_in) % 360, math.degrees(theta),
                    math.degrees(phi) % 360, 0.05 + 3 * math.exp(-60 * (1 - cosine))))


def write_facets(path, side):
    """A field of triangles, which takes time to read and to build a hierarchy of."""
    with open(path, "w", encoding="ascii") as out:
        out.write("void plastic grey 0 0 5 .5 .5 .5 0 0\n")
        for i in range(side * side):
            x, y, z = i % side / 50 - 20, i // side / 50 - 40, -1 - 0.01 * (i % 7)
            out.write("grey polygon f%d 0 0 9 %g %g %g %g %g %g %g %g %g\n" % (
                i, x, y, z, x + 0.015, y, z, x, y + 0.015, z - 0.01))


def write_panes(path, count):
    """A closed room with a window and parallel panes, in each of which the sun is mirrored."""
    with open(path, "w", encoding="ascii") as out:
        out.write("""void plastic grey 0 0 5 .5 .5 .5 0 0
void glass clear 0 0 3 .9 .9 .9
grey polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0
grey polygon ceiling 0 0 12 0 0 3 0 4 3 4 4 3 4 0 3
grey polygon south 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0
grey polygon north 0 0 12 0 4 0 4 4 0 4 4 3 0 4 3
grey polygon east 0 0 12 4 0 0 4 0 3 4 4 3 4 4 0
clear polygon window 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3
""")
        for i in range(count):
            x = 0.5 + 3 * i / count
            out.write("clear polygon pane%d 0 0 12 %g .1 .1 %g 3.9 .1 %g 3.9 2.9 %g .1 2.9\n" % (
                i, x, x, x, x))


def write_year(path):
    """Weather of a year whose days are all clear."""
    with open(path, "w", encoding="ascii") as out:
        out.write("place clear\nlatitude 40\nlongitude 0\ntime_zone 0\nsite_elevation 0\n"
                  "weather_data_file_units 1\n")
        for month, days in enumerate((31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31), 1):
            for hour in range(24 * days):
                lit = 7 <= hour % 24 <= 17
                out.write("%d %d %.1f %d %d\n" % (month, 1 + hour // 24, hour % 24 + 0.5,
                                                  700 * lit, 100 * lit))


def make_inputs(folder, build, quick):
    """All files of all kinds; the jobs are long, but for none to end within QUICK_S."""
    office = os.path.join(TOP, "client", "examples", "office")
    for name in os.listdir(office):
        if name.endswith(".rad") or name == "sensors.txt":
            shutil.copy(os.path.join(office, name), folder)
    shutil.copy(os.path.join(office, "lcp", "lcp.rad"), folder)
    shutil.copy(os.path.join(TOP, "tests", "fixtures", "weather.epw"), folder)
    write_measurements(os.path.join(folder, "measured.csv"), 20 if quick else 60,
                       300 if quick else 3000)
    write_facets(os.path.join(folder, "facets.rad"), 100 if quick else 500)
    write_panes(os.path.join(folder, "panes.rad"), 60)
    write_panes(os.path.join(folder, "empty.rad"), 0)
    write_year(os.path.join(folder, "year.wea"))
    with open(os.path.join(TOP, "client", "examples", "office", "lcp", "lcp.json"),
              encoding="utf-8") as stream:
        panel = json.load(stream)
    with open(os.path.join(folder, "panel.json"), "w", encoding="utf-8") as out:
        json.dump(dict(panel, resolution=16, accuracy=0.1), out)
    subprocess.run([os.path.join(build, "oriel"), "bsdf", "make", "panel.json", "-o", "panel.xml"],
                   cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return panel


def documents(panel):
    """By kind; file names in the scene's place are replaced for the daemon."""
    files = {"files": SCENE + ["facets.rad"]}
    view = [{"name": "room", "view": VIEW, "width": 800, "height": 600}]
    sensors = {"file": "sensors.txt"}
    panes = {"kind": "annual", "scene": {"files": ["panes.rad"]}, "weather": "year.wea"}
    return {
        "gather": {"kind": "render", "scene": files, "technique": "gather", "sensors": sensors,
                   "views": view, "photons": {"global": 500000, "caustic": 500000}},
        "backward": {"kind": "render", "scene": files, "technique": "backward",
                     "sensors": sensors, "views": view},
        "annual": {"kind": "annual", "scene": {"files": [name for name in SCENE
                                                         if name != "sky.rad"]},
                   "weather": "weather.epw", "rules": ["LEED", "EN 17037"],
                   "grids": [{"name": "places", "sensors": sensors}]},
        "study": {"kind": "study", "scene": files, "techniques": ["gather", "backward"],
                  "sensors": sensors, "photons": [200000], "gather_samples": [1024],
                  "repeats": 3, "reference": {"samples": 16384, "runs": 4}},
        "annual, panes": dict(panes, samples=1,
                              sensors=[[1.5 + 0.1 * i, 2, 0.8, 0, 0, 1] for i in range(16)]),
        # Mostly pictures and pages, of which each grid has dozens.
        "annual, pictures": dict(panes, scene={"files": ["empty.rad"]}, weather="weather.epw",
                                 samples=1, rules=["LEED", "EN 17037"], grids=[
                                     {"name": "place %d" % i, "sensors": [
                                         [0.5 + x, 0.5 + y, 0.8 + 0.001 * i, 0, 0, 1]
                                         for x in range(4) for y in range(4)]}
                                     for i in range(256)]),
        "annual, photons": dict(panes, technique="precomputed", photons=200000000,
                                sensors=[[1.5, 2, 0.8, 0, 0, 1]]),
        "bsdf_make": dict(panel, scene={"files": ["lcp.rad"]}),
    }


# ---- What is measured ---------------------------------------------------------------------------

class Table:
    def __init__(self, quick):
        self.quick, self.rows, self.good = quick, [], True

    def add(self, name, whole_s, stops, ended):
        """stops: pairs of latency and of what was computed in it, in seconds."""
        took, computed = [[stop[i] for stop in stops] or [0] for i in range(2)]
        good = max(computed if self.quick else took) <= WORST_S
        self.good = self.good and good
        print("cancel_kinds %-24s %2d stops within %.1f s, %2d had ended: median %4.0f ms, worst %4.0f "
              "ms, worst computed %4.0f ms%s" % (
                  name, len(stops), whole_s, ended, 1e3 * statistics.median(took), 1e3 * max(took),
                  1e3 * max(computed), "" if good else " FAILED"), flush=True)


class Course:
    """The moments of one kind: spread over the time that it takes by itself."""

    def __init__(self, arguments, name):
        self.chance = random.Random("%d/%s" % (arguments.seed, name))
        self.count, self.quick = arguments.moments, arguments.quick
        self.whole_s = QUICK_PANES_S if "panes" in name else QUICK_S

    def measure(self, run_for):
        """run_for(s): runs it for so long at most, and returns how long it took."""
        if not self.quick:
            self.whole_s = min(run_for(LONGEST_S), LONGEST_S)

    def moments(self):
        return [self.chance.random() * self.whole_s for _ in range(self.count)]


# ---- The command --------------------------------------------------------------------------------

class Command:
    def __init__(self, build, folder, words):
        self.line, self.folder = [os.path.join(build, "oriel"), *words], folder

    def start(self):
        return subprocess.Popen(self.line, cwd=self.folder, stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL)

    def clean(self):
        shutil.rmtree(os.path.join(self.folder, "out"), ignore_errors=True)

    def run_for(self, seconds):
        process, begun = self.start(), time.monotonic()
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        self.clean()
        return time.monotonic() - begun

    def stop_after(self, seconds, signum):
        """Its latency, and what it computed meanwhile; None: it had ended."""
        process = self.start()
        time.sleep(seconds)
        if process.poll() is not None:
            self.clean()
            return None
        before, begun = computed_s(process.pid), time.monotonic()
        process.send_signal(signum)
        _, _, usage = os.wait4(process.pid, 0)
        took = time.monotonic() - begun
        process.returncode = 0
        self.clean()
        return took, max(0, usage.ru_utime + usage.ru_stime - before)


def stop_commands(arguments, folder, table, wanted):
    threads = ["--threads", "2"]
    lines = {
        "run gather": ["run", "gather.json", "-o", "out", *threads],
        "run backward": ["run", "backward.json", "-o", "out", *threads],
        "plan": ["plan", "gather.json", *threads],
        "annual": ["annual", "annual.json", "-o", "out", "--honeybee", "--ill", *threads],
        "annual, pictures": ["annual", "annual, pictures.json", "-o", "out", *threads],
        "study": ["study", "study.json", "-o", "out", *threads],
        "bsdf make": ["bsdf", "make", "bsdf_make.json", "-o", "made.xml", *threads],
        "bsdf fit": ["bsdf", "fit", "measured.csv", "-o", "fitted.xml", *threads],
        "bsdf convert": ["bsdf", "convert", "panel.xml", "-o", "converted.xml", "--basis",
                         "tensor_tree_4", "--resolution", "64", *threads],
    }
    for name, line in lines.items():
        if not wanted("oriel " + name):
            continue
        command, course = Command(arguments.build, folder, line), Course(arguments, name)
        course.measure(command.run_for)
        took = [command.stop_after(moment, (signal.SIGTERM, signal.SIGINT)[i % 2])
                for i, moment in enumerate(course.moments())]
        stopped = [one for one in took if one is not None]
        table.add("oriel " + name, course.whole_s, stopped, len(took) - len(stopped))


# ---- Reading --------------------------------------------------------------------------------

def write_broken(folder):
    """A document and a BSDF that take a while to read, and turn out broken at their ends."""
    with open(os.path.join(folder, "broken.json"), "w", encoding="ascii") as out:
        out.write('{"sensors": [')
        out.write("[0, 0, 0, 0, 0, 1],\n" * 500000)
        out.write("}")
    with open(os.path.join(folder, "broken.xml"), "w", encoding="ascii") as out:
        out.write("<WindowElement>")
        out.write("<Layer a='b'><c>d</c></Layer>\n" * 500000)
        out.write("</Broken>")


def catches(pid, signum):
    try:
        with open("/proc/%d/status" % pid, encoding="ascii") as stream:
            caught = next(line for line in stream if line.startswith("SigCgt:"))
    except (FileNotFoundError, StopIteration):
        return False
    return int(caught.split()[1], 16) >> (signum - 1) & 1 == 1


def stop_reading(arguments, folder, table, wanted):
    """A signal while the command's file is read is heeded before the end, where the file is refused.
    Which of the two is said does not depend on the machine's speed."""
    lines = {
        "run": ["run", "broken.json", "-o", "out"],
        "plan": ["plan", "broken.json"],
        "annual": ["annual", "broken.json", "-o", "out"],
        "study": ["study", "broken.json", "-o", "out"],
        "bsdf make": ["bsdf", "make", "broken.json", "-o", "made.xml"],
        "bsdf fit": ["bsdf", "fit", "broken.json", "-o", "fitted.xml"],
        "bsdf convert": ["bsdf", "convert", "broken.xml", "-o", "converted.xml"],
    }
    write_broken(folder)
    for number, (name, line) in enumerate(lines.items()):
        if not wanted("oriel %s, reading" % name):
            continue
        process = subprocess.Popen([os.path.join(arguments.build, "oriel"), *line], cwd=folder,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        signum, until = (signal.SIGTERM, signal.SIGINT)[number % 2], time.monotonic() + GIVE_UP_S
        while (not catches(process.pid, signum) and process.poll() is None and
               time.monotonic() < until):
            time.sleep(POLL_S)
        process.send_signal(signum)
        said = process.communicate(timeout=GIVE_UP_S)[1].decode()
        good = "cancelled" in said
        table.good = table.good and good
        print("cancel_kinds %-24s stopped while its file is read: %s" % (
            "oriel " + name, "cancelled" if good else "%s FAILED" % said.strip()), flush=True)


# ---- The daemon ---------------------------------------------------------------------------------

class Jobs:
    """Jobs of one kind, each with a seed or name of its own, so that none is found done."""

    def __init__(self, daemon, client, document):
        self.daemon, self.client, self.document, self.number = daemon, client, document, 0

    def submit(self):
        self.number += 1
        own = ({"name": "sample %d" % self.number} if self.document["kind"] == "bsdf_fit"
               else {"seed": self.number})
        return self.client.submit(dict(self.document, **own))

    def run_for(self, seconds):
        job, begun = self.submit(), time.monotonic()
        while (job.status()["state"] not in ("succeeded", "failed") and
               time.monotonic() < begun + seconds):
            time.sleep(0.05)
        took, status = time.monotonic() - begun, job.status()
        if status["state"] == "failed":
            raise SystemExit("cancel_kinds: %s" % json.dumps(status))
        self.stop(job)
        return took

    def stop(self, job):
        """False: it had ended."""
        try:
            job.cancel()
        except oriel.Problem:
            return False
        until = time.monotonic() + GIVE_UP_S
        while job.status()["state"] not in ("cancelled", "succeeded", "failed"):
            if time.monotonic() > until:
                raise SystemExit("cancel_kinds: a job is not gone after %.0f s" % GIVE_UP_S)
            time.sleep(POLL_S)
        return job.status()["state"] == "cancelled"

    def stop_after(self, seconds):
        job = self.submit()
        time.sleep(seconds)
        pid = self.daemon.process.pid
        before, begun = computed_s(pid), time.monotonic()
        if not self.stop(job):
            return None
        return time.monotonic() - begun, computed_s(pid) - before


def upload(client, folder, doc):
    """The document with ids in place of files."""
    told = dict(doc)
    if doc["kind"] == "bsdf_fit":
        told["measurements"] = client.upload_scene(["measured.csv"], folder=folder)
        return told
    names = doc["scene"]["files"]
    if doc["kind"] == "annual":
        told["scene"] = client.upload_scene(names, resources=["weather.epw", "year.wea",
                                                               "upper_pane.rad"], folder=folder)
    else:
        told["scene"] = client.upload_scene(names, folder=folder)
    with open(os.path.join(folder, "sensors.txt"), encoding="ascii") as stream:
        rows = [[float(word) for word in line.split()] for line in stream
                if line.strip() and not line.startswith("#")]
    if told.get("sensors") == {"file": "sensors.txt"}:
        told["sensors"] = rows
    if told.get("grids", [{}])[0].get("sensors") == {"file": "sensors.txt"}:
        told["grids"] = [dict(grid, sensors=rows) for grid in told["grids"]]
    return told


def stop_jobs(arguments, folder, table, kinds, wanted):
    daemon = Daemon(arguments.build, os.path.join(folder, "data"), ["--threads", "2"])
    try:
        daemon.wait_listening()
        client = oriel.Client("http://127.0.0.1:%d" % daemon.port)
        for name, doc in kinds.items():
            if not wanted("job " + name):
                continue
            jobs, course = Jobs(daemon, client, upload(client, folder, doc)), Course(arguments,
                                                                                   "job " + name)
            course.measure(jobs.run_for)
            took = [jobs.stop_after(moment) for moment in course.moments()]
            stopped = [one for one in took if one is not None]
            table.add("job " + name, course.whole_s, stopped, len(took) - len(stopped))
        daemon.stop()
    finally:
        if daemon.process.returncode is None:
            daemon.kill()
            daemon.wait()


def stop_daemons(arguments, folder, table, kinds, wanted):
    """SIGTERM while a job runs; the daemon has no patience (--drain-timeout 0)."""
    if not wanted("orield"):
        return
    course, took, names = Course(arguments, "orield"), [], list(kinds)
    course.measure(lambda seconds: seconds / 4)
    for i, moment in enumerate(course.moments()):
        root = os.path.join(folder, "stopped-%d" % i)
        daemon = Daemon(arguments.build, root, ["--threads", "2"])
        daemon.wait_listening()
        client = oriel.Client("http://127.0.0.1:%d" % daemon.port)
        Jobs(daemon, client, upload(client, folder, kinds[names[i % len(names)]])).submit()
        time.sleep(moment)
        before, begun = computed_s(daemon.process.pid), time.monotonic()
        all_before = resource.getrusage(resource.RUSAGE_CHILDREN)
        daemon.stop()
        latency = time.monotonic() - begun
        all_after = resource.getrusage(resource.RUSAGE_CHILDREN)
        whole = (all_after.ru_utime + all_after.ru_stime - all_before.ru_utime -
                 all_before.ru_stime)
        took.append((latency, max(0, whole - before)))
        shutil.rmtree(root)
        os.unlink(root + ".log")
    table.add("orield, SIGTERM in a job", course.whole_s, took, 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("build")
    parser.add_argument("--moments", type=int, default=50, help="of each kind")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--quick", action="store_true", help="small inputs; bounds computation")
    parser.add_argument("--only", default="", help="kinds with this in their name")
    arguments = parser.parse_args()
    arguments.build = os.path.abspath(arguments.build)
    # A shell starts its background jobs with SIGINT ignored, which programs inherit.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    folder, table = tempfile.mkdtemp(prefix="oriel-cancel-"), Table(arguments.quick)
    try:
        kinds = documents(make_inputs(folder, arguments.build, arguments.quick))
        for name, document in kinds.items():
            with open(os.path.join(folder, name + ".json"), "w", encoding="utf-8") as out:
                json.dump(document, out)
        kinds["bsdf_fit"] = {"kind": "bsdf_fit"}

        def wanted(name):
            return arguments.only in name

        stop_commands(arguments, folder, table, wanted)
        stop_reading(arguments, folder, table, wanted)
        stop_jobs(arguments, folder, table, kinds, wanted)
        stop_daemons(arguments, folder, table, kinds, wanted)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    print("cancel_kinds: seed %d, no stop above %.0f s: %s" % (
        arguments.seed, WORST_S, "met" if table.good else "FAILED"))
    return 0 if table.good else 1


if __name__ == "__main__":
    sys.exit(main())
