#!/usr/bin/python3
"""A year of the office by Radiance's programs, beside what backward says of its hours.

Usage: annual_radiance.py BUILD_DIR [--keep FOLDER]

Reads what `annual` left in the build folder (annual-*-hours.json, annual-*-desk.json, ...) and prints,
for clear glass and for the panel, at the 57 sensors: two-phase at Honeybee's default class and at a
middle one, the latter with the sun of 5185 places in place of its patches (enhanced two-phase, five-phase
with the panel), three-phase (Klems cells of the panel's pane, two-phase for the clear panes); for each seat
dcglare. Processor time as ray-times: seconds times the rate of Embree's own rays. Columns as those of
`annual`. Appends the rows to build/annual.json. Needs Radiance's programs on PATH and their library on
RAYPATH; says so and ends with 0 where there are none. No shell is used.
"""

import array
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

SENSORS = 57
WEIGHTS = (47.435, 119.93, 11.635)  # lm/W of 179, by channel
PROGRAMS = ("oconv", "rfluxmtx", "rcontrib", "gendaymtx", "dctimestep", "dcglare", "xform")
COMMON = ["materials.rad", "room.rad", "ground.rad", "glazing.rad"]
PANES = {"glass": "upper_glass.rad", "panel": "panel.rad"}
REINHART = (30, 30, 24, 24, 18, 12, 6)  # patches a row of Tregenza's; the zenith comes after
SKY = """#@rfluxmtx h=u u=Y
void glow ground_glow 0 0 4 1 1 1 0
ground_glow source below 0 0 4 0 0 -1 180
#@rfluxmtx h=r%d u=Y
void glow sky_glow 0 0 4 1 1 1 0
sky_glow source above 0 0 4 0 0 1 180
"""
# The panel's two panes, as a window that faces into the room.
PANE = "1.35 -.025 2.2 .05 -.025 2.2 .05 -.025 3.15 1.35 -.025 3.15"
PANE_EAST = "2.7 -.025 2.2 1.4 -.025 2.2 1.4 -.025 3.15 2.7 -.025 3.15"
WINDOW = """#@rfluxmtx h=kf u=Z
void glow window_glow 0 0 4 1 1 1 0
window_glow polygon west 0 0 12 %s
window_glow polygon east 0 0 12 %s
""" % (PANE, PANE_EAST)
DEFAULT = ["-ab", "2", "-ad", "5000", "-lw", "2e-5"]
MIDDLE = ["-ab", "5", "-ad", "10000", "-lw", "1e-5"]


class Desk:
    """A folder with the office in it, and the processor time that programs take there."""

    def __init__(self, build, scene, told, folder):
        self.folder, self.seconds = folder, 0.0
        source = "client/examples/office"
        for name in COMMON + [PANES[scene], "upper_pane.rad", "upper_glass.rad"]:
            shutil.copy(os.path.join(source, name), folder)
        shutil.copy(told["panel"], os.path.join(folder, "lcp.xml"))
        self.write("sensors.pts", "".join("%.9g %.9g %.9g %.9g %.9g %.9g\n" % tuple(s)
                                          for s in told["sensors"]))
        self.weather(os.path.join(build, "annual-weather.txt"))
        self.run(["oconv"] + COMMON + [PANES[scene]], "scene.oct")

    def weather(self, path):
        with open(path, "rb") as file:
            text = file.read()
        if text.startswith(b"place"):
            self.write("year.wea", text.decode())
        else:
            self.write("year.epw", text.decode(errors="replace"))
            self.run(["epw2wea", "year.epw", "year.wea"])

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def run(self, words, output=None, source=None):
        """Runs a program in the folder; its time and its children's go to seconds."""
        before = os.times()
        with open(self.path(output) if output else os.devnull, "wb") as out, \
                open(self.path(source) if source else os.devnull, "rb") as inp:
            done = subprocess.run(words, cwd=self.folder, stdin=inp, stdout=out,
                                  stderr=subprocess.PIPE, check=False)
        after = os.times()
        self.seconds += (after.children_user - before.children_user + after.children_system -
                         before.children_system)
        if done.returncode != 0:
            sys.exit("failed: %s\n%s" % (" ".join(words), done.stderr.decode(errors="replace")))

    def light(self, name, rows):
        """Lux [row][sensor] of a matrix of floats, of the rows that are asked for."""
        with open(self.path(name), "rb") as file:
            data = file.read()
        at = data.index(b"\n\n") + 2
        head = data[:at].decode(errors="replace")
        columns = int(re.search(r"NCOLS=\s*(\d+)", head).group(1))
        values = array.array("f")
        values.frombytes(data[at:])
        if len(values) != SENSORS * columns * 3:
            sys.exit("%s has %d values, not %d sensors' of %d" % (name, len(values), SENSORS, columns))
        return [[sum(WEIGHTS[k] * values[(s * columns + row) * 3 + k] for k in range(3))
                 for s in range(SENSORS)] for row in rows]


