#!/usr/bin/python3
"""Work of fixed small jobs, compared with the best commit on record.

Usage: ratchet.py check BUILD          compare all measures with history.json (make check-perf)
       ratchet.py counts BUILD         compare only what needs no callgrind (part of make check)
       ratchet.py add BUILD TEXT [ROW=REASON ...]    append an entry for the commit whose folder BUILD is in
       ratchet.py times BUILD OLD      processor time of each row, BUILD and OLD in turns (make bench OLD=commit)

rows.json lists the jobs, on the example's office with a coarse panel. history.json is append-only: each entry has the
commit, the tools, and for each row

    instructions    of orl_run or orl_annual_run, counted by callgrind
    rays            calls of Embree by purpose (PURPOSES, from callgrind's call chains)
    counted_rays    health.rays of the result
    estimates       density estimates
    map_bytes       size of the photon maps
    error           rms of the relative error of the view's pixels over SEEDS seeds, [mean, standard error]
    worst           the same for the worst thousandth of the pixels

`check` fails where a measure is more than 2 % above the smallest on record; errors, and instructions times squared
error, beyond two standard errors as well. An entry with a reason for a row (what the cost buys) starts the record of
that row anew. Counts by other compilers and libraries are not compared.

Errors are against reference_a.hdr and reference_b.hdr, two pictures of 16384 paths a pixel (`backward`, seeds 101 and
102). (x - a)(x - b) is an unbiased estimate of the squared error, since the errors of a and b are independent.
"""

import collections
import json
import math
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
OFFICE = os.path.join(HERE, "../../../client/examples/office")
FIXTURES = os.path.join(HERE, "../../fixtures")
HISTORY = os.path.join(HERE, "history.json")
SURFACES = ["materials.rad", "room.rad", "ground.rad", "glazing.rad", "panel.rad"]
SEEDS = 6  # for errors
TURNS = 5  # for times
MOST = 0.02
DARKEST = 0.01  # of the mean; darker pixels have no relative error

# Purposes of rays, by the first function in the call chain that matches.
PURPOSES = [
    ("shadow", r"transmittance|virtual_sun|direct_light"),
    ("density", r"footprint|surface_point|density"),
    ("openings", r"ports|openings|escape"),
    ("outside", r"exterior|port_radiance"),
    ("photon", r"trace_many|trace_photon|emission|shoot|pilot"),
    ("gather", r"gather|hemisphere|irradiance_record"),
    ("camera", r"shade|tile|refine|pixel"),
    ("path", r"backward|eye_path|trace_path"),
]


def rows():
    with open(os.path.join(HERE, "rows.json"), encoding="utf-8") as file:
        return json.load(file)


def history():
    with open(HISTORY, encoding="utf-8") as file:
        return json.load(file)


