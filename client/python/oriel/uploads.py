"""Uploads: scenes, Honeybee models, folders, zips and BSDFs. Files that the daemon has are not sent again."""

import hashlib
import json
import os
import re
import urllib.parse
from pathlib import Path
from typing import Any, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple, Union

from .errors import Json, OrielError
from .files import Content, Form, LocalFile, Stored, StrPath, Text, read_json, zipped
from .references import is_xml, referenced
from .transport import Transport

Model = Union[StrPath, Mapping[str, Any], Any]  # a path, a dict, or an object with to_dict()


class Scene(str):
    """The id of a stored scene, as a str, with what the daemon knows of it.

    weather: name of the weather file that was uploaded with it, or None. chosen: states of a model's
    groups that were chosen at the upload.
    """

    weather: Optional[str] = None
    chosen: Mapping[str, str] = {}
    _transport: Transport
    _summary: Optional[Dict[str, Json]] = None

    @classmethod
    def of(cls, transport: Transport, id: str, summary: Optional[Dict[str, Json]] = None) -> "Scene":
        """Returns the scene with that id."""
        scene = cls(id)
        scene._transport, scene._summary = transport, summary
        return scene

    @property
    def summary(self) -> Dict[str, Json]:
        """The daemon's summary: surfaces, bounds, main files, `project` of a Honeybee model, and others."""
        if self._summary is None:
            self._summary = dict(self._transport.json("GET", "/v1/scenes/" + str(self))["summary"])
        return self._summary

    @property
    def project(self) -> Dict[str, Json]:
        """Grids, views, states and skies of a Honeybee model or folder; empty for other scenes."""
        return dict(self.summary.get("project") or {})

    @property
    def grids(self) -> List[str]:
        """Names of a model's sensor grids."""
        return [grid["name"] for grid in self.project.get("grids", [])]

    @property
    def views(self) -> List[str]:
        """Names of a model's views."""
        return [view["name"] for view in self.project.get("views", [])]

    @property
    def states(self) -> Dict[str, List[str]]:
        """States of each dynamic group of a model, by the group's name."""
        return {name: list(group["of"]) for name, group in self.project.get("states", {}).items()}


def scene_id(mains: Sequence[Content], resources: Iterable[Content]) -> str:
    """Computes a scene's id as the daemon does (POST /v1/scenes)."""
    text = "oriel-scene 1\n"
    for file in mains:
        text += "main %s %s\n" % (file.sha, file.name)
    for file in sorted(resources, key=lambda one: one.name.encode("utf-8")):
        text += "resource %s %s\n" % (file.sha, file.name)
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def is_scene_id(value: object) -> bool:
    """Returns True for a Scene, or for text that can only be a scene's id."""
    return isinstance(value, Scene) or (isinstance(value, str) and bool(re.fullmatch("[0-9a-f]{64}", value)))


def model_of(value: Model) -> Optional[Dict[str, Json]]:
    """Returns the dict of a Honeybee model that is given as a dict or an object, or None."""
    if not isinstance(value, (str, Mapping)) and hasattr(value, "to_dict"):
        value = value.to_dict()
    return dict(value) if isinstance(value, Mapping) and value.get("type") == "Model" else None


def is_model_file(path: Path) -> bool:
    """Returns True for a file with a Honeybee model, which may be called .json."""
    if path.suffix.lower() == ".hbjson":
        return True
    if path.suffix.lower() != ".json":
        return False
    document = read_json(path)
    return isinstance(document, dict) and document.get("type") == "Model"


