"""Job documents at the bounds of their description, for unit/test_described_documents.

    documents.py

Each line is a verdict, a place, and a document, separated by tabs. The verdict is `accept` or
`refuse`; `bounds` accepts, or refuses for a reason other than the value at the place.

The documents are those of tests/contract/breaks.py, which have every member of every request.
Each is changed in one place: a number at, below and above its bounds; each word of an enumeration
and another one; a text or list that is too short, as long as allowed, or too long; a value of
another type; an object without a member that it requires, or with one that nothing describes.
"""
import copy
import json
import os
import re
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "../contract"), os.path.join(HERE, "../../api/schema")]
import breaks
import describe

IDS = [digit * 64 for digit in "abcd"]
MOST_ITEMS = 5000   # longer lists are not made
STEP = 1e-6         # beyond a bound of a number, relative to it
KINDS = {"render": "JobRequest", "study": "StudyRequest", "annual": "AnnualRequest",
         "bsdf_make": "BsdfMakeRequest", "bsdf_fit": "BsdfFitRequest"}
# At a bound, these depend on other members of their document, or on what their words mean.
WITHIN = re.compile(r"""(?x)
    \.(view|cie\.type|tone|points\[\]\.[xy]|task\.[xy]|vertical_illuminance_lx)$
    |^render\.skies\.(from|to)\.(month|day|hour)$
    |^study\.(techniques\[\]|repeats)$
    |^annual\.((grids\[\]\.name|matrices\[\]\.grid|accuracy\.verdict|shades\[\]\.states\[\]\.dark)$
               |(metrics|targets|rules|formats)\[\]$|shades\[\]\.(schedule\[\]|(rules\[\]|control)\.(state|by|grid))$)
    |^bsdf_(make|fit)\.(paths|basis|symmetry|cell\.[xy]\[\])$""")
# Their largest value follows from other members.
ELSEWHERE = ("study.repeats", "annual.shades[].schedule[]", "render.views[].false_color.points[].x",
             "render.views[].false_color.points[].y")


def parts(schema, value):
    """The schema, and those that it refers to or consists of, that a value may fit."""
    while "$ref" in schema:
        schema = describe.schemas()[describe.name_of(schema["$ref"])]
    yield schema
    for one in schema.get("oneOf", ()):
        if set(one) != {"required"}:
            yield from parts(one, value)


def of_type(schema, value):
    """The one of them that describes a value of this type."""
    kinds = {dict: "object", list: "array", str: "string", bool: "boolean", int: "number", float: "number"}
    for one in parts(schema, value):
        kind = one.get("type", "string" if "enum" in one or "const" in one else None)
        if {"integer": "number"}.get(kind, kind) == kinds[type(value)]:
            return one
    raise ValueError("no schema for %r: %r" % (value, schema))


def walk(schema, value, path, name):
    """Each place in a document: its description, its value, its path and name."""
    one = of_type(schema, value)
    yield schema, one, value, path, name
    if isinstance(value, dict):
        for key, child in value.items():
            yield from walk(one["properties"][key], child, path + (key,), "%s.%s" % (name, key))
    elif isinstance(value, list):
        for index, child in enumerate(value[:8]):
            yield from walk(one["items"], child, path + (index,), name + "[]")


def changed(document, path, value):
    """A copy with another value at the place; without it for None."""
    whole = {"": copy.deepcopy(document)}
    at, key = whole, ""
    for step in path:
        at, key = at[key], step
    if value is None:
        del at[key]
    else:
        at[key] = value
    return whole[""]


