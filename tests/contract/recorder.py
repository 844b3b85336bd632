"""api/openapi as a judge: every answer of the daemon is held against it, and what was seen
of it is counted."""

import json
import re

import yaml

from schema import Schemas

METHODS = ("get", "head", "post", "put", "patch", "delete", "options", "trace")
# What any answer may have beside the headers that its operation documents (info.description).
COMMON_HEADERS = {"date", "connection", "content-length", "content-type", "transfer-encoding",
                  "x-request-id", "cache-control", "x-content-type-options"}
# ... and what pages of --allow-origin get.
CORS_HEADERS = {"vary", "access-control-allow-origin", "access-control-expose-headers"}


class Undocumented(AssertionError):
    """The daemon did what the contract does not say."""


class Contract:
    """text: of api/openapi."""

    def __init__(self, text):
        self.document = yaml.load(text, getattr(yaml, "CSafeLoader", yaml.SafeLoader))
        self.schemas = Schemas(self.document)
        self.operations = {}  # ("GET", "/v1/jobs/{id}") -> operation
        self.seen = set()     # (method, template, status, media type or None)
        self.answers = 0
        for template, item in self.document["paths"].items():
            for method in METHODS:
                if method in item:
                    self.operations[method.upper(), template] = item[method]

    def responses(self, operation):
        return {status: self.schemas.resolve(response)
                for status, response in self.operations[operation]["responses"].items()}

    def documented(self, status):
        """The operations that document it, as (method, template)."""
        return [key for key, one in self.operations.items() if str(status) in one["responses"]]

    def template(self, path):
        """The path of the contract that a URL's path is an instance of, or None."""
        path = path.split("?")[0]
        for template in self.document["paths"]:
            pattern = re.sub(r"\\{[^/]*?\\}", "[^/]+", re.escape(template))
            if re.fullmatch(pattern, path):
                return template
        return None

    def expected(self):
        """Every documented (method, template, status, media type)."""
        return {(method, template, status, kind)
                for method, template in self.operations
                for status, response in self.responses((method, template)).items()
                for kind in (response.get("content") or {None: None})}

    # -- One answer -----------------------------------------------------------------------------

    def judge(self, method, path, answer):
        """Raises Undocumented unless the contract describes the answer."""
        self.answers += 1
        template = self.template(path)
        try:
            if "x-request-id" not in answer.headers:
                raise Undocumented("there is no X-Request-Id")
            if answer.headers.get("x-content-type-options") != "nosniff":
                raise Undocumented("a browser may guess its type")
            if answer.status in (404, 405) and (method, template) not in self.operations \
                    and not (method == "HEAD" and ("GET", template) in self.operations):
                self._judge_stray(method, template, answer)
            else:
                self._judge_answer(method, template, answer)
        except Undocumented as fault:
            raise Undocumented("%s %s: %d %.300r: %s" % (method, path, answer.status,
                                                         answer.body, fault)) from None

    def _judge_stray(self, method, template, answer):
        """Of no operation: 404 for a path, 405 for a method, with those that there are."""
        if (answer.status == 405) != (template is not None):
            raise Undocumented("the path is %sknown" % ("" if template else "un"))
        if method != "HEAD":
            self._judge_problem(answer)
        if answer.status == 405:
            known = {one for one, path in self.operations if path == template}
            known |= {"HEAD"} if "GET" in known else set()
            allowed = set(re.split(r", *", answer.headers["allow"]))
            if allowed != known:
                raise Undocumented("Allow says %s, the contract %s" % (allowed, known))

    def _judge_answer(self, method, template, answer):
        key = (method, template)
        if method == "HEAD" and key not in self.operations:
            key = ("GET", template)  # as RFC 9110 has it
        if key not in self.operations:
            raise Undocumented("there is no such operation")
        response = self.responses(key).get(str(answer.status))
        if response is None:
            raise Undocumented("the status is not documented")
        self._judge_headers(response, answer)
        kind = None
        if method == "HEAD":
            if answer.body:
                raise Undocumented("a HEAD has a body")
        elif not response.get("content"):
            if answer.body:
                raise Undocumented("there is no body in the contract")
        else:
            kind = self._judge_body(response["content"], answer)
        if method != "HEAD" or key[0] == "HEAD":
            self.seen.add((*key, str(answer.status), kind))

    def _judge_headers(self, response, answer):
        known = {name.lower(): self.schemas.resolve(header)
                 for name, header in response.get("headers", {}).items()}
        for name in answer.headers:
            if name not in known and name not in COMMON_HEADERS | CORS_HEADERS:
                raise Undocumented("the header %s is not documented" % name)
        for name, header in known.items():
            if name not in answer.headers:
                if header.get("required"):
                    raise Undocumented("the header %s is missing" % name)
                continue
            value = answer.headers[name]
            if header["schema"].get("type") == "integer" and value.isdigit():
                value = int(value)
            self._fail_on(self.schemas.check(header["schema"], value, name))

    def _judge_body(self, content, answer):
        kind = answer.headers.get("content-type", "")
        if kind not in content:
            raise Undocumented("the type %s is not documented" % kind)
        if kind == "application/problem+json":
            self._judge_problem(answer)
        elif kind == "application/json" and answer.status != 206:
            self._fail_on(self.schemas.check(content[kind]["schema"], answer.json))
        return kind

    def _judge_problem(self, answer):
        """RFC 9457: its type, and the status that HTTP has."""
        problem = answer.json
        self._fail_on(self.schemas.check(self.document["components"]["schemas"]["Problem"],
                                         problem))
        if answer.headers["content-type"] != "application/problem+json" \
                or problem["status"] != answer.status:
            raise Undocumented("this is no problem document of that status")

    def judge_event(self, data, schema="JobEvent"):
        """The data of a server-sent event."""
        schema = self.document["components"]["schemas"][schema]
        self._fail_on(self.schemas.check(schema, json.loads(data)))

    def judge_request(self, document):
        """A job that the daemon took must be one that the contract allows."""
        content = self.operations["POST", "/v1/jobs"]["requestBody"]["content"]
        return self.schemas.check(content["application/json"]["schema"], document)

    @staticmethod
    def _fail_on(faults):
        if faults:
            raise Undocumented("; ".join(faults[:5]))

    # -- The whole ------------------------------------------------------------------------------

    def missing(self):
        return sorted(self.expected() - self.seen, key=str)

    def unmet_members(self):
        """Members of answers' schemas that no answer had, as (pointer, name)."""
        responses = [one["responses"] for one in self.operations.values()]
        return sorted(self.members(responses) - self.schemas.seen)

    def members(self, part):
        """Those of all objects that a part of the document describes, as (pointer, name)."""
        reached, left, found = set(), [part], set()
        while left:
            node = left.pop()
            if isinstance(node, list):
                left += node
            if not isinstance(node, dict) or id(node) in reached:
                continue
            reached.add(id(node))
            if isinstance(node.get("$ref"), str):
                left.append(self.schemas.target(node["$ref"]))
            if isinstance(node.get("properties"), dict):
                pointer = self.schemas.pointers[id(node)]
                found |= {(pointer, name) for name in node["properties"]}
            left += [child for key, child in node.items()
                     if isinstance(child, (dict, list)) and key != "x-local"]
        return found