def first_line(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[0]


def tools():
    """Compiler and libraries that determine the counts."""
    return ", ".join([re.sub(r"^.*?cc", "cc", first_line("cc", "--version")), first_line("ldd", "--version"),
                      first_line("valgrind", "--version")])


# ---- Running jobs --------------------------------------------------------------------------------

class JobFailed(Exception):
    pass


def make_folder():
    folder = tempfile.mkdtemp(prefix="oriel-ratchet-")
    for name in os.listdir(OFFICE):
        if name.endswith(".rad") or name == "sensors.txt":
            shutil.copy(os.path.join(OFFICE, name), folder)
    shutil.copy(os.path.join(FIXTURES, "bsdf_lcp8.xml"), os.path.join(folder, "lcp.xml"))
    shutil.copy(os.path.join(FIXTURES, "weather.epw"), folder)
    return folder


def run(build, folder, row, seed=1, before=()):
    """Runs a row's job on one thread. Returns its result and processor seconds."""
    job = dict(row["job"], seed=seed)
    annual = job["kind"] == "annual"
    job["scene"] = {"files": SURFACES + ([] if annual else ["sky.rad"])}
    with open(os.path.join(folder, "job.json"), "w", encoding="utf-8") as file:
        json.dump(job, file)
    command = [*before, os.path.abspath(os.path.join(build, "oriel")), "annual" if annual else "run", "job.json",
               "-o", "out", "-j", "1"]
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    now = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        raise JobFailed("%s failed:\n%s" % (" ".join(command), done.stderr[-2000:]))
    with open(os.path.join(folder, "out/result.json"), encoding="utf-8") as file:
        return json.load(file), now.ru_utime + now.ru_stime - used.ru_utime - used.ru_stime


def start_row(build, folder, row, seed=1):
    """Removes earlier output, and makes the maps of a row that needs them."""
    shutil.rmtree(os.path.join(folder, "out"), ignore_errors=True)
    if row.get("maps_ready"):
        run(build, folder, row, seed)


# ---- Measures ------------------------------------------------------------------------------------

def read_picture(path):
    """Luma of each pixel of a run-length encoded Radiance picture."""
    with open(path, "rb") as file:
        data = file.read()
    at = data.index(b"\n\n") + 2
    end = data.index(b"\n", at)
    height, width = int(data[at:end].split()[1]), int(data[at:end].split()[3])
    at, values = end + 1, []
    for _ in range(height):
        at, planes = at + 4, []
        for _ in range(4):
            plane = bytearray()
            while len(plane) < width:
                count, at = data[at], at + 1
                if count > 128:
                    plane += data[at:at + 1] * (count - 128)
                    at += 1
                else:
                    plane += data[at:at + count]
                    at += count
            planes.append(plane)
        for r, g, b, e in zip(*planes):
            scale = math.ldexp(1, e - 136) if e else 0
            values.append(scale * (0.265 * (r + 0.5) + 0.670 * (g + 0.5) + 0.065 * (b + 0.5)))
    return values


def picture_error(path, references):
    """Squared relative error over all pixels, and over the worst thousandth."""
    a, b = references
    least = DARKEST * sum(a) / len(a)
    squares = sorted(((x - p) * (x - q) / ((p + q) / 2) ** 2 for x, p, q in zip(read_picture(path), a, b)
                      if (p + q) / 2 > least), reverse=True)
    worst = squares[:max(1, len(squares) // 1000)]
    return max(0, sum(squares) / len(squares)), max(0, sum(worst) / len(worst))


def root_mean(squares):
    """Root of the mean, with its standard error."""
    n = len(squares)
    mean = sum(squares) / n
    spread = math.sqrt(sum((x - mean) ** 2 for x in squares) / (n - 1) / n)
    return [round(math.sqrt(mean), 5), round(spread / (2 * math.sqrt(mean)) if mean else 0, 5)]


def measure_errors(build, folder, row):
    references = [read_picture(os.path.join(HERE, "reference_%s.hdr" % which)) for which in "ab"]
    found = []
    for seed in range(1, SEEDS + 1):
        start_row(build, folder, row, seed)
        found.append(picture_error(os.path.join(folder, "out/view.hdr"), references))
    return {"error": root_mean([all_ for all_, _ in found]), "worst": root_mean([worst for _, worst in found])}


def map_bytes(folder):
    maps = os.path.join(folder, "out/maps")
    return sum(os.path.getsize(os.path.join(maps, name)) for name in os.listdir(maps)) if os.path.isdir(maps) else 0


def measure_counts(build, folder, row):
    start_row(build, folder, row)
    result, _ = run(build, folder, row)
    health = result.get("health", {"rays": result.get("rays", 0), "estimates": 0})
    return {"counted_rays": health["rays"], "estimates": health["estimates"], "map_bytes": map_bytes(folder)}


def count_rays(path):
    """Calls of Embree by purpose, from callgrind's output with call chains."""
    names, counts, callee = {}, collections.Counter(), ""
    with open(path, encoding="utf-8") as file:
        for line in file:
            name = re.match(r"c?fn=\((\d+)\)(?: (.*))?$", line)
            if name:
                callee = names.setdefault(name[1], name[2] or "")
            elif line.startswith("calls=") and re.match(r"rtc(Intersect|Occluded)\d", callee):
                chain = callee.split("'")[1:]
                found = (purpose for function in chain for purpose, pattern in PURPOSES if re.search(pattern, function))
                counts[next(found, "other")] += int(line[6:].split()[0])
    return dict(sorted(counts.items()))


def measure_instructions(build, folder, row):
    start_row(build, folder, row)
    out = os.path.join(folder, "callgrind")
    chains = ["--separate-callers9=" + name for name in ("rtcIntersect1", "rtcIntersect8", "rtcOccluded1")]
    run(build, folder, row, before=["valgrind", "--tool=callgrind", "--toggle-collect=orl_run",
                                    "--toggle-collect=orl_annual_run", *chains, "--callgrind-out-file=" + out])
    with open(out, encoding="utf-8") as file:
        summary = re.search(r"^(?:summary|totals): (\d+)", file.read(), re.M)
    return {"instructions": int(summary[1]), "rays": count_rays(out)}


def measure(build, row, quick):
    folder = make_folder()
    try:
        found = measure_counts(build, folder, row)
        if not quick:
            found.update(measure_instructions(build, folder, row))
            if row.get("maps_ready"):
                found.update(measure_errors(build, folder, row))
        return found
    finally:
        shutil.rmtree(folder)


# ---- Comparison ----------------------------------------------------------------------------------

def price(found):
    """Instructions times squared error, and its relative standard error."""
    mean, spread = found["error"]
    return found["instructions"] * mean * mean, 2 * spread / mean


def lower_is_better(found):
    """The measures of a row that are compared: name, value, relative standard error."""
    for name in ("instructions", "counted_rays", "estimates", "map_bytes"):
        if found.get(name):
            yield name, found[name], 0
    if found.get("rays"):
        yield "rays", sum(found["rays"].values()), 0
    if found.get("error"):
        yield ("cost x error^2", *price(found))
        yield "worst 0.1 %", found["worst"][0], found["worst"][1] / found["worst"][0]


def best_of(name, measure_name, entries):
    """The smallest value of a measure: (value, relative standard error, commit), or None."""
    found = [(value, spread, entry["commit"]) for entry in entries for m, value, spread in
             lower_is_better(entry["rows"].get(name, {})) if m == measure_name]
    return min(found, default=None)


def since_reason(name, entries):
    """The entries from the last one that gives a reason for the row."""
    start = max((i for i, entry in enumerate(entries) if name in entry.get("reasons", {})), default=0)
    return entries[start:]


def compare_row(name, found, entries):
    """Prints a row. Returns the number of measures that are worse without a reason."""
    failures = 0
    for measure_name, value, spread in lower_is_better(found):
        record, ever = (best_of(name, measure_name, e) for e in (since_reason(name, entries), entries))
        if not record:
            print("  %-12s %-15s %12.5g   no record" % (name, measure_name, value))
            continue
        change = value / record[0] - 1
        worse = change > MOST + 2 * math.hypot(spread, record[1])
        failures += worse
        print("  %-12s %-15s %12.5g %+7.2f %% of %s%s%s" % (
            name, measure_name, value, 100 * change, record[2], "  WORSE" if worse else "",
            "" if ever == record else "  (%+.2f %% of the best ever, %s)" % (100 * (value / ever[0] - 1), ever[2])))
    return failures


def compare(build, quick):
    entries = history()
    same = entries if quick else [entry for entry in entries if entry["tools"] == tools()]
    if not same:
        print("no entry of history.json has these tools, so nothing is compared: %s" % tools())
    failures = sum(compare_row(name, measure(build, row, quick), same) for name, row in rows().items())
    if failures:
        print("ratchet: %d measures are more than 2 %% above their record; undo that, or append an entry that gives the "
              "reason (ratchet.py add BUILD TEXT ROW=REASON)" % failures)
    return 1 if failures else 0


def add(build, says, reasons):
    checkout = os.path.dirname(os.path.abspath(build))
    commit = first_line("git", "-C", checkout, "rev-parse", "--short=8", "HEAD")
    entries = history() if os.path.exists(HISTORY) else []
    entry = {"commit": commit, "says": says, "tools": tools(), "rows": {}}
    if reasons:
        entry["reasons"] = dict(reason.split("=", 1) for reason in reasons)
    for name, row in rows().items():
        try:
            entry["rows"][name] = measure(build, row, False)
        except JobFailed as failure:  # an old commit need not know all rows
            print("%s: left out: %s" % (name, failure), file=sys.stderr)
    with open(HISTORY, "w", encoding="utf-8") as file:
        json.dump(entries + [entry], file, indent=1)
        file.write("\n")
    return 0


def times(build, old):
    print("  %-12s %10s %10s %7s   processor seconds, median of %d in turns" % ("row", "old", "new", "ratio", TURNS))
    for name, row in rows().items():
        seconds = {old: [], build: []}
        for turn in range(TURNS):
            for which in (old, build):
                folder = make_folder()
                start_row(which, folder, row, turn + 1)
                seconds[which].append(run(which, folder, row, turn + 1)[1])
                shutil.rmtree(folder)
        before, now = (sorted(seconds[which])[TURNS // 2] for which in (old, build))
        print("  %-12s %10.3f %10.3f %7.3f   %s" % (name, before, now, now / before, row["says"]))
    return 0


def main():
    command, build, *rest = sys.argv[1:] + [""] * (3 - len(sys.argv))
    if command in ("check", "counts") and not rest:
        return compare(build, command == "counts")
    if command == "add" and rest and all("=" in reason for reason in rest[1:]):
        return add(build, rest[0], rest[1:])
    if command == "times" and len(rest) == 1:
        return times(build, rest[0])
    print(__doc__, file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main())