def of_number(schema, one):
    whole = one["type"] == "integer"
    for low in (True, False):
        bound = one.get("minimum" if low else "maximum")
        open_bound = one.get("exclusiveMinimum" if low else "exclusiveMaximum")
        edge = bound if open_bound is None else open_bound
        if edge is None or abs(edge) >= 2 ** 63 - 1:
            continue
        step = 1 if whole else max(abs(edge), 1e-6) * STEP
        beyond, inside = (edge - step, edge + step) if low else (edge + step, edge - step)
        yield ("bounds", edge) if open_bound is None else ("refuse", edge)
        yield "refuse", beyond
        if open_bound is not None:
            yield "bounds", inside
    if whole:
        yield "refuse", one.get("minimum", 0) + 0.5
    if not any(part.get("type") == "string" for part in parts(schema, None)):
        yield "refuse", "1"


def of_text(schema, one):
    words = [word for part in parts(schema, "") for word in part.get("enum", ()) or
             ([part["const"]] if "const" in part else [])]
    if words:
        yield from (("bounds", word) for word in words)
        yield "refuse", words[0] + "x"
    letter = "a" if one.get("pattern", "a") != "^[0-9a-f]{64}$" else None
    if "maxLength" in one and letter:
        yield "bounds", letter * one["maxLength"]
        yield "refuse", letter * (one["maxLength"] + 1)
    if one.get("minLength"):
        yield "refuse", ""
    if "pattern" in one:
        yield "refuse", "\x01"
        yield "refuse", "a\tb"
    yield "refuse", 1


def of_list(one, value):
    for count, verdict in ((one.get("minItems", 0) - 1, "refuse"), (one.get("minItems", 0), "bounds"),
                           (one.get("maxItems", MOST_ITEMS), "bounds"),
                           (one.get("maxItems", MOST_ITEMS) + 1, "refuse")):
        if 0 <= count < MOST_ITEMS and (value or count == 0):
            yield verdict, (value * count)[:count]
    if one.get("uniqueItems") and value:
        yield "refuse", value[:1] * 2
    yield "refuse", {"surplus": 1}


def of_object(one, value):
    if one.get("additionalProperties") is False:
        yield "refuse", {**value, "surplus": 1}
    for member in one.get("required", ()):
        yield "refuse", {key: child for key, child in value.items() if key != member}
    yield "refuse", "x"


def variants(schema, one, value):
    """(verdict, value) for other values of a place."""
    if isinstance(value, bool):
        return [("bounds", True), ("bounds", False), ("refuse", 1), ("refuse", "true")]
    if isinstance(value, (int, float)):
        return of_number(schema, one)
    if isinstance(value, str):
        return of_text(schema, one)
    return of_list(one, value) if isinstance(value, list) else of_object(one, value)


def reached(schema, met, found):
    """Every member that a document of a schema may have, as (component's id, name)."""
    for one in parts(schema, None):
        if id(one) in met:
            continue
        met.add(id(one))
        for name, child in one.get("properties", {}).items():
            found.add((id(one), name))
            reached(child, met, found)
        if "items" in one:
            reached(one["items"], met, found)


def main():
    seen, wanted, met, done, lines = set(), set(), set(), set(), 0
    for component in KINDS.values():
        reached({"$ref": "#/" + component}, met, wanted)
    for document in list(breaks.jobs(*IDS)) + [example for component in KINDS.values() for example
                                              in describe.schemas()[component]["examples"]]:
        kind = document.get("kind", "render")
        root = {"$ref": "#/" + KINDS[kind]}
        print("accept", kind, json.dumps(document), sep="\t")
        for schema, one, value, path, name in walk(root, document, (), kind):
            if isinstance(value, dict):
                seen |= {(id(one), member) for member in value}
            place = (id(one), name)
            if place in done:
                continue
            done.add(place)
            for verdict, other in variants(schema, one, value):
                if verdict == "bounds" and not isinstance(value, list) and not WITHIN.search(name):
                    verdict = "accept"
                if verdict == "bounds" and name in ELSEWHERE:
                    continue
                print(verdict, ".".join(map(str, path)), json.dumps(changed(document, path, other)), sep="\t")
    missing = sorted(name for component, name in wanted - seen)
    if missing:
        sys.exit("in no document: %s" % ", ".join(missing))


if __name__ == "__main__":
    main()
