#!/usr/bin/python3
"""Glare beside evalglare, picture by picture, and beside closed forms.

Usage: glare.py BUILD_DIR [--images N] [--keep FOLDER]

Renders pictures of scenes made here (sun in view, behind blinds, through a pane that scatters it with
a peak, many small lamps, no source, overcast, dark; fisheyes of both kinds and perspectives), and
rates each by `oriel glare` and, where evalglare is on PATH, by that; a part of them with a task, a
factor, another radius, smoothing, other peaks or none, a mask. Prints a row a picture: DGP of both,
the difference, the same with position indices where evalglare takes them ("at pixel"), the number of
sources, the largest differences of their luminances and solid angles; then how many kept to 0.002 and to
1 %. "apart": sources that evalglare does not put together although they are close
(core/metrics/evalglare.md says why): their pixels, solid angle, light and middle, together, must be ours
to six digits; "by apart" is what its DGP has more by that. With smoothing, where it counts pixels twice,
DGP alone is compared. Without evalglare, and before all that, discs of known
luminance at known angles against arithmetic. Fails when a row does.
"""

import json
import math
import os
import shutil
import subprocess
import sys
import tempfile

DGP_WITHIN, SOURCE_WITHIN = 0.002, 0.01
EXPLAINED = 0.0005  # of DGP
PRINTED = 2e-6  # of sums: solid angles are printed to 1e-10 sr, of some 1e-4

MATERIALS = """
void plastic white 0 0 5 .7 .7 .7 0 0
void plastic wall 0 0 5 .5 .5 .5 0 0
void plastic floor_mat 0 0 5 .2 .2 .2 0 0
void plastic polished 0 0 5 .3 .3 .3 .04 0
void glass clear 0 0 3 .9 .9 .9
void light lamp 0 0 3 90 90 90
void light bulb 0 0 3 4000 4000 4000
void light dim 0 0 3 2 2 2
"""
# 4 m by 6 m by 3 m, the southern side (y = 0) open from 0.9 m to 2.6 m.
SHELL = """
floor_mat polygon f 0 0 12 0 0 0 4 0 0 4 6 0 0 6 0
white polygon c 0 0 12 0 0 3 0 6 3 4 6 3 4 0 3
wall polygon w 0 0 12 0 0 0 0 6 0 0 6 3 0 0 3
wall polygon e 0 0 12 4 0 0 4 0 3 4 6 3 4 6 0
wall polygon n 0 0 12 0 6 0 4 6 0 4 6 3 0 6 3
wall polygon s1 0 0 12 0 0 0 0 0 .9 4 0 .9 4 0 0
wall polygon s2 0 0 12 0 0 2.6 0 0 3 4 0 3 4 0 2.6
wall polygon s3 0 0 12 0 0 .9 0 0 2.6 .3 0 2.6 .3 0 .9
wall polygon s4 0 0 12 3.7 0 .9 3.7 0 2.6 4 0 2.6 4 0 .9
!genbox polished desk 1.6 .8 .04 | xform -t 1.2 1.2 .7
floor_mat polygon ground 0 0 12 -40 -40 -.1 40 -40 -.1 40 40 -.1 -40 40 -.1
"""
PANE = "%s polygon pane 0 0 12 .3 -.05 .9 .3 -.05 2.6 3.7 -.05 2.6 3.7 -.05 .9\n"
BLINDS = "!genbox polished slat 3.4 .08 .002 | xform -rx 20 -t .3 -.15 .92 -a 17 -t 0 0 .1\n"
MULLIONS = "!genbox wall bar .06 .05 1.7 | xform -t .9 -.04 .9 -a 4 -t .7 0 0\n"
BULBS = "".join("bulb sphere b%d_%d 0 0 4 %g %g 2.7 .02\n" % (i, k, .5 + .6 * i, .5 + .8 * k)
                for i in range(6) for k in range(7))
