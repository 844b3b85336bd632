"""JSON Schema as api/schema uses it: a value against a schema, strictly.

More than a schema says by itself is asked of objects: a member that nothing describes is a fault
(unevaluatedProperties: false everywhere), unless additionalProperties speaks of it. Keywords that
are not known here are faults of the document.
"""

import re

IGNORED = {"description", "default", "examples", "contentEncoding", "title", "x-unit",
           "x-local"}
APPLIED = {"$ref", "type", "enum", "const", "properties", "required", "additionalProperties",
           "items", "oneOf", "allOf", "pattern", "minLength", "maxLength", "minimum", "maximum",
           "exclusiveMinimum", "exclusiveMaximum", "minItems", "maxItems", "uniqueItems", "format",
           "minProperties", "maxProperties"}
FORMATS = {"binary": lambda text: True,
           "date-time": re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d(\.\d+)?Z").fullmatch}


def is_integer(value):
    return isinstance(value, int) and not isinstance(value, bool)


TYPES = {"object": lambda value: isinstance(value, dict),
         "array": lambda value: isinstance(value, list),
         "string": lambda value: isinstance(value, str),
         "boolean": lambda value: isinstance(value, bool),
         "null": lambda value: value is None,
         "integer": lambda value: is_integer(value) or isinstance(value, float) and value % 1 == 0,
         "number": lambda value: is_integer(value) or isinstance(value, float)}


class Schemas:
    """The schemas of one document. seen: (pointer of a schema, name) of each member met so far."""

    def __init__(self, document):
        self.document = document
        self.seen = set()
        self.pointers = {}
        self._walk(document, "#")

    def _walk(self, node, pointer):
        self.pointers[id(node)] = pointer
        items = (node.items() if isinstance(node, dict)
                 else enumerate(node) if isinstance(node, list) else ())
        for key, child in items:
            self._walk(child, "%s/%s" % (pointer, key))

    def resolve(self, node):
        """What a $ref stands for, of anything but schemas, where members beside it count too."""
        while "$ref" in node:
            node = self.target(node["$ref"])
        return node

    def target(self, reference):
        node = self.document
        for part in reference.lstrip("#/").split("/"):
            node = node[part]
        return node

    def check(self, schema, value, path="$"):
        """What is wrong with the value: a list of sentences."""
        faults, known = self._apply(schema, value, path)
        if isinstance(value, dict):
            faults += ["%s.%s is not documented" % (path, name) for name in value
                       if name not in known]
        return faults

    def _apply(self, schema, value, path):
        """(faults, the members of value that this schema speaks of)"""
        faults, known = [], set()
        if schema is True:
            return faults, set(value) if isinstance(value, dict) else known
        for keyword, argument in schema.items():
            if keyword in IGNORED:
                continue
            if keyword not in APPLIED:
                raise ValueError("%s: keyword %s" % (self.pointers.get(id(schema)), keyword))
            if keyword in ("$ref", "allOf", "oneOf"):
                more, names = self._in_place(keyword, argument, value, path)
                faults += more
                known |= names
            elif isinstance(value, dict) and keyword in ("properties", "additionalProperties"):
                more, names = self._members(schema, keyword, argument, value, path)
                faults += more
                known |= names
            elif isinstance(value, list) and keyword == "items":
                for i, item in enumerate(value):
                    faults += self.check(argument, item, "%s[%d]" % (path, i))
            else:
                fault = _scalar(keyword, argument, value)
                faults += ["%s is %.60r, %s" % (path, value, fault)] if fault else []
        return faults, known

    def _in_place(self, keyword, argument, value, path):
        if keyword == "$ref":
            return self._apply(self.target(argument), value, path)
        results = [self._apply(part, value, path) for part in argument]
        if keyword == "allOf":
            return sum((more for more, _ in results), []), set().union(*(n for _, n in results))
        good = [names for more, names in results if not more]
        if len(good) == 1:
            return [], good[0]
        reasons = "; ".join(more[0] for more, _ in results if more)
        return ["%s fits %d of oneOf: %s" % (path, len(good), reasons)], set()

    def _members(self, schema, keyword, argument, value, path):
        faults, known = [], set()
        for name, member in value.items():
            place = "%s.%s" % (path, name)
            if keyword == "properties" and name in argument:
                self.seen.add((self.pointers[id(schema)], name))
                known.add(name)
                faults += self.check(argument[name], member, place)
            elif keyword == "additionalProperties" and name not in schema.get("properties", ()):
                if argument is not False:
                    known.add(name)
                    faults += self.check(argument, member, place)
        return faults, known


def _scalar(keyword, argument, value):
    """What a keyword that looks at the value alone has against it, or None."""
    if keyword == "type":
        kinds = argument if isinstance(argument, list) else [argument]
        return None if any(TYPES[kind](value) for kind in kinds) else "no %s" % " or ".join(kinds)
    if keyword == "enum":
        same = [one for one in argument if one == value and type(one) is type(value)]
        return None if same else "none of %s" % argument
    if keyword == "const":
        return None if value == argument else "not %r" % argument
    if isinstance(value, dict):
        return _of_object(keyword, argument, value)
    if isinstance(value, list):
        return _of_array(keyword, argument, value)
    if isinstance(value, str):
        return _of_text(keyword, argument, value)
    if TYPES["number"](value):
        return _of_number(keyword, argument, value)
    return None


def _of_object(keyword, argument, value):
    if keyword == "required":
        absent = [name for name in argument if name not in value]
        return "without %s" % ", ".join(absent) if absent else None
    wrong = {"minProperties": len(value) < argument,
             "maxProperties": len(value) > argument} if "Properties" in keyword else {}
    return "with %d members" % len(value) if wrong.get(keyword) else None


def _of_array(keyword, argument, value):
    if keyword == "minItems" and len(value) < argument or \
            keyword == "maxItems" and len(value) > argument:
        return "with %d items" % len(value)
    if keyword == "uniqueItems" and argument and len({repr(item) for item in value}) < len(value):
        return "with an item twice"
    return None


def _of_text(keyword, argument, value):
    if keyword == "pattern" and not re.search(argument, value):
        return "which %s does not match" % argument
    if keyword == "minLength" and len(value) < argument or \
            keyword == "maxLength" and len(value) > argument:
        return "of %d characters" % len(value)
    if keyword == "format" and not FORMATS[argument](value):
        return "no %s" % argument
    return None


def _of_number(keyword, argument, value):
    bad = {"minimum": lambda: value < argument, "maximum": lambda: value > argument,
           "exclusiveMinimum": lambda: value <= argument,
           "exclusiveMaximum": lambda: value >= argument}.get(keyword)
    return "beyond %s %s" % (keyword, argument) if bad and bad() else None
