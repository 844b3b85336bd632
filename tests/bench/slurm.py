"""make bench-slurm: what parts, waves and merging cost, and what many nodes are worth by that.

Usage: slurm.py BUILD. A year of an open-plan building (13 948 surfaces) is measured in small pieces here,
in processor time, so that other work on the machine does not count; what Slurm adds is measured by its
clock, on a real one of two nodes on loopback (tests/support/slurm). From these comes a table of what is to
be expected for 10 000 sensors on 1 to 1000 nodes. Every assumption is printed beside it.
"""
import json
import math
import os
import resource
import subprocess
import sys
import tempfile
import time

SENSORS = 10000
NODES = (1, 4, 16, 64, 256, 1000)
LEAD_THREADS = 4      # of the run that puts all together
SHARED_MB_S = 200     # that a shared folder gives one reader
WAVE_S = 2            # that a wave takes beside its parts at the least, where slurmctld is busy
BLOCKS, LEAST_BLOCK = 2000, 8  # core/annual/coefficients/chunk_tasks.c
LENGTH, WIDTH, HEIGHT = 80.0, 25.0, 3.2


# ---- The building --------------------------------------------------------------------------------

def polygon(material, name, points):
    numbers = " ".join("%g %g %g" % p for p in points)
    return "%s polygon %s\n0\n0\n%d %s\n" % (material, name, 3 * len(points), numbers)


def box(material, name, low, high):
    corners = [(high[0] if i & 1 else low[0], high[1] if i & 2 else low[1], high[2] if i & 4 else low[2])
               for i in range(8)]
    faces = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6))
    return "".join(polygon(material, "%s.%d" % (name, i), [corners[k] for k in face])
                   for i, face in enumerate(faces))


def facade(name, y, inside):
    """Twenty windows between piers; inside: the y that they face."""
    out = []

    def part(material, label, x0, x1, z0, z1):
        points = [(x0, y, z0), (x1, y, z0), (x1, y, z1), (x0, y, z1)]
        out.append(polygon(material, label, points if inside < y else points[::-1]))
    part("white", "sill_" + name, 0, LENGTH, 0, 0.9)
    part("white", "head_" + name, 0, LENGTH, 2.8, HEIGHT)
    for i in range(20):
        x = i * LENGTH / 20
        part("white", "pier_%s%d" % (name, i), x, x + 0.4, 0.9, 2.8)
        part("pane", "pane_%s%d" % (name, i), x + 0.4, x + LENGTH / 20, 0.9, 2.8)
    return "".join(out)


def desk(i, x, y):
    legs = ((0, 0), (1.34, 0), (0, 0.64), (1.34, 0.64))
    return (box("wood", "top%d" % i, (x, y, 0.72), (x + 1.4, y + 0.7, 0.75)) +
            "".join(box("wood", "leg%d_%d" % (i, k), (x + a, y + b, 0.001), (x + a + 0.06, y + b + 0.06, 0.719))
                    for k, (a, b) in enumerate(legs)) +
            box("white", "screen%d" % i, (x + 0.4, y + 0.3, 0.76), (x + 1, y + 0.33, 1.15)))


