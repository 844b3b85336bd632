"""Job documents: from keyword arguments, a JSON file or a Honeybee model, ready to be submitted."""

import fnmatch
import math
import os
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

from .errors import Json, OrielError
from .files import LocalFile, StrPath, read_json
from .references import NamedFiles, can_travel, is_xml, referenced
from .uploads import Scene, Uploads, is_model_file, is_scene_id, model_of

Document = Dict[str, Json]

VIEW_SIDE = 800  # pixels of a model's views, which have no size of their own, as in the oriel command


class Request:
    """What a caller asks for: a document whose scene may still be local, and the folder of its names."""

    def __init__(self, document: Document, folder: StrPath, is_filled: bool) -> None:
        self.document, self.folder = document, folder
        self.is_filled = is_filled  # a model's grids, views and shades are added where there are none


def request_of(subject: Any, kind: Optional[str], folder: Optional[StrPath], members: Mapping[str, Any]) -> Request:
    """Returns the request. subject: a document (dict or path of a JSON file), or anything Uploads.upload takes."""
    settings = {key: value for key, value in members.items() if value is not None}
    if kind:
        settings["kind"] = kind
    if isinstance(subject, Mapping) and model_of(subject) is None:
        document = dict(subject, **settings)
        return Request(document, folder or "", isinstance(document.get("scene"), dict))
    if isinstance(subject, (str, os.PathLike)) and not is_scene_id(subject):
        path = Path(subject)
        if path.suffix.lower() == ".json" and path.is_file() and not is_model_file(path):
            document = read_json(path)
            if not isinstance(document, dict):
                raise OrielError("%s is no job document" % path, "a JSON object is expected")
            return Request(dict(document, **settings), folder or path.parent, True)
    scene: Json = subject if is_scene_id(subject) else {"project": subject}
    if isinstance(scene, dict):
        if "states" in settings:
            scene["states"] = settings.pop("states")
        if isinstance(settings.get("sky"), str):
            scene["sky"] = settings.pop("sky")
    where = "measurements" if settings.get("kind") == "bsdf_fit" else "scene"
    return Request(dict(settings, **{where: scene}), folder or "", True)


def _sensor_rows(path: Path) -> Optional[List[List[float]]]:
    """Reads a sensor file; None if it is not as expected, which the daemon will say by line."""
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
        rows = [_cells(line.split("#")[0]) for line in lines]
        sensors = [[float(number) for number in row] for row in rows if row]
    except (OSError, ValueError):
        return None
    return sensors if all(len(row) == 6 and all(map(math.isfinite, row)) for row in sensors) else None


def _cells(line: str) -> List[str]:
    """Splits a line at its commas, semicolons or blanks. With a decimal comma, six numbers do not result."""
    mark = next((mark for mark in ",;" if mark in line), None)
    return line.split(mark) if mark and line.strip() else line.split()


def _inlined(value: Json, folder: StrPath) -> Json:
    """Returns sensors as rows if they are given by a file here, so that results have their positions."""
    if isinstance(value, dict) and isinstance(value.get("file"), (str, os.PathLike)):
        return _sensor_rows(Path(folder) / value["file"]) or value
    return value


def _inline_sensors(document: Document, folder: StrPath) -> Document:
    document = dict(document)
    if "sensors" in document:
        document["sensors"] = _inlined(document["sensors"], folder)
    if isinstance(document.get("grids"), list):
        document["grids"] = [dict(grid, sensors=_inlined(grid.get("sensors"), folder)) if isinstance(grid, dict)
                             else grid for grid in document["grids"]]
    return document


def prepare(uploads: Uploads, request: Request) -> Document:
    """Uploads the scene and all files that the document names. Returns the document with the scene's id."""
    document, folder = dict(request.document), request.folder
    measured, scene = document.get("measurements"), document.get("scene")
    if isinstance(measured, dict):
        document["measurements"] = _send_measurements(uploads, measured, folder)
    if document.get("kind") != "annual":
        document = _inline_sensors(document, folder)
    if isinstance(scene, dict) and "project" in scene:
        stored, document = _send_project(uploads, scene, document, folder)
    elif isinstance(scene, dict) and "files" in scene:
        stored, document = _send_files(uploads, scene["files"], document, folder)
    elif isinstance(scene, Scene):
        stored = scene
        if document.get("kind") == "annual" and scene.weather:
            document.setdefault("weather", scene.weather)
    else:
        return document
    document["scene"] = str(stored)
    return fill(document, stored, scene) if request.is_filled and not _is_list_of_files(scene) else document


def _is_list_of_files(scene: Json) -> bool:
    return isinstance(scene, dict) and "project" not in scene


def _send_measurements(uploads: Uploads, measured: Document, folder: StrPath) -> str:
    files = measured["files"] if "files" in measured else measured["project"]
    names = [files] if isinstance(files, (str, os.PathLike)) else list(files)
    return str(uploads.upload_scene([os.fspath(name) for name in names], [], folder))


def _send_files(uploads: Uploads, files: Sequence[str], document: Document, folder: StrPath,
                top: Optional[Path] = None) -> Tuple[Scene, Document]:
    """Uploads Radiance files below top, by default the folder in which the document's names are."""
    named, place = NamedFiles(document, folder, is_complete=True), top or folder
    others = referenced(place, files)
    others.update(named.paths)
    others.update((name, Path(place) / name) for name in files if is_xml(name))
    mains = [LocalFile(place, name) for name in files if not is_xml(name)]
    contents = [LocalFile("", str(path), name) for name, path in others.items() if name not in files or is_xml(name)]
    return uploads.send_scene(mains, contents), named.document