class Uploads:
    """The part of a Client that uploads."""

    _transport: Transport
    _known: Dict[str, str]  # ids of scenes that the daemon has made of models, folders and zips

    def upload(self, what: Union[Model, Sequence[StrPath]], *, weather: Optional[StrPath] = None,
               files: Optional[Sequence[str]] = None, resources: Sequence[StrPath] = (),
               states: Optional[Mapping[str, str]] = None, sky: Optional[str] = None) -> Scene:
        """Uploads anything a job can be made of, unless the daemon has it. Returns the Scene.

        what: a Honeybee model (path, dict or object), a folder, a zip, a Radiance file or a list of
        Radiance files, or a list of goniophotometer measurements. A BSDF XML gives a BSDF's id.
        weather: an EPW or WEA file to store with the scene. resources: more such files.
        files: names of a folder's or zip's main files, in order; by default the daemon finds them.
        states, sky: for a Honeybee model or folder: {group: state}, and one of its skies.
        """
        extra = [LocalFile("", str(path), Path(path).name)
                 for path in ([weather] if weather else []) + list(resources)]
        scene = self.upload_contents(what, extra, files, states, sky)
        scene.weather = Path(weather).name if weather else None
        scene.chosen = dict(states or {})
        return scene

    def upload_contents(self, what: Union[Model, Sequence[StrPath]], extra: Sequence[Content],
                        files: Optional[Sequence[str]] = None, states: Optional[Mapping[str, str]] = None,
                        sky: Optional[str] = None) -> Scene:
        """Does the same with more files that are open already, under names of their own."""
        if isinstance(what, (list, tuple)):
            return self._upload_files([str(name) for name in what], "", extra)
        return self._upload_one(what, extra, _query(files, states, sky))

    def _upload_one(self, what: Model, extra: Sequence[Content], query: str) -> Scene:
        model = model_of(what)
        if model is not None:
            return self._upload_project(Text("model.hbjson", json.dumps(model).encode("utf-8")), extra, query)
        if not isinstance(what, (str, os.PathLike)):
            raise OrielError("%r is no model, and no path" % type(what).__name__)
        path = Path(what)
        if path.is_dir():
            with zipped(path, extra) as archive:
                return self._upload_project(LocalFile("", str(archive), "folder.zip"), [], query)
        if path.suffix.lower() == ".zip" or is_model_file(path):
            return self._upload_project(LocalFile("", str(path), path.name), extra, query)
        if is_xml(path.name):
            return Scene.of(self._transport, self.upload_bsdf(path))
        _refuse(path)
        if query:
            raise OrielError("states and sky are for Honeybee models and folders")
        return self._upload_files([path.name], path.parent, extra)

    def _upload_files(self, names: Sequence[str], folder: StrPath, extra: Sequence[Content]) -> Scene:
        found = [LocalFile("", str(path), name) for name, path in referenced(folder, names).items()]
        mains = [LocalFile(folder, name) for name in names if not is_xml(name)]
        xmls = [LocalFile(folder, name) for name in names if is_xml(name)]
        others = {file.name: file for file in found + xmls}
        others.update((file.name, file) for file in extra)  # type: ignore[misc]
        return self.send_scene(mains, list(others.values()))

    def upload_bsdf(self, path: StrPath, name: Optional[str] = None) -> str:
        """Uploads a BSDF (WINDOW XML) unless the daemon has it. Returns its id."""
        file = LocalFile("", str(path))
        if not self._transport.has("/v1/bsdfs/" + file.sha):
            query = urllib.parse.urlencode({"name": name or Path(path).name})
            self._transport.json("POST", "/v1/bsdfs?" + query, file.chunks,
                                 {"Content-Type": "application/xml", "Content-Length": str(file.size)})
        return file.sha

    def upload_scene(self, files: Sequence[str], resources: Optional[Iterable[str]] = None,
                     folder: Optional[StrPath] = None, bsdfs: Optional[Mapping[str, str]] = None) -> Scene:
        """Uploads a scene of Radiance files unless the daemon has it. Returns the Scene.

        files: Radiance files, in order.
        resources: files that these refer to (BSDFs, files of !xform, function files, weather), or
        None: every file below the folder, or in $RAYPATH, that they mention. Names are relative to
        folder (default: the current folder), and are the names in the scene.
        bsdfs: {name: id} of BSDFs that the daemon has, such as results of make_bsdf and fit_bsdf.
        Files of goniophotometer measurements are uploaded in the same way.
        """
        place, known = folder or "", dict(bsdfs or {})
        paths = (referenced(place, files) if resources is None
                 else {name: Path(place) / name for name in resources})
        paths.update((name, Path(place) / name) for name in files if is_xml(name))
        mains = [LocalFile(place, name) for name in files if not is_xml(name)]
        others: List[Content] = [LocalFile("", str(path), name.replace("\\", "/"))
                                 for name, path in paths.items() if name not in known]
        return self.send_scene(mains, others + [Stored(name, id) for name, id in known.items()])

    def upload_zip(self, path: StrPath, files: Optional[Sequence[str]] = None) -> Scene:
        """Uploads a zip of a scene's folder, which the daemon unpacks. Returns the Scene.

        files: the main Radiance files, in order, with their names in the folder; or None: the
        top-level files that no command of another file names, sorted by name.
        """
        return self.upload(path, files=files)

    def send_scene(self, mains: Sequence[Content], others: Sequence[Content]) -> Scene:
        """Uploads a scene of these files unless the daemon has it."""
        id = scene_id(mains, others)
        if self._transport.has("/v1/scenes/" + id):
            return Scene.of(self._transport, id)
        form, known = Form(), {}
        for file in mains:
            form.add_file("file", file)
        for file in others:
            if isinstance(file, Stored) or (is_xml(file.name) and self._transport.has("/v1/bsdfs/" + file.sha)):
                known[file.name] = file.sha
            else:
                form.add_file("resource", file)
        if known:
            form.add_text("bsdfs", json.dumps(known))
        return self._post_form(form, "")

    def _upload_project(self, file: Content, extra: Sequence[Content], query: str) -> Scene:
        """Uploads a model or zip, whose scene's id only the daemon can find; it is remembered here."""
        contents = [(one.name, one.sha) for one in [file, *extra]]
        key = json.dumps([contents, query])
        id = self._known.get(key)
        if id and self._transport.has("/v1/scenes/" + id):
            return Scene.of(self._transport, id)
        form = Form()
        form.add_file("file", file)
        for one in extra:
            form.add_file("resource", one)
        scene = self._post_form(form, query)
        self._known[key] = str(scene)
        return scene

    def _post_form(self, form: Form, query: str) -> Scene:
        path = "/v1/scenes" + ("?" + query if query else "")
        reply = self._transport.json("POST", path, form.chunks, form.headers())
        return Scene.of(self._transport, reply["id"], reply["summary"])


def _query(files: Optional[Sequence[str]], states: Optional[Mapping[str, str]], sky: Optional[str]) -> str:
    parts: List[Tuple[str, str]] = [("main", name) for name in files or ()]
    parts += [("state", "%s=%s" % item) for item in (states or {}).items()]
    return urllib.parse.urlencode(parts + ([("sky", sky)] if sky else []))


def _refuse(path: Path) -> None:
    """Refuses files that are no scene by themselves."""
    suffix = path.suffix.lower()
    if not path.is_file():
        raise OrielError("there is no file or folder %s" % path)
    if suffix in (".epw", ".wea"):
        raise OrielError("%s: a weather file is uploaded with a scene" % path, "give it as weather=")
    if suffix == ".json":
        raise OrielError("%s is a job document, and no model" % path, "submit it")
