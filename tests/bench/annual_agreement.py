#!/usr/bin/python3
"""Hours of a model's year beside the same hours by backward, one by one.

Usage: annual_agreement.py BUILD_DIR MODEL.hbjson WEATHER.epw [--every N] [--seeds N] [--hours N]

Keeps every N-th sensor of the model, runs the year with several seeds, and the brightest hours of ten
parts of the year by jobs of their own (technique backward to 1 %, same weather). Prints for each hour the
mean of both in lux, the mean over sensors of their ratio, and how far the sensors are apart in standard
errors: root mean square, worst, and how many are beyond 3. The year's errors are the spread of its seeds,
which does not include the error of interpolation between nodes of the sun: a few percent at single
sensors, equal for all seeds. With many seeds, differences are therefore beyond 3 standard errors; the mean
ratio shows the bias. The errors of single hours are the jobs' own.
"""

import array
import json
import math
import os
import subprocess
import sys
import tempfile

DAYS = (31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)


def option(name, default):
    return int(sys.argv[sys.argv.index(name) + 1]) if name in sys.argv else default


def run(build, *arguments):
    done = subprocess.run([os.path.join(build, "oriel"), *arguments], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        sys.exit(done.stdout.decode(errors="replace"))


def thin(path, every, to):
    with open(path, encoding="utf-8") as file:
        model = json.load(file)
    kept = 0
    grids = model["properties"]["radiance"]["sensor_grids"]
    for grid in grids:
        grid["sensors"] = grid["sensors"][every // 2::every] or grid["sensors"][:1]
        grid.pop("mesh", None)
        kept += len(grid["sensors"])
    with open(to, "w", encoding="utf-8") as file:
        json.dump(model, file)
    return kept


def read_matrix(path):
    with open(path, "rb") as file:
        header, body = file.read().split(b"\n\n", 1)
    fields = dict(line.split(b"=", 1) for line in header.split(b"\n") if b"=" in line)
    values = array.array("f")
    values.frombytes(body)
    columns = int(fields[b"NCOLS"])
    return [values[i:i + columns] for i in range(0, len(values), columns)]


def read_year(folder):
    rows = []
    for name in sorted(os.listdir(folder)):
        if name.endswith(".ill") and not name.endswith((".direct.ill", ".se.ill")):
            rows += [(name[:-4], i, row) for i, row in enumerate(read_matrix(os.path.join(folder, name)))]
    return rows


def date_of(row):
    day, month = row // 24, 0
    while day >= DAYS[month]:
        day -= DAYS[month]
        month += 1
    return month + 1, day + 1, row % 24 + 0.5


def backward(build, folder, weather, hour):
    month, day, at = date_of(hour)
    document = {"kind": "render", "scene": {"project": "model.hbjson"}, "seed": 77, "technique": "backward", "accuracy": {"relative_error": 0.01},
                "sky": {"weather": {"file": weather, "month": month, "day": day, "hour": at}}}
    path, out = os.path.join(folder, "hour.json"), os.path.join(folder, "hour")
    with open(path, "w", encoding="ascii") as file:
        json.dump(document, file)
    run(build, "run", path, "-o", out)
    with open(os.path.join(out, "result.json"), encoding="utf-8") as file:
        result = json.load(file)
    return result


def main():
    build, model, weather = sys.argv[1:4]
    every, seeds, hours = option("--every", 40), option("--seeds", 6), option("--hours", 10)
    with tempfile.TemporaryDirectory() as folder:
        kept = thin(model, every, os.path.join(folder, "model.hbjson"))
        with open(weather, "rb") as source, open(os.path.join(folder, "place.epw"), "wb") as copy:
            copy.write(source.read())
        years = []
        for seed in range(seeds):
            path, out = os.path.join(folder, "year.json"), os.path.join(folder, "year%d" % seed)
            with open(path, "w", encoding="ascii") as file:
                json.dump({"kind": "annual", "scene": {"project": "model.hbjson"}, "weather": "place.epw",
                           "seed": 1 + seed, "formats": ["ill", "honeybee"]}, file)
            run(build, "annual", path, "-o", out)
            years.append(read_year(out))
        names = [(name, i) for name, i, _ in years[0]]
        with open(os.path.join(folder, "year0", "results", "sun-up-hours.txt"), encoding="ascii") as file:
            rows = [int(float(line)) for line in file]
        columns = len(years[0][0][2])
        assert columns == len(rows)
        total = [sum(row[2][h] for row in years[0]) for h in range(columns)]
        span = columns // hours
        picked = [max(range(k * span, (k + 1) * span), key=lambda h: total[h]) for k in range(hours)]
        print("%d sensors, %d seeds" % (kept, seeds))
        print("%-12s %10s %10s %8s %8s %8s %9s" % ("hour", "year lx", "single lx", "ratio", "z rms", "worst",
                                                   "beyond 3"))
        squares = number = beyond = 0
        ratios = []
        for hour in picked:
            result = backward(build, folder, "place.epw", rows[hour])
            single = [(s["illuminance_lx"], s["standard_error_lx"]) for s in result["sensors"]]
            ordered = [None] * len(names)
            at = 0
            for grid in result.get("grids", []):
                for i in range(grid["count"]):
                    ordered[names.index((grid["name"], i))] = single[at]
                    at += 1
            if None in ordered:
                ordered = single
            zs, own_ratios = [], []
            for k, (lx, error) in enumerate(ordered):
                values = [year[k][2][hour] for year in years]
                mean = sum(values) / seeds
                spread = sum((v - mean) ** 2 for v in values) / (seeds - 1) / seeds
                se = math.sqrt(spread + error ** 2)
                zs.append((mean - lx) / se if se > 0 else 0.0)
                own_ratios += [mean / lx] if lx > 0 else []
            rms = math.sqrt(sum(z * z for z in zs) / len(zs))
            over = sum(abs(z) > 3 for z in zs)
            squares, number, beyond = squares + sum(z * z for z in zs), number + len(zs), beyond + over
            month, day, at_hour = date_of(rows[hour])
            ratios += own_ratios
            print("%02d-%02d %05.2f  %10.1f %10.1f %8.4f %8.2f %8.2f %9d" % (
                month, day, at_hour, sum(sum(y[k][2][hour] for y in years) for k in range(len(names))) / seeds /
                len(names), sum(lx for lx, _ in ordered) / len(names), sum(own_ratios) / len(own_ratios), rms, max(abs(z) for z in zs), over),
                  flush=True)
        print("all: ratio %.4f, z rms %.2f, beyond 3: %d of %d" % (
            sum(ratios) / len(ratios), math.sqrt(squares / number), beyond, number))


if __name__ == "__main__":
    main()
