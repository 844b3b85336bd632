"""Examples of documents: the decoder accepts each of them.

A document is given to the command in an empty folder. A decoder that accepts it then misses the files that it
names. Parts of documents say by a word where they belong: `json render`, `json annual`, `json view`, `json sky`.
"""
import json
import os
import subprocess
import tempfile

SENSOR = [1, 1, 1, 0, 0, 1]
RENDER = {"kind": "render", "scene": {"files": ["absent.rad"]}}
ANNUAL = {"kind": "annual", "scene": {"files": ["absent.rad"]}, "weather": "absent.epw",
          "grids": [{"name": "desks", "sensors": [SENSOR]}]}
VIEW = {"name": "desk", "view": "-vta -vp 0 0 0 -vd 0 1 0 -vh 180 -vv 180", "width": 400, "height": 400}
COMMANDS = {"render": "run", "annual": "annual", "study": "study"}
MISSING = "cannot open"


def whole_document(part, words):
    """Puts a part into the document that its word names. Returns None without such a word."""
    if "kind" in part:
        return part
    if "view" in words:
        return dict(RENDER, views=[dict(VIEW, **part)])
    if "sky" in words:
        return dict(RENDER, sensors=[SENSOR], sky=part)
    if "annual" in words:
        return dict(ANNUAL, **part)
    if "render" in words:
        asks = {} if {"grids", "views"} & set(part) else {"sensors": [SENSOR]}
        return dict(RENDER, **asks, **part)
    return None


def document_fault(build, text, words):
    """Returns what is wrong with an example, or None."""
    try:
        part = json.loads(text)
    except ValueError as error:
        return "this is no JSON: %s" % error
    document = whole_document(part, words)
    if document is None:
        return "a part of a document needs a word that says where it belongs (tests/guide/documents.py)"
    with tempfile.TemporaryDirectory(prefix="oriel-guide-") as folder:
        with open(os.path.join(folder, "job.json"), "w", encoding="utf-8") as stream:
            json.dump(document, stream)
        done = subprocess.run([os.path.abspath(os.path.join(build, "oriel")), COMMANDS[document["kind"]], "job.json",
                               "-o", "out"], cwd=folder, capture_output=True, text=True, timeout=60)
    return None if MISSING in done.stderr else "oriel refuses this document: %s" % done.stderr.strip()