def errors_of(found, hours):
    """As `annual` has them: of relative errors over hours and sensors."""
    off, total, real = [], 0.0, 0.0
    for row, hour in zip(found, hours):
        for value, truth in zip(row, hour["lx"]):
            off.append(value / truth - 1)
            total += value
            real += truth
    sizes = sorted(abs(x) for x in off)
    return {"rms": math.sqrt(sum(x * x for x in off) / len(off)), "median": sizes[len(off) // 2],
            "p95": sizes[len(off) * 95 // 100], "bias": total / real - 1, "worst": sizes[-1]}


def print_row(rows, scene, name, seconds, rate, errors):
    print("%-28s %8.1f %9.0f %8.2f %8.2f %8.2f %+8.2f %8.1f" %
          (name, seconds, seconds * rate / 1e6, 100 * errors["rms"], 100 * errors["median"],
           100 * errors["p95"], 100 * errors["bias"], 100 * errors["worst"]), flush=True)
    rows.append(dict(errors, scene=scene, by="Radiance, " + name, seconds=seconds,
                     ray_times_m=seconds * rate / 1e6))


def coefficients(desk, octree, name, options, resolution=1):
    sky = "sky%d.rad" % resolution
    desk.write(sky, SKY % resolution)
    desk.run(["rfluxmtx", "-n", "1", "-y", str(SENSORS), "-I+", "-c", "1", "-faf"] + options +
             ["-", sky, "-i", octree], name, "sensors.pts")


def times(desk, matrices, sky, name):
    desk.run(["dctimestep", "-of"] + matrices + [sky], name)


def suns(desk):
    """A source in the middle of each patch of Reinhart's sky MF:6, and one for the ground before them."""
    lines, names, fold = [], [], 6
    step = 90 / (7 * fold + 0.5)

    def add(x, y, z):
        names.append("sun%d" % len(names))
        lines.append("void light %s 0 0 3 1 1 1\n%s source s%s 0 0 4 %.9g %.9g %.9g .533\n" %
                     (names[-1], names[-1], names[-1], x, y, z))

    add(0, 0, -1)
    for row in range(7 * fold):
        altitude = math.radians((row + 0.5) * step)
        count = fold * REINHART[row // fold]
        for k in range(count):
            azimuth = 2 * math.pi * k / count
            add(math.cos(altitude) * math.sin(azimuth), math.cos(altitude) * math.cos(azimuth),
                math.sin(altitude))
    add(0, 0, 1)
    desk.write("suns.rad", "".join(lines))
    desk.write("suns.txt", "".join(name + "\n" for name in names))
    return len(names)


def sun_coefficients(desk, scene, options):
    count = suns(desk)
    desk.run(["oconv", "-i", "scene.oct", "suns.rad"], "suns.oct")
    desk.run(["rcontrib", "-n", "1", "-y", str(SENSORS), "-I+", "-h", "-faf"] + options +
             ["-M", "suns.txt", "suns.oct"], "suns.bin", "sensors.pts")
    with open(desk.path("suns.bin"), "rb") as file:
        data = file.read()
    if len(data) != SENSORS * count * 12:
        sys.exit("rcontrib wrote %d bytes of %d suns" % (len(data), count))
    with open(desk.path("suns.mtx"), "wb") as file:
        file.write(b"#?RADIANCE\nNROWS=%d\nNCOLS=%d\nNCOMP=3\nBigEndian=0\nFORMAT=float\n\n" %
                   (SENSORS, count))
        file.write(data)


def minus_plus(total, direct, sun):
    return [[t - d + s for t, d, s in zip(a, b, c)] for a, b, c in zip(total, direct, sun)]


def phases(desk, build):
    """The panel's pane by three phases, and all else with the pane black."""
    desk.write("black.rad", "void plastic dark 0 0 5 0 0 0 0 0\n"
               "dark polygon west 0 0 12 %s\ndark polygon east 0 0 12 %s\n" % (PANE, PANE_EAST))
    desk.write("window.rad", WINDOW)
    desk.run(["oconv"] + COMMON + ["black.rad"], "black.oct")
    desk.run(["oconv"] + COMMON, "open.oct")
    seconds = desk.seconds
    desk.run([os.path.abspath(os.path.join(build, "oriel")), "bsdf", "convert", "lcp.xml", "-o",
              "klems.xml"])
    desk.seconds = seconds  # not of the method
    coefficients(desk, "black.oct", "rest.mtx", MIDDLE)
    desk.run(["rfluxmtx", "-n", "1", "-y", str(SENSORS), "-I+", "-c", "1", "-faf"] + MIDDLE +
             ["-", "window.rad", "-i", "open.oct"], "view.mtx", "sensors.pts")
    desk.run(["rfluxmtx", "-n", "1", "-c", "1000", "-ab", "2", "-ad", "200", "-ff", "window.rad",
              "sky1.rad", "-i", "open.oct"], "day.mtx")


def try_scene(build, scene, told, folder, rows):
    desk, hours, rate = Desk(build, scene, told, folder), told["hours"], told["rate"]
    wanted = [hour["row"] for hour in hours]
    desk.seconds = 0
    desk.run(["gendaymtx", "-of", "-m", "1", "year.wea"], "sky.smx")
    of_sky = desk.seconds

    def method(name, make, before=of_sky):
        desk.seconds = before
        found = make()
        print_row(rows, scene, name, desk.seconds, rate, errors_of(found, hours))
        return desk.seconds, found

    def two_phase(options):
        coefficients(desk, "scene.oct", "dc.mtx", options)
        times(desk, ["dc.mtx"], "sky.smx", "year.mtx")
        return desk.light("year.mtx", wanted)

    method("two-phase, default class", lambda: two_phase(DEFAULT))
    spent, total = method("two-phase, MF:1, 5 bounces", lambda: two_phase(MIDDLE))

    def enhanced():
        desk.run(["gendaymtx", "-of", "-m", "1", "-d", "year.wea"], "direct.smx")
        coefficients(desk, "scene.oct", "direct.mtx", ["-ab", "1"] + MIDDLE[2:])
        times(desk, ["direct.mtx"], "direct.smx", "year.mtx")
        direct = desk.light("year.mtx", wanted)
        desk.run(["gendaymtx", "-of", "-m", "6", "-5", ".533", "-d", "year.wea"], "suns.smx")
        sun_coefficients(desk, scene, ["-ab", "0"] if scene == "glass" else
                         ["-ab", "1", "-ad", "2048", "-lw", "1e-4"])
        times(desk, ["suns.mtx"], "suns.smx", "year.mtx")
        return minus_plus(total, direct, desk.light("year.mtx", wanted))

    method("enhanced two-phase" if scene == "glass" else "five-phase way", enhanced, spent)
    if scene == "panel":
        def three():
            phases(desk, build)
            times(desk, ["rest.mtx"], "sky.smx", "rest.out")
            times(desk, ["view.mtx", "klems.xml", "day.mtx"], "sky.smx", "year.mtx")
            return [[a + b for a, b in zip(x, y)] for x, y in
                    zip(desk.light("rest.out", wanted), desk.light("year.mtx", wanted))]
        method("three-phase", three)
    return desk, of_sky


def try_seat(desk, of_sky, scene, name, seat, rate, rows):
    desk.seconds = of_sky
    desk.write("seat.vf", "%.9g %.9g %.9g %.9g %.9g %.9g\n" % tuple(seat["seat"]))
    for bounces, matrix in ((1, "glare1.mtx"), (8, "glare8.mtx")):
        desk.run(["rfluxmtx", "-n", "1", "-y", "1", "-I+", "-c", "1", "-faf", "-ab", str(bounces),
                  "-ad", "50000", "-lw", "1e-5", "-", "sky1.rad", "-i", "scene.oct"], matrix, "seat.vf")
    desk.run(["dcglare", "-h", "-vf", "seat.vf", "glare1.mtx", "glare8.mtx", "sky.smx"], "dgp.txt")
    with open(desk.path("dgp.txt"), encoding="ascii") as file:
        found = [float(word) for word in file.read().split()]
    off = [found[row] - dgp for row, dgp in zip(seat["rows"], seat["dgp"])]
    rms, worst = math.sqrt(sum(x * x for x in off) / len(off)), max(abs(x) for x in off)
    print("%-28s %8.1f %9.0f rms of DGP %.4f, worst %.4f, of %d pictures" %
          ("dcglare, " + name, desk.seconds, desk.seconds * rate / 1e6, rms, worst, len(off)), flush=True)
    rows.append({"scene": scene, "seat": name, "by": "Radiance, dcglare", "seconds": desk.seconds,
                 "ray_times_m": desk.seconds * rate / 1e6, "rms_dgp": rms, "worst_dgp": worst})


def append(build, rows):
    path = os.path.join(build, "annual.json")
    with open(path, encoding="utf-8") as file:
        document = json.load(file)
    document["radiance"] = rows
    with open(path + ".part", "w", encoding="utf-8") as file:
        json.dump(document, file, indent=1)
    os.replace(path + ".part", path)


def main(words):
    missing = [p for p in PROGRAMS if not shutil.which(p)]
    if len(words) not in (2, 4) or (len(words) == 4 and words[2] != "--keep"):
        sys.exit(__doc__)
    if missing:
        print("Radiance beside it: left out, %s is not on PATH" % missing[0])
        return
    build, rows, started = words[1], [], time.time()
    for scene in ("glass", "panel"):
        path = os.path.join(build, "annual-%s-hours.json" % scene)
        if not os.path.exists(path):
            continue
        with open(path, encoding="utf-8") as file:
            told = json.load(file)
        print("Radiance's programs, %s, one thread\n%-28s %8s %9s %8s %8s %8s %8s %8s" %
              (scene, "", "seconds", "ray-times", "rms %", "median", "95 %", "bias", "worst"), flush=True)
        folder = tempfile.mkdtemp() if len(words) == 2 else os.path.join(words[3], scene)
        os.makedirs(folder, exist_ok=True)
        desk, of_sky = try_scene(build, scene, told, folder, rows)
        for name in ("desk", "middle"):
            path = os.path.join(build, "annual-%s-%s.json" % (scene, name))
            if os.path.exists(path):
                with open(path, encoding="utf-8") as file:
                    try_seat(desk, of_sky, scene, name, json.load(file), told["rate"], rows)
        if len(words) == 2:
            shutil.rmtree(folder)
    append(build, rows)
    print("Radiance's programs took %.0f s" % (time.time() - started))


main(sys.argv)