def building():
    text = "".join("void plastic %s\n0\n0\n5 %g %g %g 0 0\n" % (name, r, r, r)
                   for name, r in (("white", 0.7), ("carpet", 0.25), ("wood", 0.4)))
    text += "void glass pane\n0\n0\n3 .7 .7 .7\n"
    plan = [(0, 0), (LENGTH, 0), (LENGTH, WIDTH), (0, WIDTH)]
    text += polygon("carpet", "floor", [(x, y, 0) for x, y in plan])
    text += polygon("white", "ceiling", [(x, y, HEIGHT) for x, y in plan[::-1]])
    for x, name in ((0, "west"), (LENGTH, "east")):
        ends = [(x, 0, 0), (x, WIDTH, 0), (x, WIDTH, HEIGHT), (x, 0, HEIGHT)]
        text += polygon("white", name, ends if x == 0 else ends[::-1])
    text += facade("south", 0, WIDTH) + facade("north", WIDTH, 0)
    return text + "".join(desk(i, 1 + i % 40 * 1.95, 1.5 + i // 40 * 2.2) for i in range(385))


def sensors(n):
    across = max(int(math.sqrt(n * WIDTH / LENGTH)), 1)
    along = -(-n // across)
    return "".join("%g %g 0.8 0 0 1\n" % (0.5 + 79 * (i // across) / max(along - 1, 1),
                                          0.5 + 24 * (i % across) / max(across - 1, 1)) for i in range(n))


def weather():
    """All hours of a year in a WEA file: sun and sky by the clock, which is all that matters here."""
    lines = ["place made_up", "latitude 48", "longitude -11", "time_zone -15", "site_elevation 0",
             "weather_data_file_units 1"]
    for month, days in enumerate((31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31), 1):
        for day in range(1, days + 1):
            for hour in range(24):
                up = max(math.sin((hour - 5.5) / 13 * math.pi), 0) if 5 < hour < 19 else 0
                lines.append("%d %d %.3f %d %d" % (month, day, hour + 0.5, 500 * up * (day % 3 > 0), 150 * up))
    return "\n".join(lines) + "\n"


# ---- Measuring -----------------------------------------------------------------------------------

class Bench:
    def __init__(self, build, folder):
        self.oriel, self.folder = os.path.join(os.path.abspath(build), "oriel"), folder
        self.env = dict(os.environ)
        for name, text in (("plan.rad", building()), ("year.wea", weather())):
            self.write(name, text)

    def write(self, name, text):
        with open(os.path.join(self.folder, name), "w") as file:
            file.write(text)

    def document(self, n, samples):
        name = "year-%d-%d.json" % (n, samples)
        self.write("p%d.pts" % n, sensors(n))
        self.write(name, json.dumps({
            "kind": "annual", "scene": {"files": ["plan.rad"]}, "weather": "year.wea", "samples": samples,
            "grids": [{"name": "plan", "sensors": {"file": "p%d.pts" % n}}]}))
        return name

    def run(self, n, samples, *options):
        """Processor seconds of the lead and of its parts (of this machine), seconds by the clock, bytes
        of the largest store, and how many waves there were."""
        output = os.path.join(self.folder, "out")
        subprocess.run(["rm", "-rf", output], check=True)
        args = [self.oriel, "annual", os.path.join(self.folder, self.document(n, samples)), "-o", output,
                "--threads", "1"] + list(options)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        began, lead, size, tick = time.time(), 0.0, 0, os.sysconf("SC_CLK_TCK")
        log = os.path.join(self.folder, "log")
        with open(log, "w") as errors:
            process = subprocess.Popen(args, stdout=subprocess.DEVNULL, stderr=errors, env=self.env)
            while process.poll() is None:
                try:
                    with open("/proc/%d/stat" % process.pid) as file:
                        fields = file.read().rsplit(")", 1)[1].split()
                    lead = (int(fields[11]) + int(fields[12])) / tick if fields[0] != "Z" else lead
                    size = max(size, sum(e.stat().st_size for e in os.scandir(output + "/parts/store")))
                except (OSError, IndexError):
                    pass
                time.sleep(0.02)
        took = time.time() - began
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        with open(log) as file:
            text = file.read()
        if process.returncode:
            sys.exit(text)
        all_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        waves = int(text.split(" waves")[0].split()[-1]) if " waves" in text else 0
        return {"lead": lead, "parts": all_s - lead, "clock": took, "bytes": size, "waves": waves}


def measure_here(bench):
    small, many = 64, 512
    whole = [bench.run(n, 16) for n in (small, many)]
    light = [bench.run(n, 16, "--parts", "1") for n in (small, many)]
    split = bench.run(many, 16, "--parts", "8")
    deep = bench.run(small, 1024, "--parts", "1")
    more = many - small
    per = {"sample": (deep["parts"] - light[0]["parts"]) / (small * (1024 - 16)),
           "sensor": (light[1]["parts"] - light[0]["parts"]) / more,
           "alone": (whole[1]["lead"] - whole[0]["lead"]) / more,
           "merge": (light[1]["lead"] - light[0]["lead"]) / more,
           "bytes": (light[1]["bytes"] - light[0]["bytes"]) / more}
    per["sensor"] -= 16 * per["sample"]
    per["alone"] -= 16 * per["sample"]
    return {"per": per, "part": (split["parts"] - light[1]["parts"]) / 7,
            "lead": light[0]["lead"] - small * per["merge"],
            "start": whole[0]["lead"] - small * (per["alone"] + 16 * per["sample"])}


def measure_slurm(bench):
    """Seconds that a wave takes beside its parts' work; and from the start of one task of an array to
    that of the next, where there is room for all."""
    tasks, stamps = 60, os.path.join(bench.folder, "stamps")
    here = min(bench.run(64, 16, "--parts", "1")["clock"] for _ in range(3))
    there = [bench.run(64, 16, "--slurm", "--parts", "1") for _ in range(3)]
    subprocess.run(["sbatch", "--wait", "--quiet", "--output=/dev/null", "--mem=16", "--array=1-%d" % tasks,
                    "--wrap", "date +%%s.%%N >>%s" % stamps], env=bench.env, check=True, cwd=bench.folder)
    with open(stamps) as file:
        times = sorted(float(line) for line in file)
    waves = there[0]["waves"]
    return {"wave": max((min(t["clock"] for t in there) - here) / waves, 0), "waves": waves,
            "task": (times[-1] - times[0]) / (len(times) - 1)}


# ---- The table -----------------------------------------------------------------------------------

def expect(here, slurm, samples, nodes):
    """Seconds of each part of the whole on nodes of one core."""
    per = here["per"]
    of_sensor = per["sensor"] + samples * per["sample"]
    block = max(LEAST_BLOCK, min(64, SENSORS // BLOCKS))
    pieces = -(-SENSORS // block)
    most = -(-pieces // nodes) * block
    return {"load": here["lead"],
            "waves": slurm["waves"] * (max(slurm["wave"], WAVE_S) + here["part"]),
            "tasks": nodes * slurm["task"],
            "work": most * of_sensor,
            "merge": SENSORS * per["merge"] / LEAD_THREADS,
            "read": SENSORS * per["bytes"] / (SHARED_MB_S * 1e6)}


def alone(here, samples):
    return here["start"] + SENSORS * (here["per"]["alone"] + samples * here["per"]["sample"])


def print_table(here, slurm, samples):
    one = alone(here, samples)
    print("\n%d sensors, %d samples each: %.1f h of one core in one piece" % (SENSORS, samples, one / 3600))
    print("nodes      load   waves   tasks    work   merge    read     all   efficiency")
    rows = []
    for nodes in NODES:
        parts = expect(here, slurm, samples, nodes)
        total = sum(parts.values())
        rows.append({"nodes": nodes, "seconds": parts, "efficiency": one / (nodes * total)})
        print("%5d  %8.1f%8.1f%8.1f%8.1f%8.1f%8.1f%8.1f   %6.1f %%" %
              ((nodes,) + tuple(parts[k] for k in ("load", "waves", "tasks", "work", "merge", "read")) +
               (total, 100 * one / (nodes * total))))
    return rows


def hours_worth(here, slurm, nodes, efficiency):
    """Of one core: the least work that so many nodes are worth."""
    low, high = 0.0, 1e9
    for _ in range(60):
        samples = (low + high) / 2
        total = sum(expect(here, slurm, samples, nodes).values())
        low, high = (low, samples) if alone(here, samples) / (nodes * total) >= efficiency else (samples, high)
    return alone(here, high) / 3600


def main():
    build = sys.argv[1]
    with tempfile.TemporaryDirectory(prefix="oriel-bench-slurm") as folder:
        bench = Bench(build, folder)
        here = measure_here(bench)
        slurm_folder = os.path.join(folder, "slurm")
        bench.env["SLURM_NODE_CPUS"] = "32"
        bench.env["SLURM_CONF"] = os.path.join(slurm_folder, "slurm.conf")
        subprocess.run(["tests/support/slurm", "start", slurm_folder, "23817"], check=True, env=bench.env)
        try:
            slurm = measure_slurm(bench)
        finally:
            subprocess.run(["tests/support/slurm", "stop", slurm_folder], check=False, env=bench.env)
    per = here["per"]
    print("Measured: a part %.2f s of a core beside its work; a wave %.1f s beside its parts; a task of an"
          "\narray %.3f s, one after the other; the lead %.2f s, and %.2f ms a sensor to put together, of"
          "\n%.0f kB a sensor; a sensor %.1f ms, and %.3f ms a sample." %
          (here["part"], slurm["wave"], slurm["task"], here["lead"], 1e3 * per["merge"], per["bytes"] / 1e3,
           1e3 * per["sensor"], 1e3 * per["sample"]))
    print("Taken: a node is one core as fast as this one, and has one part; all nodes are free; Slurm starts"
          "\ntasks one after the other, as here; the lead has %d threads, and reads %d MB/s from the shared"
          "\nfolder; a wave takes %d s beside its parts at the least; the longest part has the most blocks of %d"
          "\nsensors, and is what its wave waits for." %
          (LEAD_THREADS, SHARED_MB_S, WAVE_S, max(LEAST_BLOCK, min(64, SENSORS // BLOCKS))))
    tables = {str(samples): print_table(here, slurm, samples) for samples in (2048, 32768, 131072)}
    print("\n80 %% of 256 nodes are had from %.1f h of one core on; of 64 from %.1f h." %
          (hours_worth(here, slurm, 256, 0.8), hours_worth(here, slurm, 64, 0.8)))
    with open(os.path.join(build, "bench-slurm.json"), "w") as file:
        json.dump({"here": here, "slurm": slurm, "tables": tables}, file, indent=1)


main()
