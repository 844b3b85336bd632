"""Oriel from Python: daylight simulation by a daemon, for design tools.

The package needs Python 3.8 or later and its standard library; results are numpy arrays if numpy is
installed. A LEED verdict from a Honeybee model:

    import oriel

    client = oriel.Client()                                   # or a URL, or $ORIEL_URL
    result = client.annual("office.hbjson", weather="place.epw", rules=["LEED"])
    for verdict in result.verdicts("LEED"):
        print(verdict)

Client has a method for each kind of job: render, annual, glare, study, make_bsdf, fit_bsdf and plan.
`submit` returns a Job at once, with wait, cancel and fetch. A Result is result.json as a dict, with
tables, arrays and verdicts by the names of grids.

All errors are OrielErrors: Problem if the daemon refuses a request (with title, detail, hint, file
and line), Unreachable if it does not answer, JobFailed and JobCancelled if a job ends that way. Files
that the daemon already has are not sent again. A submission that is repeated after a broken
connection creates no second job.
"""

from .client import Client
from .errors import (Busy, Forbidden, Full, Gone, InUse, JobCancelled, JobFailed, NotFound, OrielError, Problem,
                     SettingsError, Unauthorized, Unreachable)
from .jobs import Job
from .results import Result, Table, Verdict, load_result
from .uploads import Scene
from .version import __version__

__all__ = ["Client", "Job", "Result", "Scene", "Table", "Verdict", "load_result", "OrielError", "Problem",
           "Unauthorized", "Forbidden", "NotFound", "InUse", "Gone", "Busy", "Full", "Unreachable",
           "JobFailed", "JobCancelled", "SettingsError", "__version__"]
