#!/usr/bin/env python3
"""The description of documents (api/schema/*.yaml) and of the interface (api/openapi/*.yaml), as one.

    describe.py openapi >FILE      the whole as one OpenAPI document
    describe.py tables FOLDER      schemas.h and schemas.c, which the decoders use
    describe.py reference FOLDER   pages of the guide, one per subject

Bounds that the programs define themselves stand in the YAML by the constant's name, such as
`maximum: ORL_LIMIT_VIEWS` or `maxLength: ORL_GLARE_MASK_MAX - 1`; here they become numbers.
"""
import functools
import glob
import os
import re
import sys

import yaml

ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))
HEADERS = ("core/include/oriel/*/*.h", "api/*/*.h", "server/process/limits.h", "server/http/*.h", "server/http/*/*.h")
COMMENT = re.compile(r"/\*.*?\*/", re.S)
CONSTANT = re.compile(r"(?:#define\s+(ORL_\w+)[ \\\n]+([^\n]+)|\b(ORL_\w+)\s*=\s*([^,}\n]+))")
USE = re.compile(r"\b(ORL_[A-Z0-9_]+)((?: - \d+)?)")
# Order of the document's parts; paths and schemas follow in the order of their files' names.
PARTS = ("parts", "responses")


def read(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as stream:
        return stream.read()


def files(pattern):
    return sorted(glob.glob(os.path.join(ROOT, pattern)))


@functools.lru_cache(maxsize=None)
def constants():
    """The text of each constant's value, by its name."""
    found = {}
    for pattern in HEADERS:
        for path in files(pattern):
            for one in CONSTANT.finditer(COMMENT.sub("", read(path))):
                found.setdefault(one[1] or one[3], (one[2] or one[4]).strip())
    return found


def value_of(name):
    """A constant's value: a number, or a text without its quotation marks."""
    text = constants()[name]
    if text.startswith('"'):
        return text.strip('"')
    text = re.sub(r"\b(0x[0-9a-f]+|\d+)[uUlL]+\b", r"\1", text)
    text = USE.sub(lambda one: str(value_of(one[1])), text)
    if not re.fullmatch(r"[\d\s()<>*+.e-]+", text):
        raise ValueError("%s is '%s', which is no number" % (name, text))
    value = eval(text, {"__builtins__": {}})
    return int(value) if value == int(value) else value


def resolve(text):
    """The text with numbers in place of constants."""
    def number(one):
        value = value_of(one[1])
        return str(value - int(one[2][3:]) if one[2] else value)
    return USE.sub(number, text)


def indented(text, columns):
    return "".join(" " * columns + line if line.strip() else line
                   for line in text.splitlines(keepends=True))


def openapi():
    """The OpenAPI document's text."""
    text = read("api/openapi/info.yaml") + "paths:\n"
    for path in files("api/openapi/paths_*.yaml"):
        text += indented(read(path), 2)
    text += "components:\n"
    for part in PARTS:
        text += indented(read("api/openapi/%s.yaml" % part), 2)
    text += "  schemas:\n"
    for path in files("api/schema/*.yaml"):
        text += indented(read(path), 4)
    return resolve(text)


def check(node, path):
    """Raises ValueError for a member without a value: a comma in a text without quotation marks."""
    for key, value in node.items() if isinstance(node, dict) else enumerate(node):
        if value is None and path[-1:] != ("enum",) and "examples" not in path:
            raise ValueError("%s: '%s' has no value" % ("/".join(path), key))
        if isinstance(value, (dict, list)):
            check(value, path + (str(key),))


@functools.lru_cache(maxsize=None)
def document():
    whole = yaml.load(openapi(), getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    check(whole, ())
    return whole


def schemas():
    return document()["components"]["schemas"]


def name_of(reference):
    return reference.rsplit("/", 1)[1]


def target(node):
    """The node itself, or the one that it refers to."""
    while "$ref" in node:
        node = schemas()[name_of(node["$ref"])]
    return node


def first_sentence(text):
    """The first sentence of a description, in one line."""
    line = " ".join(text.split())
    found = re.match(r"(.*?[.?!])(?: [A-Z0-9`\"(]|$)", line)
    return found[1] if found else line


def main():
    what = sys.argv[1] if len(sys.argv) > 1 else ""
    if what == "openapi" and len(sys.argv) == 2:
        sys.stdout.write(openapi())
    elif what == "tables" and len(sys.argv) == 3:
        import tables
        tables.write(sys.argv[2])
    elif what == "reference" and len(sys.argv) == 3:
        import reference
        reference.write(sys.argv[2])
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    # The module and the program are one: others import it by its name.
    sys.modules["describe"] = sys.modules["__main__"]
    main()