def _send_project(uploads: Uploads, scene: Document, document: Document,
                  folder: StrPath) -> Tuple[Scene, Document]:
    what, files = scene["project"], [str(name) for name in scene.get("files", ())]
    if isinstance(what, (str, os.PathLike)):
        what = Path(folder) / what
    is_file = isinstance(what, Path) and what.is_file() and what.suffix.lower() not in (".zip", ".json", ".hbjson")
    if is_file or isinstance(what, (list, tuple)):
        if scene.get("sky") or scene.get("states"):
            raise OrielError("states, and a sky by its name, are for Honeybee models and folders",
                             "give sky= as in a job document")
        if is_file:
            return _send_files(uploads, [what.name], document, folder, what.parent)
        return _send_files(uploads, [os.fspath(name) for name in what], document, folder)
    named = NamedFiles(document, folder, is_complete=False)
    paths = dict(named.paths, **{name: Path(folder) / name for name in files if can_travel(name)})
    stored = _upload_with(uploads, what, paths, scene, None)
    if files:  # the scene's own files come after the project's
        project = stored.project
        stored = _upload_with(uploads, what, paths, scene, list(stored.summary["main"]) + files)
        stored.summary["project"] = project
    return stored, named.document


def _upload_with(uploads: Uploads, what: Any, paths: Mapping[str, Path], scene: Document,
                 mains: Optional[List[str]]) -> Scene:
    extra = [LocalFile("", str(path), name) for name, path in paths.items()]
    return uploads.upload_contents(what, extra, mains, scene.get("states"), scene.get("sky"))


# ---- A model's contents ------------------------------------------------------------------------

def _chosen_grids(asked: Json, grids: List[Document]) -> Json:
    """Returns the model's grids of these names or patterns such as "room_*"; other grids as they are."""
    if not isinstance(asked, (list, tuple)) or not all(isinstance(one, str) for one in asked):
        return asked
    for pattern in asked:
        if not fnmatch.filter([grid["name"] for grid in grids], pattern):
            raise OrielError("the scene has no grid %r" % pattern,
                             "it has " + (", ".join(grid["name"] for grid in grids) or "none"))
    return [grid for grid in grids if any(fnmatch.fnmatchcase(grid["name"], pattern) for pattern in asked)]


def _sized(view: Document) -> Document:
    """Returns a model's view with the size that it is rendered at."""
    if "width" not in view:
        return dict(view, width=VIEW_SIDE, height=VIEW_SIDE, pixel_aspect=1)
    view = dict({"pixel_aspect": 1}, **view)
    if not view["pixel_aspect"]:
        del view["pixel_aspect"]
    return view


def _asks_for_blinds(document: Document) -> bool:
    """Returns True for sDA or LEED, which are defined for blinds drawn by LM-83's rule."""
    words = [("LEED", one) for one in document.get("rules") or ()]
    words += [("sDA", one) for key in ("targets", "metrics") for one in document.get(key) or ()]
    words.append(("sDA", (document.get("accuracy") or {}).get("verdict", "")))
    return any(str(text).lower().startswith(word.lower()) for word, text in words)


def _fill_shades(document: Document, states: Mapping[str, Document], chosen: Mapping[str, str]) -> None:
    """Adds a model's dynamic groups as shades of a year, unless a state was chosen for them.

    They stay in their first state; windows are closed by LM-83's rule where the document asks for sDA or LEED.
    """
    shades = [dict(one) for one in document.get("shades") or ()]
    for name, group in states.items():
        if len(group["of"]) < 2 or name in chosen:
            continue
        all_states = [{"name": state, "files": [file]} for state, file in zip(group["of"], group["files"])]
        own = next((shade for shade in shades if shade.get("name") == name), None)
        if own is not None:
            own.setdefault("states", all_states)
            continue
        shade: Document = {"name": name, "states": all_states}
        if _asks_for_blinds(document) and "aperture_group/" in group["files"][0]:
            shade["control"] = {"by": "LM-83"}
        shades.append(shade)
    if shades:
        document["shades"] = shades


def fill(document: Document, stored: Scene, scene: Json) -> Document:
    """Adds a model's grids, views and shades where the document has none."""
    kind, project = document.get("kind", "render"), stored.project
    grids = project.get("grids", [])
    if "grids" in document:
        document["grids"] = _chosen_grids(document["grids"], grids)
    if not project or kind not in ("render", "annual", "study"):
        return document
    if "grids" not in document and "sensors" not in document and grids:
        document["grids"] = grids
    if kind == "render" and "views" not in document:
        document["views"] = [_sized(view) for view in project.get("views", [])]
    if kind == "annual":
        chosen = scene.chosen if isinstance(scene, Scene) else scene.get("states") or {}
        _fill_shades(document, project.get("states", {}), chosen)
    if kind == "render" and not any(document.get(key) for key in ("sensors", "grids", "views")):
        raise OrielError("the model has no sensor grids and no views", "add some to it, or give grids= or views=")
    if kind == "annual" and not any(document.get(key) for key in ("sensors", "grids", "glare", "exposure", "view_out")):
        raise OrielError("the model has no sensor grids, which a year needs", "add some to it, or give grids=")
    return document