LAMPS = "".join("lamp polygon l%d_%d 0 0 12 %s\n" % (i, k, " ".join(
    "%g %g 2.99" % p for p in ((x, y), (x, y + .3), (x + .3, y + .3), (x + .3, y))))
                for i in range(3) for k in range(4) for x, y in ((.5 + 1.2 * i, .5 + 1.4 * k),))
CLOSED = "wall polygon shut 0 0 12 .3 -.05 .9 .3 -.05 2.6 3.7 -.05 2.6 3.7 -.05 .9\n"
CANDLE = "dim sphere candle 0 0 4 1 3 1 .05\n"

SCENES = {  # scene, whether it has a sky
    "glass": (SHELL + MULLIONS + PANE % "clear", True),
    "blinds": (SHELL + BLINDS, True),
    "panel": (SHELL + "void BSDF lcp 6 0 lcp.xml 0 0 1 . 0 0\n" + PANE.replace("%s", "lcp"), True),
    "open": (SHELL, True),
    "bulbs": (SHELL + CLOSED + BULBS, False),
    "lamps": (SHELL + CLOSED + LAMPS, False),
    "candle": (SHELL + CLOSED + CANDLE, False),
}
EYES = ["-vp 2 3 1.2 -vd 0 -1 0", "-vp 2 1.4 1.2 -vd 0 -1 .2", "-vp 1 4.5 1.5 -vd .4 -1 0",
        "-vp 3 2 1.2 -vd -1 -.2 0", "-vp 2.5 3.5 1.2 -vd .3 -1 .1", "-vp 2 1.6 1.2 -vd 0 1 -.1"]
FISHEYE, HEMISPHERE = "-vta -vh 180 -vv 180", "-vth -vh 180 -vv 180"
PERSPECTIVE = "-vtv -vh 120 -vv 120"
PLACE = {"month": 3, "day": 21, "latitude": 38.4, "longitude": 27.1, "time_zone": 2}
SKIES = ([{"name": "h%d" % h, "perez": {**PLACE, "hour": h, "direct_normal_w_m2": 800,
                                         "diffuse_horizontal_w_m2": 120}} for h in (8, 9, 11, 12, 14, 16)] +
         [{"name": "winter", "perez": {**PLACE, "month": 12, "hour": 12, "direct_normal_w_m2": 700,
                                       "diffuse_horizontal_w_m2": 90}},
          {"name": "overcast", "cie": {"type": "overcast", "diffuse_horizontal_lx": 10000}}])

# Options of `oriel glare`, and evalglare's for the same.
SETTINGS = [([], []), ([], []), ([], []),
            (["-T", "128.5,80.5,0.7"], ["-T", "128", "80", "0.7"]),
            (["-b", "7"], ["-b", "7"]), (["-b", "1000"], ["-b", "1000"]),
            (["-r", "0.1"], ["-r", "0.1"]), (["-s"], ["-s"]), (["-x"], ["-x"]),
            (["-Y", "10000"], ["-Y", "10000"]), (["--low-light"], ["-C", "l+"])]
SIDE = 256


# ---- Closed forms -------------------------------------------------------------------------------

def rgbe(value):
    mantissa, exponent = math.frexp(value)
    return bytes([int(mantissa * 256)] * 3 + [exponent + 128])


def value_of(pixel):
    return 179 * (pixel[0] + .5) * math.ldexp(1, pixel[3] - 136)


