"""Exceptions of this package. All of them are OrielErrors."""

import json
from email.message import Message
from typing import Any, Dict, Optional, Type

Json = Any  # a value that json.loads returns


class OrielError(Exception):
    """Base class of all errors of this package. hint says what to do, or is None."""

    hint: Optional[str] = None

    def __init__(self, message: str, hint: Optional[str] = None) -> None:
        if hint:
            self.hint = hint
        super().__init__("%s (%s)" % (message, hint) if hint else message)


class Unreachable(OrielError):
    """No daemon answers at the URL, or the connection broke."""


class SettingsError(OrielError):
    """oriel.toml or a token file cannot be used. The message has file and line."""


class Problem(OrielError):
    """The daemon refused a request, or a job failed: a problem document (RFC 9457).

    status, type, title, detail, hint, file, line, primitive: members of the document, or None.
    """

    def __init__(self, document: Dict[str, Json], status: Optional[int] = None) -> None:
        self.document = document
        self.status: Optional[int] = document.get("status", status)
        self.type: Optional[str] = document.get("type")
        self.title: Optional[str] = document.get("title")
        self.detail: Optional[str] = document.get("detail")
        self.file: Optional[str] = document.get("file")
        self.line: Optional[int] = document.get("line")
        self.primitive: Optional[str] = document.get("primitive")
        super().__init__(self._sentence(), document.get("hint"))

    def _sentence(self) -> str:
        place = ":".join(str(part) for part in (self.file, self.line) if part)
        what = self.detail or self.title or "the daemon gave no reason"
        # The detail of an error in a document already begins with the place: do not repeat it.
        where = None if what.startswith("%s:" % self.primitive) else self.primitive
        return ": ".join(part for part in (place, where, what) if part)


class Unauthorized(Problem):
    """401: the daemon requires an access token, or does not know the given one."""


class Forbidden(Problem):
    """403: the token's scope does not allow this."""


class NotFound(Problem):
    """404: the scene, job or file does not exist."""


class InUse(Problem):
    """409: not possible in this state; for example, the item is used by jobs and cannot be removed."""


class Gone(Problem):
    """410: the results were removed to make room. Submit the document again to get them back."""


class Full(Problem):
    """507: the daemon has no space left, and nothing that it may remove."""


class Busy(Problem):
    """429 or 503: the daemon is busy; retry later. retry_after is in seconds, or None."""

    retry_after: Optional[int] = None


class JobFailed(Problem):
    """The job failed; the problem has the reason."""


class JobCancelled(OrielError):
    """The job was cancelled."""


_BY_STATUS: Dict[int, Type[Problem]] = {
    401: Unauthorized, 403: Forbidden, 404: NotFound, 409: InUse, 410: Gone, 429: Busy, 503: Busy,
    507: Full}


def problem_of(status: int, headers: Message, body: bytes) -> Problem:
    """Returns the exception for an answer that is no success."""
    try:
        document = json.loads(body.decode("utf-8"))
    except ValueError:
        document = None
    if not isinstance(document, dict):
        document = {"title": "the daemon answered with status %d" % status}
    error = _BY_STATUS.get(status, Problem)(document, status)
    if isinstance(error, Busy):
        after = headers.get("Retry-After") or ""
        error.retry_after = int(after) if after.isdigit() else None
    return error
