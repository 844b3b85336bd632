"""Members of answers: small jobs that give those which no other case needs, and the few that none here
can give, with the reason."""

import json
import os

from cases import FIXTURES, MEASURED, ROOM, SENSORS, SKY, VIEW, bsdf, zipped

# Components of answers, or single members, that no job here gives.
ELSEWHERE = {
    "Runner": "needs Slurm: api/test_slurm_daemon",
    "Parts": "needs Slurm: api/test_slurm_daemon",
    "Job.runner": "needs Slurm: api/test_slurm_daemon",
    "JobEvent.parts": "needs Slurm: api/test_slurm_daemon",
    "plans.runner": "needs Slurm: api/test_slurm_daemon",
    "CrossCheck.differs_in": "needs a wrong result: validation/test_cross_check_faults",
    "SensorResult.unreliable": "needs a wrong result: validation/test_cross_check_faults",
    "JobEvent.skies": "events of a job that runs for long: api/test_skies",
    "JobEvent.warnings": "events of a job that runs for long: api/test_warnings",
    "JobSummary.queue_position": "a queue is long for moments only: api/test_queue",
}
# A picture of VIEW's size whose pixels are all bright.
MASK = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 12 +X 16\n" + 4 * 12 * 16 * "~"


def is_elsewhere(pointer, name):
    """Returns whether the list has a member of a schema with this pointer."""
    component = pointer.split("/")[3] if pointer.startswith("#/components/") else pointer.split("/")[3].strip("/")
    component = component.rsplit("~", 1)[-1]
    return component in ELSEWHERE or "%s.%s" % (component, name) in ELSEWHERE or (
        "/plans/" in pointer and "plans." + name in ELSEWHERE)


def result(daemon, document):
    """The result of a job that succeeds."""
    job = daemon.wait(daemon.submit(document))
    assert job["state"] == "succeeded", job
    return daemon.ask("GET", "/v1/jobs/%s/result" % job["id"], want=200).json


def rare_members(daemon):
    """Grids, parts of a view's glare, an accuracy under several skies, a file of occupancy, a project."""
    lit = daemon.upload(ROOM + SKY)
    found = result(daemon, {"scene": lit, "technique": "backward", "gather_samples": 8, "grids": [
        {"name": "a", "sensors": [[x, y, 1, 0, 0, 1] for x in (1, 2) for y in (1, 2)]},
        {"name": "b", "sensors": SENSORS[1:]}]})
    assert [grid["first"] for grid in found["grids"]] == [0, 4] and found["grids"][0]["map"], found["grids"]
    dark = daemon.upload(ROOM, resources={"eye.hdr": MASK, "w.epw": bsdf("weather.epw").decode("latin-1"),
                                          "u.csv": "1\n" * 8760})
    bright = {"cie": {"type": "uniform", "diffuse_horizontal_lx": 10000}}
    found = result(daemon, {"scene": dark, "sky": bright, "technique": "backward", "pixel_samples": 1, "views": [
        {**VIEW, "metrics": ["dgp"],
         "glare": {"mask": "eye.hdr", "band_rad": 0.2, "vertical_illuminance_lx": 1000}}]})
    glare = found["views"][0]["glare"]
    assert glare["mask"]["pixels"] == 12 * 16 and 0 < glare["band"]["pixels"] < 12 * 16, glare
    found = result(daemon, {"scene": dark, "skies": [bright, bright], "sensors": SENSORS,
                            "accuracy": {"relative_error": 1}})
    assert all(sky["accuracy"]["met"] for sky in found["skies"])
    result(daemon, {"scene": lit, "technique": "auto", "gather_samples": 8, "pixel_samples": 1,
                            "photons": {"global": 500, "caustic": 0}, "sensors": SENSORS, "views": [VIEW]})
    daemon.ask("POST", "/v1/plans", {"scene": lit, "sensors": SENSORS, "views": [VIEW]}, want=200)
    found = result(daemon, {"kind": "annual", "scene": dark, "weather": "w.epw", "samples": 8,
                            "sensors": SENSORS, "occupancy": {"file": "u.csv"}})
    assert found["provenance"]["settings"]["occupancy"] == {"file": "u.csv"}


def projects(daemon):
    """A Honeybee model's summary: its grids, views and states, and what is left out."""
    with open(os.path.join(FIXTURES, "honeybee/two_rooms.hbjson"), encoding="utf-8") as stream:
        model = json.load(stream)
    grids = model["properties"]["radiance"]["sensor_grids"]
    grids.append(grids[0])
    summary = daemon.ask("POST", "/v1/scenes", model).json["summary"]
    assert summary["project"]["grids"] and summary["project"]["warnings"], summary
    folder = zipped("model/scene/a.rad", ROOM + SKY, "model/scene/a.blk", ROOM, "model/grid/a.pts", "0 0 1 0 0 1\n")
    summary = daemon.ask("POST", "/v1/scenes", folder, {"Content-Type": "application/zip"}).json["summary"]
    assert summary["project"]["left_out"][0]["file"] == "model/scene/a.blk", summary


def measurements(daemon):
    """One value among equal ones is an outlier."""
    lines = MEASURED.splitlines()
    lines[len(lines) // 4] = lines[len(lines) // 4].rsplit(",", 1)[0] + ",90"
    scene = daemon.upload("\n".join(lines) + "\n")
    found = result(daemon, {"kind": "bsdf_fit", "measurements": scene, "basis": "klems_quarter"})
    assert found["outliers"]["told"], found["outliers"]
