"""Jobs against their schemas, member by member: what the contract forbids the daemon must refuse.

From jobs that are taken come hundreds that break the schema in one place each: another type, beyond
a bound, not of the list, a member too many or too few.
"""

import copy
import json
import os

from cases import MEASURED, PANEL, ROOM, SENSORS, SKY, VIEW, bsdf

# Each place is sent every third odd value, and each value goes to every third place. With ORIEL_LONG
# each place is sent all of them.
SHARE = 1 if os.environ.get("ORIEL_LONG", "0") not in ("", "0") else 3
ODD = (None, True, "", "x" * 70000, "/", 1.5, -1, 1e300, 10**30, [], {}, [[1]], {"x": 1})
PLACE = {"latitude": 38, "longitude": 27, "time_zone": 2}
DAY = {"month": 3, "day": 22}
EFFECTS = ("caustics", "sun", "sky", "exterior", "caustics_mirror", "caustics_bsdf",
           "caustics_glass", "interreflection", "glossy", "color", "media", "refraction", "lamps",
           "glare", "bins", "final_gather", "ports", "suns")


def jobs(lit, dark, sheet, measured):
    """Jobs that are taken; together they have every member that a request may have."""
    sky = [{"perez": {**DAY, "hour": 12, **PLACE, **light, "ground_reflectance": 0.3}}
           for light in ({"direct_normal_w_m2": 800, "diffuse_horizontal_w_m2": 120},
                         {"direct_normal_lx": 80000, "diffuse_horizontal_lx": 12000},
                         {"direct_horizontal_w_m2": 500, "diffuse_horizontal_w_m2": 120},
                         {"global_horizontal_w_m2": 600}, {"clearness": 4, "brightness": 0.2})]
    sun = {"sun_altitude": 40, "sun_azimuth": 10}
    sky += [{"perez": {**sun, "global_horizontal_w_m2": 600}, "normalise": "gendaylit", "sun": "radiance"},
            {"cie": {"type": "clear", **DAY, "hour": 12, **PLACE, "zenith_cd_m2": 8000,
                     "direct_normal_lx": 80000, "ground_reflectance": 0.2}},
            {"cie": {"type": "intermediate", **sun, "turbidity": 3}},
            {"cie": {"type": "overcast", "diffuse_horizontal_lx": 10000}},
            {"weather": {"file": "w.epw", "year": 2020, **DAY, "hour": 11.5, "ground_reflectance": 0.2}}]
    several = [[{"name": "one", **sky[8]}, sky[9], {**sky[5], "name": "five"}],
               {"weather": {"file": "w.epw", "year": 2020, "ground_reflectance": 0.2}, "normalise": "flux",
                "sun": "radiance", "from": {**DAY, "hour": 11.5}, "to": {**DAY, "hour": 12.5}, "step_h": 1},
               {"perez": {**PLACE, "global_horizontal_w_m2": 600},
                "from": {**DAY, "hour": 11.5}, "to": {**DAY, "hour": 12.5}},
               {"cie": {"type": "clear", **PLACE},
                "from": {**DAY, "hour": 11.5}, "to": {**DAY, "hour": 12.5}}]
    yield {"kind": "render", "scene": lit, "technique": "gather", "seed": 1, "gather_samples": 16,
           "photons": {"global": 500, "caustic": 500, "exact": True}, "sensors": SENSORS, "views": [VIEW],
           "heat_map": {"scale": 500, "decades": 2, "divisions": 4, "palette": "eco",
                        "thresholds": [300], "length_unit": "ft"},
           "priority": 5, "name": "n", "tags": ["a", "b"], "dark": "expected", "effects": {name: "auto" for name in EFFECTS}}
    yield {"scene": dark, "technique": "backward", "pixel_samples": 1, "skies": several[0],
           "views": [VIEW], "sequence": {"frame_s": 0.5, "columns": 3, "picture_width": 64}}
    glare = {"threshold": 5, "task": {"x": 8, "y": 4, "angle_rad": 0.6}, "radius_rad": 0.2,
             "smooth": True, "peaks": True, "peak_cd_m2": 50000, "formula": "published",
             "position": "exact", "low_light_correction": True, "age_years": 60,
             "vertical_illuminance_lx": 1000, "directions": {"count": 3, "span_deg": 90}}
    yield {"scene": lit, "technique": "backward", "pixel_samples": 4,
           "views": [{**VIEW, "metrics": ["dgp", "ugr"], "glare": glare}]}
    yield {"scene": dark, "sky": sky[8], "technique": "backward", "pixel_samples": 1, "views": [
        {**VIEW, "metrics": ["dgp"],
         "glare": {"mask": "eye.hdr", "band_rad": 0.2, "vertical_illuminance_lx": 1000}}]}
    yield {"scene": lit, "technique": "backward", "pixel_samples": 4, "views": [VIEW]}
    yield {"scene": lit, "technique": "backward", "pixel_samples": 1, "views": [
        {**VIEW, "formats": ["hdr", "png", "png16", "exr", "exr_float"],
         "display": {"tone": "human", "veil": True, "acuity": True, "color_loss": True},
         "false_color": {"scale": 1000, "decades": 2, "divisions": 8, "palette": "hot", "label": "nit",
                         "multiplier": 179, "isolines": True, "extrema": True,
                         "draw": ["fill", "lines", "bands"],
                         "points": [{"name": "here", "x": 3, "y": 4.5}]}},
        {**VIEW, "name": "b", "display": {"exposure": 0.5}, "pixel_aspect": 1, "irradiance": True}, {**VIEW, "name": "c", "display": {"ev": 9}}]}
    yield {"scene": lit, "accuracy": {"relative_error": 0.5, "at": 0.9}, "sensors": SENSORS}
    yield {"scene": lit, "accuracy": {"dgp_error": 0.5},
           "views": [{**VIEW, "metrics": ["dgp"], "glare": {"vertical_illuminance_lx": 900}}]}
    yield {"scene": lit, "accuracy": {"deadline_s": 0.01}, "sensors": SENSORS}
    yield {"scene": dark, "sky": sky[8], "technique": "backward", "pixel_samples": 1, "views": [
        {"name": "f", "file": "v.vf", "entry": 1, "width": 16, "height": 12}]}
    yield {"scene": lit, "technique": "backward", "gather_samples": 8, "grids": [
        {"name": "a/b", "sensors": SENSORS}, {"name": "c", "sensors": SENSORS}]}
    for one in sky:
        yield {"scene": dark, "sky": one, "sensors": {"file": "s.txt"}}
    for one in several:
        yield {"scene": dark, "skies": one, "sensors": {"file": "s.txt"}}
    study = {"kind": "study", "priority": 5, "name": "n", "tags": ["a"], "title": "t", "note": "n", "scene": lit,
             "effects": {"sun": "skip"}, "seed": 3, "techniques": ["backward", "gather"],
             "photons": [500, 1000], "repeats": 2, "reference": {"samples": 64, "runs": 2},
             "points": [{"name": "other", "seconds": 1, "rms": 0.1, "rays_per_s": 1e6}]}
    yield {**study, "gather_samples": [8, 16], "sensors": SENSORS}
    yield {**study, "scene": dark, "sky": sky[8], "pixel_samples": [1, 2], "views": [VIEW]}
    year = {"kind": "annual", "priority": 5, "name": "n", "tags": ["a"], "scene": dark, "weather": "w.epw", "year": 2020}
    yield {**year, "title": "t", "north": 10, "ground_reflectance": 0.3, "sun": "radiance", "samples": 16, "sun_halvings": 1, "seed": 3,
           "grids": [{"name": "a", "area": 2, "sensors": {"file": "s.txt"}},
                     {"name": "b", "area": 1, "sensors": SENSORS}],
           "occupancy": {"from": 9, "to": 17, "days": ["mon", "tue"], "first_day": "sun"},
           "metrics": ["DA300", "UDI100-3000"], "targets": ["sDA300/50 of a >= 50 %"],
           "rules": ["LEED"], "accuracy": {"verdict": "sDA >= 1 %"}, "formats": ["ill"], "median_diffuse": 14200,
           "exposure": {"points": [{"name": "w", "at": [1, 2, 1.2]}], "least_altitude": 10},
           "view_out": {"points": [{"name": "w", "at": [1, 2, 1.2]}], "above_sensors": 0.4, "openings": ["pane"], "ground": ["pane"]}}
    yield {**year, "sensors": SENSORS, "technique": "precomputed", "photons": 1000}
    yield {**year, "sensors": {"file": "s.txt"}, "occupancy": {"file": "u.csv"},
           "glare": {"seats": [{"name": "w", "at": [1, 2, 1.2], "towards": [0, -1, 0]}]}}
    panel = {"kind": "bsdf_make", "priority": 5, "name": "n", "tags": ["a"], "scene": sheet, "seed": 3, "paths": 16,
             "accuracy": 0.5, "paths_most": 64, "cell": {"x": [0, 1], "y": [0, 1]}}
    yield {**panel, "basis": "klems_quarter", "symmetry": "both", "color": True}
    yield {**panel, "basis": "tensor_tree_4", "resolution": 4, "cull": 0.1}
    yield {"kind": "bsdf_fit", "priority": 5, "name": "n", "tags": ["a"], "measurements": measured, "basis": "tensor_tree_3",
           "symmetry": "isotropic", "resolution": 4, "cull": 0.1, "reversed": True, "keep_outliers": True, "grazing": 1}
    three = {"grid": "a", "view": "m.mtx", "transmission": "m.mtx", "daylight": "m.mtx", "sky": "m.mtx", "subtract": True}
    yield {**year, "grids": [{"name": "a", "sensors": SENSORS}], "matrices": [{"coefficients": "m.mtx", "sky": "m.mtx"}, three]}
    shut = {"name": "shut", "files": ["shut.rad"], "material": "grey", "dark": False}
    shade = {"windows": ["pane"], "states": [{"name": "open"}, shut]}
    for schedule in [0, 1], {"file": "u.csv"}:
        yield {**year, "sensors": SENSORS, "shades": [{"name": "a", "schedule": schedule, **shade}]}
    yield {**year, "sensors": SENSORS, "shades": [
        {"name": "a", "rules": [{"months": [5, 9], "from": 9, "to": 17, "state": "shut"}], **shade}]}
    yield {**year, "grids": [{"name": "eyes", "sensors": SENSORS}], "shades": [
        {"name": "a", **shade, "control": {"by": "sun", "grid": "eyes", "above": 500, "share": 1,
                                           "state": "shut"}}]}
    yield {**year, "sensors": SENSORS, "shades": [
        {"name": "a", **shade, "control": {"by": "dgp", "seats": [{"name": "w", "at": [1, 2, 1.2], "towards": [0, -1, 0]}]}}]}


