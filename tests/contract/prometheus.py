"""The text that GET /metrics answers with, read strictly: Prometheus' exposition format 0.0.4."""

import re

NAME = r"[a-zA-Z_:][a-zA-Z0-9_:]*"
LABEL = r'[a-zA-Z_][a-zA-Z0-9_]*="(?:[^"\\\n]|\\[\\"n])*"'
SAMPLE = re.compile(r"(%s)(?:\{(%s(?:,%s)*)\})? (\S+)" % (NAME, LABEL, LABEL))
NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?([eE][+-]?\d+)?|Inf)|NaN")

# What an operator is promised (info of the operation), by family.
WANTED = {"oriel_queue_depth": "gauge", "oriel_jobs": "gauge", "oriel_job_runs_total": "counter",
          "oriel_stage_seconds": "histogram", "oriel_photons_total": "counter",
          "oriel_parts": "gauge", "oriel_parts_done_total": "counter",
          "oriel_parts_again_total": "counter", "oriel_parts_lost_seconds_total": "counter",
          "oriel_rays_total": "counter", "oriel_health_total": "counter",
          "oriel_cache_entries": "gauge", "oriel_cache_bytes": "gauge",
          "oriel_cache_hits_total": "counter", "oriel_cache_misses_total": "counter",
          "oriel_shelf_bytes": "gauge", "oriel_shelf_items": "gauge",
          "oriel_shelf_hits_total": "counter",
          "oriel_memory_capacity_bytes": "gauge", "oriel_memory_free_bytes": "gauge",
          "oriel_memory_jobs_bytes": "gauge", "oriel_memory_checks_bytes": "gauge",
          "oriel_shelf_scenes": "gauge", "oriel_shelf_scene_hits_total": "counter",
          "oriel_storage_bytes": "gauge", "oriel_storage_budget_bytes": "gauge",
          "oriel_evictions_total": "counter", "oriel_http_connections": "gauge",
          "oriel_event_streams": "gauge", "oriel_http_slow_clients_total": "counter",
          "oriel_loop_turn_seconds": "histogram", "oriel_loop_longest_turn_seconds": "gauge",
          "oriel_scrub_files_total": "counter", "oriel_scrub_bytes_total": "counter",
          "oriel_scrub_damaged_total": "counter",
          "oriel_pool_requests": "gauge", "oriel_pool_wait_seconds": "gauge",
          "oriel_http_request_seconds": "histogram", "oriel_build_info": "gauge",
          "process_start_time_seconds": "gauge", "process_cpu_seconds_total": "counter",
          "process_resident_memory_bytes": "gauge"}


class Family:
    def __init__(self, name, kind):
        self.name, self.kind = name, kind
        self.samples = {}  # (sample's name, its labels as text) -> value

    def owns(self, name):
        endings = ("_bucket", "_sum", "_count") if self.kind == "histogram" else ("",)
        return name in [self.name + ending for ending in endings]


def parse(text):
    """Families by name; raises AssertionError where the text is not as the format has it."""
    families, helped, family = {}, None, None
    assert text.endswith("\n")
    for line in text.split("\n")[:-1]:
        words = line.split(" ", 3)
        if line.startswith("# HELP "):
            helped = words[2]
            assert len(words) == 4 and words[3] and helped not in families, line
        elif line.startswith("# TYPE "):
            assert words[2] == helped and words[3] in ("gauge", "counter", "histogram"), line
            assert (words[3] == "counter") == helped.endswith("_total"), line
            family = families[helped] = Family(helped, words[3])
        else:
            match = SAMPLE.fullmatch(line)
            assert match and NUMBER.fullmatch(match.group(3)), line
            assert family and family.owns(match.group(1)), line
            key = match.group(1), match.group(2) or ""
            assert key not in family.samples, "twice: " + line
            family.samples[key] = float(match.group(3))
    for one in families.values():
        if one.kind == "histogram":
            check_histogram(one)
    return families


def check_histogram(family):
    """Each set of labels: buckets that grow with their bounds, the last of them the count."""
    series = {}
    for (name, labels), value in family.samples.items():
        bound = re.search(r',?le="([^"]*)"', labels)
        rest = labels.replace(bound.group(0), "") if bound else labels
        one = series.setdefault(rest, {"buckets": []})
        if name.endswith("_bucket"):
            one["buckets"].append((float(bound.group(1)), value))
        else:
            one[name[len(family.name):]] = value
    for labels, one in series.items():
        assert one["buckets"] == sorted(one["buckets"]), labels
        counts = [count for _, count in one["buckets"]]
        assert counts == sorted(counts) and one["buckets"][-1] == (float("inf"), one["_count"])
        assert one["_sum"] >= 0 and (one["_count"] > 0 or one["_sum"] == 0), labels


def check(before, after):
    """Two readings of one daemon: all that is promised is there, and no counter went back."""
    for name, kind in WANTED.items():
        assert name in after and after[name].kind == kind, name
        assert after[name].samples or kind == "histogram", name
    assert set(after) == set(WANTED), "not promised: %s" % (set(after) - set(WANTED))
    for name, family in before.items():
        for key, value in family.samples.items():
            if family.kind != "gauge":
                assert after[name].samples.get(key, -1) >= value, (name, key)
