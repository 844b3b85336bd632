"""Descriptions of documents as C: what api/json/json_schema.h declares, for the decoders.

Each component that a document of ROOTS reaches becomes `orl_schema_<component>`, and each value
inside it `orl_schema_<component>_<member>`; elements of an array add `_item`.
"""
import os
import re

import describe

ROOTS = ("JobRequest", "StudyRequest", "AnnualRequest", "BsdfMakeRequest", "BsdfFitRequest",
         "LocalScene", "LinkRequest", "SceneFiles", "ModelWithFiles")
NOTE = "/* Generated from api/schema by api/schema/describe.py. */\n"
MOST_WHOLE = 2 ** 63 - 1


def snake(name):
    return re.sub(r"(?<=[a-z0-9])([A-Z])", r"_\1", name).lower()


def quoted(text):
    return '"%s"' % text.replace("\\", "\\\\").replace('"', '\\"')


class Tables:
    def __init__(self):
        self.names, self.lines, self.left = [], [], list(ROOTS)
        met = set()
        while self.left:
            component = self.left.pop()
            if component not in met:
                met.add(component)
                self.add(snake(component), describe.schemas()[component])

    def address(self, name, node):
        """The C address of a value's description, which is added unless it is a component's."""
        if "$ref" in node:
            component = describe.name_of(node["$ref"])
            self.left.append(component)
            return "&orl_schema_" + snake(component)
        self.add(name, node)
        return "&orl_schema_" + name

    def add(self, name, node):
        fields = self.fields(name, node)
        for one in node.get("oneOf", ()):
            # One of several types: each has bounds of its own kind.
            if "$ref" in one:
                self.address(name, one)
            elif set(one) != {"required"}:
                fields.update(self.fields(name, one))
        self.names.append(name)
        self.lines.append("const struct orl_json_schema orl_schema_%s = {%s};" % (
            name, ", ".join(".%s = %s" % (key, value) for key, value in fields.items()) or "0"))

    def fields(self, name, node):
        fields = {}
        if "description" in node:
            fields["meaning"] = quoted(describe.first_sentence(node["description"]))
        words = node.get("enum") or ([node["const"]] if "const" in node else None)
        if words:
            self.lines.append("static const char *const words_%s[] = {%s, NULL};"
                              % (name, ", ".join(map(quoted, words))))
            fields["words"] = "words_" + name
        kind = node.get("type")
        if kind in ("number", "integer"):
            fields.update(numbers(kind, node))
        default = node.get("default")
        if words and default in words:
            default = words.index(default)
        if isinstance(default, (bool, int, float)):
            fields.update({"has_preset": "true", "preset": float(default)})
        if "maxLength" in node:
            fields["longest"] = node["maxLength"]
        fields.update({to: node[key] for key, to in
                       (("minItems", "fewest_items"), ("maxItems", "most_items")) if key in node})
        if "items" in node:
            fields["items"] = self.address(name + "_item", node["items"])
        if "properties" in node:
            fields["members"] = self.members(name, node)
        return fields

    def members(self, name, node):
        rows = ["{%s, %s, %s}" % (quoted(member),
                                  "true" if member in node.get("required", ()) else "false",
                                  self.address("%s_%s" % (name, snake(member)), one))
                for member, one in node["properties"].items()]
        self.lines.append("static const struct orl_json_described members_%s[] = {\n    %s,\n"
                          "    {0}};" % (name, ",\n    ".join(rows)))
        return "members_" + name


def numbers(kind, node):
    """Bounds of a number: for whole ones they are inclusive."""
    if kind == "integer":
        return {"from": "%dU" % node.get("minimum", 0),
                "to": "%dU" % node.get("maximum", MOST_WHOLE)}
    least = node.get("exclusiveMinimum", node.get("minimum", "-INFINITY"))
    most = node.get("exclusiveMaximum", node.get("maximum", "INFINITY"))
    return {"least": least, "most": most, "above": str("exclusiveMinimum" in node).lower(),
            "below": str("exclusiveMaximum" in node).lower()}


def replace(path, text):
    """Writes a file, unless it has this text: what depends on it is then not built again."""
    if os.path.exists(path):
        with open(path, encoding="utf-8") as stream:
            if stream.read() == text:
                return
    with open(path, "w", encoding="utf-8") as stream:
        stream.write(text)


def write(folder):
    tables = Tables()
    header = (NOTE + "#ifndef ORL_GENERATED_SCHEMAS_H\n#define ORL_GENERATED_SCHEMAS_H\n\n"
              '#include "json/json_schema.h"\n\n'
              + "".join("extern const struct orl_json_schema orl_schema_%s;\n" % name
                        for name in sorted(tables.names)) + "\n#endif\n")
    source = (NOTE + '#include "schemas.h"\n\n#include <math.h>\n#include <stddef.h>\n\n'
              + "\n".join(tables.lines) + "\n")
    replace(os.path.join(folder, "schemas.h"), header)
    replace(os.path.join(folder, "schemas.c"), source)
