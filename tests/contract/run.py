"""Every operation and every documented status of api/openapi against live daemons.

Usage: python3 tests/contract/run.py [ROUTES]. $ORIEL_BUILD names the build folder. ROUTES is a file
with the daemon's routes, one "METHOD /path/{}" a line: none may be missing in the contract. Prints
what was covered; ends with status 1 when anything is undocumented, wrong or never seen.
"""

import errno
import os
import re
import resource
import struct
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../api/schema"))
import bounds
import breaks
import cases
import describe
import every
import members
import observed
from daemons import Daemon, is_sanitized
from recorder import Contract

# With options, what is asked of a daemon, in this order.
DAEMONS = (((), (cases.service, cases.scenes, cases.plans, cases.bsdfs, cases.renders, cases.skies,
                 cases.accuracy, cases.studies, cases.years, cases.panels, cases.measurements, cases.ended_events, cases.all_events,
                 cases.failures, cases.refusals, bounds.damage)),
           ((), (members.rare_members, members.projects, members.measurements)),
           ((), (bounds.waiting,)),
           (("--storage-budget", "192K"), (bounds.storage,)),
           ((), (observed.metrics,)),
           ((), (breaks.breaks,)))
BUILD = os.environ.get("ORIEL_BUILD", "build")


def check_routes(contract, path):
    with open(path) as stream:
        routes = {line.strip().replace("{*}", "{}") for line in stream}
    known = {"%s %s" % (method, re.sub(r"{.*?}", "{}", template))
             for method, template in contract.operations if method != "HEAD"}
    assert routes == known, "routes and operations differ: %s" % sorted(routes ^ known)


def descriptions(node, path=()):
    """Each description of the document, with its path."""
    items = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, child in items:
        if key == "description" and isinstance(child, str):
            yield "/".join(map(str, path)), " ".join(child.split())
        else:
            yield from descriptions(child, path + (key,))


def check_document(contract):
    """What the document says of itself must hold: sentences, references, ids, required members."""
    for place, text in descriptions(contract.document):
        assert re.match(r"[A-Z`|1]", text) and text.endswith((".", ".)")), "%s: '%s'" % (place, text)
    for name, schema in contract.document["components"]["schemas"].items():
        assert "description" in schema, "%s says nothing" % name
        for member, one in schema.get("properties", {}).items():
            assert "description" in one or "$ref" in one, "%s.%s says nothing" % (name, member)
    ids = [operation["operationId"] for operation in contract.operations.values()]
    assert len(set(ids)) == len(ids), "an operationId twice"
    for name, schema in contract.document["components"]["schemas"].items():
        for example in schema.get("examples", ()):
            assert not contract.schemas.check(schema, example), (name, example)
    tags = {tag["name"] for tag in contract.document["tags"]}
    text = repr(contract.document)
    for kind, parts in contract.document["components"].items():
        for name in parts:
            assert kind == "securitySchemes" or "#/components/%s/%s'" % (kind, name) in text, \
                "%s/%s is used nowhere" % (kind, name)
    for operation, one in contract.operations.items():
        assert one.get("summary"), "%s %s says nothing" % operation
        assert len(one["tags"]) == 1 and one["tags"][0] in tags, "%s %s has no tag" % operation
        named = set(re.findall(r"{(\w+)}", operation[1]))
        item = contract.document["paths"][operation[1]]
        given = [contract.schemas.resolve(parameter)
                 for parameter in item.get("parameters", []) + one.get("parameters", [])]
        assert named == {one["name"] for one in given if one["in"] == "path"}, operation


def with_full_disk(contract):
    """tests/torture/faulty.c tells what stands in the file."""
    with tempfile.NamedTemporaryFile() as control:
        def fill(full):
            control.seek(0)
            control.write(struct.pack("ii", errno.ENOSPC if full else 0, 3))
            control.flush()
        fill(False)
        faulty = os.path.abspath(os.path.join(BUILD, "tests", "faulty.so"))
        assert os.path.exists(faulty), faulty + " is not built: make tests"
        daemon = Daemon(contract, "--threads", "1", "--tokens", "always", environment={
            "LD_PRELOAD": faulty, "FAULTY": control.name})
        bounds.full_disk(daemon, fill)
        daemon.end()


def run(contract):
    text = describe.openapi()
    whole = (every.things_unknown, every.strays, every.web_pages, every.bodies_refused)
    for i, (options, group) in enumerate(DAEMONS):
        daemon = Daemon(contract, "--threads", "1", *options)
        assert daemon.ask("GET", "/openapi.yaml", want=200).body.decode() == text
        for part in (whole if i == 0 else ()) + group:
            began = time.monotonic()
            part(daemon)
            print("# %-16s %5.1f s" % (part.__name__, time.monotonic() - began), flush=True)
        daemon.end()
    if not is_sanitized():
        with_full_disk(contract)
    visited = Daemon(contract, "--allow-origin", "https://tool.example")
    every.pages_let_in(visited)
    visited.end()
    guarded = Daemon(contract, "--tokens", "always", "--storage-budget", "16M")
    every.tokens(guarded)
    bounds.too_much_under_way(guarded)
    cases.sessions(guarded)
    guarded.end()
    for attempt in range(3):
        try:
            every.stopping(Daemon(contract), bounds.busy_upload)
            break
        except every.EndedTooSoon:
            assert attempt < 2, "the daemon gives no answer while it stops"


def main():
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(hard, max(soft, 8192)), hard))
    contract = Contract(describe.openapi())
    check_document(contract)
    if len(sys.argv) > 1:
        check_routes(contract, sys.argv[1])
    run(contract)
    expected = contract.expected()
    missing = [one for one in contract.missing() if not is_sanitized() or one[2] != "507"]
    for one in missing:
        print("never seen: %s %s %s %s" % one)
    unmet = contract.unmet_members()
    unmet = [one for one in unmet if not members.is_elsewhere(*one)]
    for pointer, name in unmet:
        print("no answer had %s of %s" % (name, pointer))
    statuses = {one[:3] for one in expected}
    print("# contract: %d operations, %d of %d statuses, %d of %d with media types, %d answers"
          % (len(contract.operations), len(statuses & {one[:3] for one in contract.seen}),
             len(statuses), len(expected) - len(missing), len(expected), contract.answers))
    return 1 if missing or unmet else 0


if __name__ == "__main__":
    sys.exit(main())
