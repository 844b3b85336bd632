"""Files to send: their digests, forms, and zips of folders."""

import contextlib
import hashlib
import json
import os
import tempfile
import uuid
import zipfile
from pathlib import Path
from typing import Callable, Dict, Iterable, Iterator, List, Optional, Sequence, Tuple, Union

from .errors import Json, OrielError

StrPath = Union[str, "os.PathLike[str]"]

CHUNK = 1 << 16
# Files that systems leave in folders, and that the daemon would leave out.
_LEFT_OUT = ("__MACOSX", "Thumbs.db", "desktop.ini")


def cannot(what: str, path: StrPath, error: OSError) -> OrielError:
    """Returns the exception for an error of a file."""
    return OrielError("cannot %s %s: %s" % (what, os.fspath(path), error.strerror or error))


def read_json(path: StrPath) -> Json:
    """Reads a JSON file."""
    try:
        return json.loads(Path(path).read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise cannot("read", path, error) from error
    except ValueError as error:
        raise OrielError("%s is not JSON: %s" % (os.fspath(path), error)) from error


def make_folder(path: Path) -> None:
    """Creates a folder unless it exists."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise cannot("make", path, error) from error


@contextlib.contextmanager
def writing(path: Path) -> Iterator[Callable[[bytes], None]]:
    """Gives a function that writes to the file. Its errors are distinct from network errors."""
    def write(chunk: bytes) -> None:
        try:
            stream.write(chunk)
        except OSError as error:
            raise cannot("write", path, error) from error

    try:
        stream = path.open("wb")
    except OSError as error:
        raise cannot("open", path, error) from error
    with stream:
        yield write


class Content:
    """Bytes to send: their name in the scene, size and SHA-256."""

    name: str
    size: int
    sha: str

    def chunks(self) -> Iterable[bytes]:
        """Yields the bytes. May be called again."""
        raise NotImplementedError


class LocalFile(Content):
    """A file of this machine."""

    def __init__(self, folder: StrPath, name: str, named: Optional[str] = None) -> None:
        self.name = named or name.replace(os.sep, "/")
        self.path = Path(folder) / name
        digest = hashlib.sha256()
        self.size = 0
        for chunk in self.chunks():
            digest.update(chunk)
            self.size += len(chunk)
        self.sha = digest.hexdigest()

    def chunks(self) -> Iterator[bytes]:
        try:
            with self.path.open("rb") as stream:
                yield from iter(lambda: stream.read(CHUNK), b"")
        except OSError as error:
            raise cannot("read", self.path, error) from error


class Text(Content):
    """A file that exists in memory only."""

    def __init__(self, name: str, data: bytes) -> None:
        self.name, self._data, self.size = name, data, len(data)
        self.sha = hashlib.sha256(data).hexdigest()

    def chunks(self) -> Iterator[bytes]:
        yield self._data


class Stored(Content):
    """A BSDF that the daemon stores, with its file name in the scene."""

    def __init__(self, name: str, sha: str) -> None:
        self.name, self.sha, self.size = name, sha, 0


class Form:
    """multipart/form-data, streamed from disk."""

    def __init__(self) -> None:
        self.boundary = uuid.uuid4().hex
        self._parts: List[Tuple[bytes, Content]] = []

    def add_file(self, field: str, file: Content) -> None:
        """Adds a file to the form."""
        if any(c in '"\\' or ord(c) < 32 for c in file.name):
            raise OrielError("a file named %r cannot be sent" % file.name, "rename it")
        self._add('name="%s"; filename="%s"' % (field, file.name), file)

    def add_text(self, field: str, text: str) -> None:
        """Adds a field to the form."""
        self._add('name="%s"' % field, Text(field, text.encode("utf-8")))

    def _add(self, disposition: str, content: Content) -> None:
        head = "--%s\r\nContent-Disposition: form-data; %s\r\n\r\n" % (self.boundary, disposition)
        self._parts.append((head.encode("utf-8"), content))

    def _end(self) -> bytes:
        return ("--%s--\r\n" % self.boundary).encode("ascii")

    def headers(self) -> Dict[str, str]:
        """Returns the headers of a request with this form."""
        size = sum(len(head) + 2 + content.size for head, content in self._parts) + len(self._end())
        return {"Content-Type": "multipart/form-data; boundary=" + self.boundary, "Content-Length": str(size)}

    def chunks(self) -> Iterator[bytes]:
        """Yields the bytes of the form."""
        for head, content in self._parts:
            yield head
            yield from content.chunks()
            yield b"\r\n"
        yield self._end()


def files_below(folder: StrPath) -> List[str]:
    """Returns the names of all files below a folder, with slashes, sorted. Hidden ones are left out."""
    top, found = Path(folder), []
    for place, folders, names in os.walk(str(top)):
        folders[:] = [one for one in folders if not one.startswith(".") and one not in _LEFT_OUT]
        found += [(Path(place) / name).relative_to(top).as_posix() for name in names
                  if not name.startswith(".") and name not in _LEFT_OUT]
    return sorted(found)


@contextlib.contextmanager
def zipped(folder: StrPath, extra: Sequence[Content]) -> Iterator[Path]:
    """Gives the path of a temporary zip of a folder, with more files at its top.

    Zips of the same files have the same bytes: entries are sorted and have no dates.
    """
    top = Path(folder)
    # Honeybee's folder "model", by itself: its files name one another by "model/...".
    is_model = (top / "scene").is_dir() and not any(top.glob("*.rad")) and not (top / "model").is_dir()
    entries = [(("model/" if is_model else "") + name, top / name) for name in files_below(folder)]
    if not entries:
        raise OrielError("%s has no files" % os.fspath(folder))
    own = {one.name for one in extra}
    handle, path = tempfile.mkstemp(suffix=".zip")
    try:
        with os.fdopen(handle, "wb") as stream, zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, source in entries:
                if name not in own:
                    _add_entry(archive, name, LocalFile("", str(source), name))
            for content in extra:
                _add_entry(archive, content.name, content)
        yield Path(path)
    finally:
        os.unlink(path)


def _add_entry(archive: zipfile.ZipFile, name: str, content: Content) -> None:
    info = zipfile.ZipInfo(name)
    info.compress_type = zipfile.ZIP_DEFLATED
    info.external_attr = 0o644 << 16
    info.file_size = content.size
    with archive.open(info, "w") as entry:
        for chunk in content.chunks():
            entry.write(chunk)