def draw_disc(path, side, middle, radius, bright, dark):
    """A flat picture of a disc on a uniform ground, seen by an angular fisheye."""
    with open(path, "wb") as out:
        out.write(b"#?RADIANCE\nVIEW= -vta -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 180 -vv 180\n"
                  b"FORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (side, side))
        for row in range(side):
            line = bytearray()
            for column in range(side):
                x, y = (column + .5) / side - .5, .5 - (row + .5) / side
                r = math.pi * math.hypot(x, y)
                s = math.sin(r) / r * math.pi if r > 0 else math.pi
                cosine = x * s * middle[0] + y * s * middle[1] + math.cos(r) * middle[2]
                line += bright if cosine >= math.cos(radius) else dark
            out.write(line)


def guth(sigma, tau):
    return math.exp((35.2 - .31889 * tau - 1.22 * math.exp(-2 * tau / 9)) * 1e-3 * sigma +
                    (21 + .26667 * tau - .002963 * tau * tau) * 1e-5 * sigma * sigma)


def closed_forms(oriel, folder):
    """Ev, solid angle, position index and DGP of one disc, by arithmetic."""
    print("%-26s | %9s %9s | %9s %9s | %7s %7s | %7s %7s | %s" % (
        "disc", "lx", "Oriel", "sr", "Oriel", "P", "Oriel", "DGP", "Oriel", "verdict"))
    failed = 0
    for right, up, radius, luminance in ((0, 0, 5, 2e4), (0, 30, 5, 2e4), (40, 0, 4, 3e4),
                                         (0, 55, 3, 1e5), (20, 0, .2665, 1e9), (0, 10, .5, 1e8)):
        side = 600
        bright, dark = rgbe(luminance / 179), rgbe(2.)
        high, low = value_of(bright), value_of(dark)
        sigma, r = math.radians(right + up), math.radians(radius)
        middle = (math.sin(math.radians(right)), math.sin(math.radians(up)), math.cos(sigma))
        path = os.path.join(folder, "disc.hdr")
        draw_disc(path, side, middle, r, bright, dark)
        glare = rate(oriel, path, [])
        source = glare["sources"][0]
        sr = 2 * math.pi * (1 - math.cos(r))
        # Whole pixels make of a small disc what they can: its light is then that of the pixels.
        drawn = source["solid_angle_sr"]
        small = radius < 1
        used = drawn if small else sr
        eye = math.pi * low + (high - low) * used * math.cos(sigma) * (1 if small else (1 + math.cos(r)) / 2)
        p = guth(right + up, 90 if right else 0)
        dgp = min(1, 5.87e-5 * eye + .092 * math.log10(
            1 + high ** 2 * used / (eye ** 1.87 * p * p)) + .159)
        found = [value["value"] for value in (glare["metrics"]["vertical_illuminance_lx"],
                                              glare["metrics"]["dgp"])]
        edge = 0 if small else 4 / (math.pi * (radius * side / 180) ** 1.5)
        # P is taken where the drawn pixels' middle lies: up to half a pixel aside where they are few.
        ok = (abs(found[0] / eye - 1) < 2e-3 + edge and abs(drawn / used - 1) <= edge and
              abs(source["position_index"] / p - 1) < (.02 if small else .01) and
              abs(found[1] - dgp) < .002)
        failed += not ok
        print("%4g right %3g up %6.4g across | %9.6g %9.6g | %9.4g %9.4g | %7.4f %7.4f | %7.4f %7.4f | %s"
              % (right, up, 2 * radius, eye, found[0], used, drawn, p, source["position_index"], dgp,
                 found[1], "ok" if ok else "FAIL"))
    return failed


# ---- Pictures -----------------------------------------------------------------------------------

def render(build, folder, name, images):
    """The scene's pictures: (name, path), one after the other."""
    scene, has_sky = SCENES[name]
    with open(os.path.join(folder, "scene.rad"), "w") as out:
        out.write(MATERIALS + scene)
    if name == "panel" and not os.path.exists(os.path.join(folder, "lcp.xml")):
        subprocess.run([build + "/oriel", "bsdf", "make", "client/examples/office/lcp/lcp.rad", "--cell",
                        "-0.002 0.002 0 0.004", "--basis", "tensor_tree_4", "--resolution", "32",
                        "--symmetry", "both", "--accuracy", "0.03", "-o", folder + "/lcp.xml"],
                       check=True, stdout=subprocess.DEVNULL)
    kinds = [FISHEYE, FISHEYE, HEMISPHERE, FISHEYE, PERSPECTIVE, FISHEYE]
    views = [{"name": "v%d" % i, "view": "%s %s" % (kinds[i], eye), "width": SIDE, "height": SIDE,
              "formats": ["hdr"]} for i, eye in enumerate(EYES)]
    skies = SKIES if has_sky else [None]
    job = {"kind": "render", "scene": {"files": ["scene.rad"]}, "technique": "backward", "seed": 1,
           "pixel_samples": 2, "views": views, "dark": "expected"}
    if has_sky:
        job["skies"] = skies
    with open(os.path.join(folder, "job.json"), "w") as out:
        json.dump(job, out)
    result = os.path.join(folder, "out-" + name)
    if not os.path.exists(os.path.join(result, "result.json")):  # of an earlier run, where kept
        run = subprocess.run([build + "/oriel", "run", "job.json", "-o", result], cwd=folder,
                             stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if run.returncode:
            sys.exit("oriel run failed on %s: %s" % (name, run.stderr[-500:]))
    for sky in skies:
        for view in views:
            prefix = sky["name"] + "." if sky else ""
            images.append((name + "." + prefix + view["name"],
                           os.path.join(result, prefix + view["name"] + ".hdr"), None))


def rate(oriel, path, options):
    run = subprocess.run([oriel, "glare", "--json", *options, path], stdout=subprocess.PIPE,
                         stderr=subprocess.PIPE, text=True)
    if run.returncode:
        sys.exit("oriel glare failed on %s: %s" % (path, run.stderr))
    return json.loads(run.stdout)


def evalglare(path, options):
    """DGP, Ev and sources (cd/m2, sr, x, y) as it prints them; None where it gives up. -f: it takes a
    perspective whose corners are below 2 cd/m2, as those of a dark room are, for a fisheye with a
    wrong VIEW line, and stops."""
    run = subprocess.run(["evalglare", "-f", "-d", *options, path], stdout=subprocess.PIPE,
                         stderr=subprocess.PIPE, text=True)
    lines = run.stdout.splitlines()
    last = [line for line in lines if line.startswith("dgp,")]
    if not last:
        return None
    lines = lines[[" No pixels " in line for line in lines].index(True):]
    numbers = last[0].split(":")[1].split()
    count = int(lines[0].split()[0])
    rows = [line.split() for line in lines[1:1 + count]]
    return {"dgp": float(numbers[0]), "lx": float(numbers[2]),
            "sources": [{"cd_m2": float(r[4]), "sr": float(r[5]), "pixels": int(float(r[1])), "p": float(r[6]),
                         "place": (float(r[2]), float(r[3]))} for r in rows]}


def match_one(source, left, side):
    """Of our sources the nearest of as many pixels: evalglare's places are half a pixel off."""
    like = [s for s in left if s["pixels"] == source["pixels"]]
    best = min(like, default=None, key=lambda s: math.dist(s["place"], source["place"]) +
               side * abs(math.log((s["cd_m2"] + 1) / (source["cd_m2"] + 1))))
    return best if best and math.dist(best["place"], source["place"]) < 3 else None


def is_whole(parts, whole):
    """Whether the parts have the whole's pixels, solid angle, light and middle between them. Both programs
    print so many digits that another choice of parts, a pixel for a pixel, does not."""
    if sum(s["pixels"] for s in parts) != whole["pixels"]:
        return False
    sr = sum(s["sr"] for s in parts)
    lights = [s["cd_m2"] * s["sr"] for s in parts]
    middle = [sum(w * s["place"][i] for w, s in zip(lights, parts)) / sum(lights) for i in (0, 1)]
    return (abs(sr / whole["sr"] - 1) < PRINTED and
            abs(sum(lights) / (whole["cd_m2"] * whole["sr"]) - 1) < PRINTED and
            math.dist(middle, whole["place"]) < 1.5)


def parts_of(whole, parts):
    """Those of the parts that together are the whole; None where there are none."""
    tries = 2000000

    def search(some, rest, missing):
        nonlocal tries
        tries -= 1
        if missing == 0:
            return some if len(some) > 1 and is_whole(some, whole) else None
        for index, part in enumerate(rest):
            if part["pixels"] <= missing and tries > 0:
                found = search(some + [part], rest[index + 1:], missing - part["pixels"])
                if found:
                    return found
        return None

    near = sorted(parts, key=lambda s: (-s["pixels"], math.dist(s["place"], whole["place"])))
    return search([], near, whole["pixels"])


def compare(ours, theirs, side):
    """Largest relative differences of luminances and solid angles, source by source, and which of ours
    evalglare has left apart: (ours, its parts) of each. Infinite where sources do not fit."""
    left = [{"cd_m2": s["luminance_cd_m2"], "sr": s["solid_angle_sr"], "pixels": s["pixels"],
             "p": s["position_index"], "place": (s["position"][0], side - s["position"][1])}
            for s in ours["sources"]]
    luminance = angle = 0.
    parts = []
    for source in theirs["sources"]:
        best = match_one(source, left, side)
        if best is None:
            parts.append(source)
            continue
        left.remove(best)
        luminance = max(luminance, abs(best["cd_m2"] / source["cd_m2"] - 1))
        angle = max(angle, abs(best["sr"] / source["sr"] - 1))
    apart = []
    for whole in sorted(left, key=lambda s: s["pixels"]):
        some = parts_of(whole, parts)
        if some is None:
            return math.inf, math.inf, []
        apart.append((whole, some))
        angle = max(angle, abs(sum(s["sr"] for s in some) / whole["sr"] - 1))
        parts = [s for s in parts if s not in some]
    return (math.inf, math.inf, []) if parts else (luminance, angle, apart)


def dazzle(sources):
    return sum(s["cd_m2"] ** 2 * s["sr"] / s["p"] ** 2 for s in sources)


def left_apart(theirs, apart):
    """What its DGP has more than with the parts put together, by the formula: L^2 w of parts is more
    than that of the mean."""
    together = dazzle(theirs["sources"])
    for whole, parts in apart:
        together += dazzle([whole]) - dazzle(parts)
    contrast = [.092 * math.log10(1 + sum_ / theirs["lx"] ** 1.87)
                for sum_ in (dazzle(theirs["sources"]), together)]
    return contrast[0] - contrast[1]


def judge(off, exact, apart_by, fits):
    """A row's verdict. Beyond the bound it is evalglare's doing where what follows from its position
    indices at whole pixels and from sources left apart explains all but 0.0005 of it."""
    if not fits:
        return "FAIL"
    if abs(off) <= DGP_WITHIN:
        return "ok"
    return "explained" if abs(exact + apart_by) <= EXPLAINED else "FAIL"


def beside_evalglare(oriel, images):
    print("\n%-22s %-16s | %7s %7s %8s %8s %8s | %4s %4s %5s | %7s %7s | %s" % (
        "picture", "options", "theirs", "Oriel", "off", "at pixel", "by apart", "n", "n", "apart",
        "L, %", "sr, %", "verdict"))
    verdicts, worst = [], [0., 0., 0., 0.]
    for index, (name, path, more) in enumerate(images):
        mine, others = more or SETTINGS[index % len(SETTINGS)]
        shown = " ".join(os.path.basename(word) for word in others)
        theirs = evalglare(path, others)
        if theirs is None:
            verdicts.append("FAIL")
            print("%-22s %-16s | evalglare gives up" % (name, shown))
            continue
        ours, there = rate(oriel, path, mine), rate(oriel, path, mine + ["--whole-pixels"])
        off = ours["metrics"]["dgp"]["value"] - theirs["dgp"]
        exact = there["metrics"]["dgp"]["value"] - theirs["dgp"]
        luminance, angle, apart = compare(there, theirs, SIDE)
        if "-s" in others:  # evalglare counts pixels twice
            luminance, angle, apart = 0, 0, []
        by_apart = left_apart(theirs, apart)
        verdicts.append(judge(off, exact, by_apart, max(luminance, angle) <= SOURCE_WITHIN))
        worst = [max(a, b) for a, b in zip(worst, (abs(off), abs(exact + by_apart), luminance, angle))]
        print("%-22s %-16s | %7.4f %7.4f %8.4f %8.4f %8.4f | %4d %4d %5s | %7.3f %7.3f | %s" % (
            name, shown, theirs["dgp"], ours["metrics"]["dgp"]["value"], off, exact, by_apart,
            len(theirs["sources"]), len(ours["sources"]),
            sum(len(parts) - 1 for _, parts in apart) or "", 100 * luminance, 100 * angle, verdicts[-1]))
    print("\n%d pictures: DGP within %g and sources within %g %% in %d; in %d more DGP is off by what "
          "evalglare's position\nindices and sources left apart make of it; %d failed. DGP off by %.4f "
          "at the most, by %.5f without these;\nluminances by %.2g %%, solid angles by %.2g %%" % (
              len(verdicts), DGP_WITHIN, 100 * SOURCE_WITHIN, verdicts.count("ok"),
              verdicts.count("explained"), verdicts.count("FAIL"), *worst[:2], 100 * worst[2],
              100 * worst[3]))
    return verdicts.count("FAIL")


# ---- Masks and bands -----------------------------------------------------------------------------

PART = ("solid_angle_sr", "mean_cd_m2", "median_cd_m2", "deviation_cd_m2", "percentile_75_cd_m2",
        "percentile_95_cd_m2", "least_cd_m2", "most_cd_m2")


def part_of(path, options, word):
    """What evalglare tells of a masked part, or of a band."""
    run = subprocess.run(["evalglare", "-f", "-d", *options, path], stdout=subprocess.PIPE,
                         stderr=subprocess.PIPE, text=True)
    line = [line for line in run.stdout.splitlines() if line.startswith(word)][0]
    numbers = [float(text) for text in line.split(":")[-1].split()]
    return dict(zip(PART, numbers[1:] if word == "masking" else numbers))


def beside_parts(oriel, folder, images):
    """Luminances of masks and bands on some of the pictures: mean and extremes within 1e-4; percentiles lie
    between two pixels, of which the programs take one or the other."""
    print("\n%-22s %-8s" % ("picture", "part") + "".join(" | %9s %9s" % (word.split("_")[0][:9], "Oriel")
                                                       for word in PART) + " | verdict")
    mask, failed = os.path.join(folder, "mask.hdr"), 0
    draw_disc(mask, SIDE, (.2, .1, math.sqrt(.95)), .6, rgbe(1.), rgbe(1e-5))
    for name, path, _ in images[::max(1, len(images) // 6)]:
        for options, word, key in ((["-A", mask], "masking", "mask"), (["-B", "0.3"], "band", "band")):
            theirs, ours = part_of(path, options, word), rate(oriel, path, options)[key]
            ok = all(abs(ours[word] - theirs[word]) <= 1e-4 * abs(theirs[word]) + 1e-5
                     for word in PART if not word.startswith(("median", "percentile")))
            ok = ok and all(abs(ours[word] - theirs[word]) <= .02 * theirs["most_cd_m2"] for word in PART
                            if word.startswith(("median", "percentile")))
            failed += not ok
            print("%-22s %-8s" % (name, key) + "".join(" | %9.5g %9.5g" % (theirs[w], ours[w]) for w in PART) +
                  " | " + ("ok" if ok else "FAIL"))
    return failed


def main():
    build = os.path.abspath(sys.argv[1])
    most = int(sys.argv[sys.argv.index("--images") + 1]) if "--images" in sys.argv else 1 << 30
    keep = sys.argv[sys.argv.index("--keep") + 1] if "--keep" in sys.argv else None
    folder = os.path.abspath(keep) if keep else tempfile.mkdtemp(prefix="oriel-glare-")
    os.makedirs(folder, exist_ok=True)
    oriel = build + "/oriel"
    try:
        failed = closed_forms(oriel, folder)
        if shutil.which("evalglare"):
            images = []
            for name in SCENES:
                if len(images) < most:
                    render(build, folder, name, images)
            failed += beside_evalglare(oriel, images[:most])
            failed += beside_parts(oriel, folder, images[:most])
        else:
            print("\nevalglare is not on PATH: no pictures are compared.")
    finally:
        if not keep:
            shutil.rmtree(folder)
    print("%d failed" % failed)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