def places(value, path=()):
    """Every place in a document, from the outside in."""
    yield path
    items = (value.items() if isinstance(value, dict)
             else list(enumerate(value))[:1] if isinstance(value, list) else ())
    for key, child in items:
        yield from places(child, path + (key,))


def changed(document, path, change):
    """A copy in which change(container, key) was called for the place."""
    whole = {"": copy.deepcopy(document)}
    container, key = whole, ""
    for step in path:
        container, key = container[key], step
    change(container, key)
    return whole[""]


def variants(document, done):
    """The document, changed in one place each that no document before it had. done: such places."""
    for path in places(document):
        place = (document.get("kind"), *(step for step in path if isinstance(step, str)), len(path))
        if place in done:
            continue
        done.add(place)
        for odd in ODD[len(done) % SHARE::SHARE]:
            yield changed(document, path, lambda at, key, odd=odd: at.__setitem__(key, odd))
        yield changed(document, path, lambda at, key: isinstance(at[key], dict)
                      and at[key].__setitem__("surplus", 1))
        if path and isinstance(path[-1], str):
            yield changed(document, path, lambda at, key: at.pop(key))
        yield changed(document, path, lambda at, key: isinstance(at[key], list) and at[key]
                      and at[key].extend(at[key][:1] * 70))


def breaks(daemon):
    """All of them; and no member of a request that no job here has."""
    lit = daemon.upload(ROOM + SKY)
    weather = bsdf("weather.epw").decode("latin-1")
    dark = daemon.upload(ROOM, resources={"w.epw": weather, "place.epw": weather, "s.txt": "1 1 1 0 0 1\n",
                                          "u.csv": "1\n" * 8760,
                                          "m.mtx": "#?RADIANCE\nNROWS=1\nNCOLS=1\nNCOMP=3\n"
                                                   "FORMAT=ascii\n\n1 1 1\n",
                                          "shut.rad": "void plastic shut 0 0 5 .5 .5 .5 0 0\n",
                                          "v.vf": "rvu -vtv -vp 1.5 .5 1.5 -vd 0 1 0\n",
                                          "eye.hdr": "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n"
                                                     "-Y 12 +X 16\n" + 4 * 12 * 16 * "~"})
    sheet = daemon.upload(PANEL)
    measured = daemon.upload(MEASURED)
    taken, refused, done = list(jobs(lit, dark, sheet, measured)), 0, set()
    check_members(daemon.contract, taken)
    try_examples(daemon, {"JobRequest": dark, "StudyRequest": lit, "AnnualRequest": dark,
                          "BsdfMakeRequest": sheet, "BsdfFitRequest": measured})
    for document in taken:
        daemon.ask("POST", daemon.submit(document) + "/cancel")
    for document in taken:
        for variant in variants(document, done):
            if not daemon.contract.judge_request(variant):
                continue
            answer = daemon.ask("POST", "/v1/jobs", json.dumps(variant),
                                {"Content-Type": "application/json"})
            assert answer.status in (400, 413, 422), \
                "%d for %.600r: %s" % (answer.status, variant,
                                       daemon.contract.judge_request(variant))
            refused += 1
    print("# %d jobs taken, %d refused that break the schema in one place" % (len(taken), refused))


def try_examples(daemon, scenes):
    """Examples of requests are taken, with ids of scenes that there are. scenes: by component."""
    schemas = daemon.contract.document["components"]["schemas"]
    for component, scene in scenes.items():
        for example in schemas[component]["examples"]:
            own = "measurements" if "measurements" in example else "scene"
            job = daemon.submit({**example, own: scene})
            for links in schemas["LinkRequest"]["examples"]:
                daemon.ask("POST", job + "/links", links, want=201)
            daemon.ask("POST", job + "/cancel")
    for example in schemas["SceneFiles"]["examples"]:
        assert daemon.ask("POST", "/v1/scenes", example).status in (200, 201)


def check_members(contract, documents):
    before, contract.schemas.seen = contract.schemas.seen, set()
    for document in documents:
        assert not contract.judge_request(document), document
    unmet = contract.members(contract.operations["POST", "/v1/jobs"]["requestBody"])
    unmet -= contract.schemas.seen
    contract.schemas.seen = before
    assert not unmet, "in no job: %s" % sorted(unmet)
