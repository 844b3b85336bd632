"""Files that Radiance files and job documents refer to, found so that they are sent along."""

import os
import re
from pathlib import Path
from typing import Callable, Dict, List, Optional, Sequence, Set, Tuple

from .errors import Json, OrielError
from .files import StrPath, cannot

# Files that name no others, and may be large.
_CLOSED = (".xml", ".hdr", ".pic", ".rtm", ".png", ".tif", ".tiff", ".exr", ".epw", ".wea", ".stl",
           ".glb", ".bin", ".ies", ".fnt", ".dat", ".mtx", ".smx")
_QUOTES = "'\"(),"


def is_xml(name: str) -> bool:
    """Returns True for the name of a BSDF file."""
    return name.lower().endswith(".xml")


def library_folders() -> List[Path]:
    """Returns the folders of $RAYPATH, in which Radiance's programs look for function files and data."""
    return [Path(folder) for folder in os.environ.get("RAYPATH", "").split(os.pathsep) if folder]


def _words(path: Path) -> Set[str]:
    """Returns the words of a file that may name files: with a point or slash, or in a command."""
    found: Set[str] = set()
    try:
        with path.open("r", encoding="utf-8", errors="replace") as stream:
            for line in stream:
                bare = line.split("#")[0]
                words = (word.strip(_QUOTES) for word in bare.replace("|", " ").split())
                found.update(word for word in words
                             if "." in word or "/" in word or bare.lstrip().startswith("!"))
    except OSError as error:
        raise cannot("read", path, error) from error
    return {word for word in found if not re.fullmatch(r"[-+0-9.eE]*", word)}


def can_travel(name: str) -> bool:
    """Returns True if the daemon accepts the name: relative, and below the scene's folder."""
    return not os.path.isabs(name) and ".." not in name.split("/") and "\\" not in name and "\0" not in name


def _find(folder: Path, name: str) -> Optional[Path]:
    try:
        return next((place / name for place in [folder] + library_folders() if (place / name).is_file()), None)
    except (OSError, ValueError):  # a word that cannot be a name, such as one of 300 letters
        return None


def referenced(folder: StrPath, names: Sequence[str]) -> Dict[str, Path]:
    """Returns the files that scene files mention as words, and those that these mention, with their paths.

    They lie below the folder, or in the folders of $RAYPATH. A word that happens to name a file counts,
    too: an additional file of a scene does no harm.
    """
    top = Path(folder)
    found: Dict[str, Path] = {}
    left = [top / name for name in names]
    while left:
        path = left.pop()
        if path.suffix.lower() in _CLOSED:
            continue
        for word in sorted(_words(path) - set(names) - set(found)):
            place = _find(top, word) if can_travel(word) else None
            if place:
                found[word] = place
                left.append(place)
    return found


# Members of job documents that are names of files; and one that names Radiance files.
_FILES: Tuple[Tuple[str, ...], ...] = (
    ("weather",), ("occupancy", "file"), ("sensors", "file"), ("grids", "sensors", "file"),
    ("sky", "weather", "file"), ("skies", "weather", "file"), ("views", "file"), ("views", "glare", "mask"),
    ("shades", "schedule", "file"), ("matrices", "coefficients"), ("matrices", "view"),
    ("matrices", "transmission"), ("matrices", "daylight"), ("matrices", "sky"))
_SCENE_TEXT = ("shades", "states", "files")


def _renamed(value: Json, path: Sequence[str], rename: Callable[[str], str]) -> Json:
    """Returns a copy of the value, with the names at a path of members replaced. Lists are followed."""
    if isinstance(value, (list, tuple)):
        return [_renamed(item, path, rename) for item in value]
    if not path:
        return rename(os.fspath(value)) if isinstance(value, (str, os.PathLike)) else value
    if isinstance(value, dict) and path[0] in value:
        return dict(value, **{path[0]: _renamed(value[path[0]], path[1:], rename)})
    return value


class NamedFiles:
    """The files that a job document names beside its scene's, and the document with names that can travel.

    A file below the folder keeps its name. One elsewhere is sent by its last name. is_complete: all of
    them must exist here; otherwise the others are the daemon's.
    """

    def __init__(self, document: Dict[str, Json], folder: StrPath, is_complete: bool) -> None:
        self.paths: Dict[str, Path] = {}
        self._folder, self._is_complete = Path(folder), is_complete
        document = _renamed(document, _SCENE_TEXT, self._send)
        self.paths.update(referenced(folder, list(self.paths)))
        for path in _FILES:
            document = _renamed(document, path, self._send)
        self.document = document

    def _send(self, name: str) -> str:
        path = self._folder / os.path.expanduser(name)
        if not path.is_file():
            if self._is_complete:
                raise OrielError("cannot open %s" % path, "names are relative to the document's folder")
            return name
        sent = name if can_travel(name) else path.name
        known = self.paths.setdefault(sent, path)
        if known.resolve() != path.resolve():
            raise OrielError("two files are called %s: %s and %s" % (sent, known, path), "rename one of them")
        return sent
