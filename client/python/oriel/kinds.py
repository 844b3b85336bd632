"""Jobs of every kind, from keyword arguments, documents or Honeybee models."""

import uuid
from typing import Any, Dict, List, Mapping, Optional, Sequence

from .documents import VIEW_SIDE, Document, prepare, request_of
from .errors import Json, OrielError
from .files import StrPath
from .jobs import Job, Progress, submit
from .results import Result
from .uploads import Scene, Uploads, is_scene_id

Members = Any  # members of a job document, as openapi.yaml describes them

_FISHEYE = "-vta -vh 180 -vv 180"


def _numbers(values: Sequence[float]) -> str:
    return " ".join("%.9g" % value for value in values)


def _view_of_seat(seat: Mapping[str, Any], number: int) -> Document:
    """Returns the fisheye view of somebody who sits somewhere."""
    x, y, z = seat["towards"]
    up = "-vu 0 0 1" if x or y else "-vu 0 1 0"
    view = "-vta -vp %s -vd %s %s -vh 180 -vv 180" % (_numbers(seat["at"]), _numbers((x, y, z)), up)
    return {"name": seat.get("name", "seat%d" % number), "view": view}


class Kinds:
    """The part of a Client that plans, submits and runs jobs.

    Each method takes as its subject

    - a Honeybee model: a path, a dict, or an object with to_dict(); or the folder that Honeybee exports;
    - Radiance files: a list, a file, a folder or a zip; or a Scene, or its id, from `upload`;
    - a job document: a dict, or the path of a JSON file. Its names are relative to the file's folder.

    Further keyword arguments are members of the job document (openapi.yaml): weather, rules, sky, views,
    samples and so on. Files among them are sent along. Of a model, grids and views are used unless
    others are given; `grids` may be names or patterns of them; `states` is {group: state}; `sky` may
    be the name of one of its skies.
    """

    uploads: Uploads

    def document(self, subject: Any, kind: Optional[str] = None, folder: Optional[StrPath] = None,
                 **members: Members) -> Document:
        """Uploads what is needed, and returns the document that `submit` would send."""
        return prepare(self.uploads, request_of(subject, kind, folder, members))

    def submit(self, subject: Any, name: Optional[str] = None, tags: Optional[Sequence[str]] = None,
               kind: Optional[str] = None, folder: Optional[StrPath] = None, **members: Members) -> Job:
        """Submits a job of any kind. Returns the Job, which is queued.

        name, tags: name of the job, and list of tags to find it by (see jobs). folder: folder of the
        names in a document; by default the document's own, or the current folder.
        After a broken connection it tries again. The daemon recognises the submission by its key.
        """
        document = self.document(subject, kind, folder, name=name, tags=list(tags) if tags else None, **members)
        return submit(self.uploads._transport, document, uuid.uuid4().hex, self)

    def run(self, subject: Any, output: Optional[StrPath] = None, progress: Optional[Progress] = None,
            timeout: Optional[float] = None, **members: Members) -> Result:
        """Submits a job, waits for it (see Job.wait), and returns its result. Ctrl-C cancels the job.

        output: folder into which all result files are downloaded, or None. All other arguments are
        those of `submit`.
        """
        job = self.submit(subject, **members)
        job.wait(progress, timeout, cancel_on_interrupt=True)
        if output is not None:
            job.fetch(output)
        return job.result()

    def render(self, document: Any, output: Optional[StrPath] = None, folder: Optional[StrPath] = None,
               progress: Optional[Progress] = None, **members: Members) -> Result:
        """Illuminances and pictures at one moment or several (`sky`, `skies`). Or any document, by its kind."""
        return self.run(document, output, progress, folder=folder, **members)

    def annual(self, subject: Any, output: Optional[StrPath] = None, progress: Optional[Progress] = None,
               **members: Members) -> Result:
        """A year of daylight: `weather`, `rules`, `targets`, `metrics`, `shades`, `formats` and others."""
        return self.run(subject, output, progress, kind="annual", **members)

    def glare(self, subject: Any, seats: Optional[Sequence[Mapping[str, Any]]] = None,
              output: Optional[StrPath] = None, progress: Optional[Progress] = None, **members: Members) -> Result:
        """Glare at one moment (`sky`), or in every hour of a year (`weather`).

        seats: [{"name", "at": [x, y, z], "towards": [x, y, z]}]. At one moment, views may be given
        instead; by default they are the model's views, as fisheyes. See Result.glare.
        """
        if "weather" in members:
            if not seats:
                raise OrielError("the glare of a year needs seats", "give seats=[{'at': ..., 'towards': ...}]")
            return self.run(subject, output, progress, kind="annual", glare={"seats": list(seats)}, **members)
        views = members.pop("views", None)
        if seats:
            views = [_view_of_seat(seat, number) for number, seat in enumerate(seats, 1)]
        elif views is None:
            views = self._fisheyes(subject)
        views = [dict({"width": VIEW_SIDE, "height": VIEW_SIDE, "metrics": ["dgp"]}, **view) for view in views]
        return self.run(subject, output, progress, views=views, **members)

    def _fisheyes(self, subject: Any) -> List[Document]:
        """Returns a model's views, turned into fisheyes of the hemisphere."""
        stored = Scene.of(self.uploads._transport, subject) if is_scene_id(subject) else None
        views = (stored or self.uploads.upload(subject)).project.get("views", [])
        if not views:
            raise OrielError("there is no view", "give seats= or views=")
        return [dict(view, view=_FISHEYE) for view in views]

    def study(self, subject: Any, output: Optional[StrPath] = None, progress: Optional[Progress] = None,
              **members: Members) -> Result:
        """Error against time: `techniques`, `photons`, `gather_samples`, `reference` and others."""
        return self.run(subject, output, progress, kind="study", **members)

    def make_bsdf(self, subject: Any, output: Optional[StrPath] = None, progress: Optional[Progress] = None,
                  **members: Members) -> Result:
        """The BSDF of a panel made of geometry: `basis`, `cell`, `accuracy` and others.

        Its id is result["bsdf"]["id"], for the `bsdfs` of upload_scene.
        """
        return self.run(subject, output, progress, kind="bsdf_make", **members)

    def fit_bsdf(self, subject: Any, output: Optional[StrPath] = None, progress: Optional[Progress] = None,
                 **members: Members) -> Result:
        """A BSDF from files of goniophotometer measurements: `basis`, `symmetry` and others."""
        return self.run(subject, output, progress, kind="bsdf_fit", **members)

    def plan(self, subject: Any, folder: Optional[StrPath] = None, **members: Members) -> List[Dict[str, Json]]:
        """Returns which effects a render job would simulate, and why, without rendering it.

        Returns a list of {"sky", "plan", "warnings", "curve"}: one item, or for a job with several
        skies one for each of the first skies.
        """
        document = self.document(subject, None, folder, **members)
        return list(self.uploads._transport.post_json("/v1/plans", document)["plans"])
