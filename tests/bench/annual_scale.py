#!/usr/bin/python3
"""How the cost of a year grows with window groups, mirrors and sensors.

Usage: annual_scale.py BUILD_DIR [--quick]

Makes scenes of its own: rooms in a row, each with a window that is a group with two states under
LM-83's rule; panes of glass before one of them, together always as large, each in a plane of its own;
and sensors. Runs `oriel annual` for a whole made-up year of few paths and prints processor seconds, and
milliseconds of them for each sensor. Wall time does not count, so other work on the machine matters
little. Leaves the rows in build/annual-scale.json.
"""

import json
import math
import os
import resource
import subprocess
import sys
import tempfile

MATERIALS = """void plastic wall 0 0 5 .5 .5 .5 0 0
void glass clear 0 0 3 .88 .88 .88
void glass tinted 0 0 3 .3 .3 .3
void plastic earth 0 0 5 .2 .2 .2 0 0
"""
WIDTH, PITCH = 4.0, 5.0
SAMPLES = 256


def polygon(material, name, corners):
    numbers = " ".join("%.9g" % x for corner in corners for x in corner)
    return "%s polygon %s 0 0 %d %s\n" % (material, name, 3 * len(corners), numbers)


def room(index):
    """A box of 4 m by 4 m by 3 m whose south side has a window of 2 m by 1.5 m."""
    x, w, d, h = index * PITCH, WIDTH, 4.0, 3.0
    a, b, low, high = x + 1, x + 3, 0.8, 2.3
    faces = {
        "floor": [(x, 0, 0), (x + w, 0, 0), (x + w, d, 0), (x, d, 0)],
        "ceiling": [(x, 0, h), (x, d, h), (x + w, d, h), (x + w, 0, h)],
        "north": [(x, d, 0), (x + w, d, 0), (x + w, d, h), (x, d, h)],
        "west": [(x, 0, 0), (x, d, 0), (x, d, h), (x, 0, h)],
        "east": [(x + w, 0, 0), (x + w, 0, h), (x + w, d, h), (x + w, d, 0)],
        "below": [(x, 0, 0), (x, 0, low), (x + w, 0, low), (x + w, 0, 0)],
        "above": [(x, 0, high), (x, 0, h), (x + w, 0, h), (x + w, 0, high)],
        "left": [(x, 0, low), (x, 0, high), (a, 0, high), (a, 0, low)],
        "right": [(b, 0, low), (b, 0, high), (x + w, 0, high), (x + w, 0, low)],
    }
    text = "".join(polygon("wall", "%s%d" % item, faces[item[0]]) for item in ((k, index) for k in faces))
    return text + polygon("clear", "window%d" % index, [(a, 0, low), (a, 0, high), (b, 0, high), (b, 0, low)])


def mirrors(number):
    """Panes all over a field of 8 m by 6 m, of four tilts; no two of them in one plane."""
    text, side = "", math.sqrt(16.0 / max(number, 1)) / 2
    for i in range(number):
        x = -2 + 8 * ((i * 0.6180339887) % 1)
        y = -7 + 6 * ((i + 0.5) / number)
        z = 0.2 + 1.5 * ((i * 0.7548776662) % 1)
        tilt = math.radians(10 * (i % 4))
        c, s = side * math.cos(tilt), side * math.sin(tilt)
        text += polygon("clear", "pane%d" % i, [(x - side, y - c, z - s), (x + side, y - c, z - s),
                                                (x + side, y + c, z + s), (x - side, y + c, z + s)])
    return text


def sensors(rooms, number):
    """So many in all, spread over the rooms."""
    rows = []
    for i in range(number):
        r, k = i % rooms, i // rooms
        rows.append([r * PITCH + 0.5 + 3 * ((k * 0.6180339887) % 1), 0.5 + 3 * ((k * 0.7548776662) % 1),
                     0.8, 0, 0, 1])
    return rows


def make_year():
    """A made-up year at 38 degrees north: the sun by its declination, clouds by the day and the hour."""
    lines = ["place made_up", "latitude 38.0", "longitude 0.0", "time_zone 0", "site_elevation 0",
             "weather_data_file_units 1"]
    latitude, day = math.radians(38), 0
    for month, days in enumerate((31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31), 1):
        for of_month in range(1, days + 1):
            declination = -0.4093 * math.cos(2 * math.pi * (day + 10) / 365)
            for hour in range(24):
                up = max(0, math.sin(latitude) * math.sin(declination) +
                         math.cos(latitude) * math.cos(declination) * math.cos((hour - 11.5) * math.pi / 12))
                clear = 0.5 - 0.5 * math.sin(day * 2.4)
                direct = 900 * 0.7 ** (0.6 / (up + 0.1)) * clear if up > 0 else 0
                lines.append("%d %d %.1f %.0f %.0f" % (month, of_month, hour + 0.5, direct, up * 200))
            day += 1
    return "\n".join(lines) + "\n"


def seconds(build, rooms, panes, points, shaded):
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "scene.rad"), "w", encoding="ascii") as file:
            file.write(MATERIALS + "".join(room(i) for i in range(rooms)) + mirrors(panes))
            file.write(polygon("earth", "ground", [(-500, -500, -.1), (500, -500, -.1), (500, 500, -.1),
                                                   (-500, 500, -.1)]))
        with open(os.path.join(folder, "year.wea"), "w", encoding="ascii") as file:
            file.write(make_year())
        document = {"kind": "annual", "scene": {"files": ["scene.rad"]}, "weather": "year.wea", "seed": 1,
                    "samples": SAMPLES, "grids": [{"name": "all", "sensors": sensors(rooms, points)}]}
        if shaded:
            document["shades"] = [
                {"name": "group%d" % i, "windows": ["window%d" % i],
                 "states": [{"name": "open"}, {"name": "tinted", "material": "tinted"}],
                 "control": {"by": "LM-83"}} for i in range(rooms)]
        path = os.path.join(folder, "year.json")
        with open(path, "w", encoding="ascii") as file:
            json.dump(document, file)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([os.path.join(build, "oriel"), "annual", path, "-o", os.path.join(folder, "out")],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        if done.returncode != 0:
            sys.exit(done.stdout.decode(errors="replace"))
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    build = sys.argv[1]
    quick = "--quick" in sys.argv
    series = [("window groups", [(n, (n, 0, 128, True)) for n in (1, 4, 16, 64)]),
              ("mirrors", [(n, (1, n, 64, False)) for n in (1, 4, 16, 64, 256)]),
              ("sensors", [(n, (1, 16, n, False)) for n in (16, 64, 256, 1024)])]
    rows = []
    for name, cases in series:
        print("%-14s %8s %12s %14s" % (name, "sensors", "core s", "ms a sensor"))
        for number, case in cases[:3] if quick else cases:
            took = seconds(build, *case)
            rows.append({"series": name, "number": number, "sensors": case[2], "core_s": took})
            print("%14d %8d %12.2f %14.1f" % (number, case[2], took, 1000 * took / case[2]), flush=True)
    with open(os.path.join(build, "annual-scale.json"), "w", encoding="ascii") as file:
        json.dump(rows, file, indent=1)


if __name__ == "__main__":
    main()
