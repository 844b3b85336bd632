"""What an operator sees of the daemon's work: /metrics, before and after jobs of every end."""

import prometheus
from cases import NEVER, ROOM, SENSORS, SKY, sensors_of


class Reading:
    def __init__(self, daemon):
        self.families = prometheus.parse(daemon.ask("GET", "/metrics", want=200).body.decode())

    def value(self, family, labels=""):
        name = family + ("_count" if self.families[family].kind == "histogram" else "")
        return self.families[family].samples[name, labels]

    def work(self):
        return self.value("oriel_photons_total"), self.value("oriel_rays_total")

    def runs(self, state):
        return self.value("oriel_job_runs_total", 'state="%s"' % state)


def metrics(daemon):
    scene = daemon.upload(ROOM + SKY)
    first = before = Reading(daemon)
    assert before.work() == (0, 0)
    daemon.wait(daemon.submit(sensors_of(scene)))
    after = Reading(daemon)
    assert after.runs("succeeded") == before.runs("succeeded") + 1
    assert after.value("oriel_stage_seconds", 'stage="photons"') == 1
    assert after.work()[1] > after.work()[0] > 1000, after.work()
    for work in (cancelled, failed, study):
        before, state = after, work(daemon, scene)
        after = Reading(daemon)
        prometheus.check(before.families, after.families)
        assert after.runs(state) == before.runs(state) + 1, work.__name__
        if work is not failed:
            assert all(b > a for a, b in zip(before.work(), after.work())), work.__name__
    daemon.wait(daemon.submit(sensors_of(scene)))
    assert Reading(daemon).value("oriel_cache_hits_total") > after.value("oriel_cache_hits_total")
    prometheus.check(first.families, Reading(daemon).families)


def cancelled(daemon, scene):
    """What it did until then counts too."""
    path = daemon.submit(sensors_of(scene, photons={"global": NEVER}, seed=2))
    daemon.wait(path, ("running",), lambda job: job["stage"] == "photons"
                and job["stage_percent"] > 0)
    daemon.ask("POST", path + "/cancel", want=202)
    return daemon.wait(path)["state"]


def failed(daemon, scene):
    """It has a sky already, which only the run finds."""
    overcast = {"cie": {"type": "overcast", "diffuse_horizontal_lx": 10000}}
    return daemon.wait(daemon.submit(sensors_of(scene, sky=overcast)))["state"]


def study(daemon, scene):
    return daemon.wait(daemon.submit(
        {"kind": "study", "scene": scene, "techniques": ["gather"], "photons": [500],
         "gather_samples": [8], "repeats": 1, "sensors": SENSORS,
         "reference": {"samples": 64, "runs": 2}}))["state"]
