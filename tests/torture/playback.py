"""What a recorded folder (recorder.c) holds after a power cut.

A Disk is what the program saw, and beside it what is safe: of a file its bytes at the last sync, of
a folder its entries at the last sync of the folder. cut() writes one of the folders that a cut may
leave: nothing that was not synced, or some of it.
"""

import json
import os


class _File:
    def __init__(self):
        self.safe, self.writes = b"", []  # bytes when last synced; what was written since

    def bytes(self, chance):
        """With chance, some of the writes since the last sync, whole or torn at a sector."""
        kept = bytearray(self.safe)
        for at, data in self.writes if chance else ():
            fate = chance.random()
            if fate < 0.4:
                continue
            if fate > 0.8:
                data = data[:512 * chance.randrange(1 + len(data) // 512)]
            if len(kept) < at:
                kept.extend(bytes(at - len(kept)))
            kept[at:at + len(data)] = data
        return bytes(kept)


class _Folder:
    def __init__(self):
        self.seen, self.safe = {}, {}


class Disk:
    def __init__(self):
        self.top = _Folder()

    def _folder(self, path):
        folder = self.top
        for part in [part for part in path.split("/") if part]:
            folder = folder.seen[part]
        return folder

    def _split(self, path):
        above, _, name = path.rstrip("/").rpartition("/")
        return self._folder(above), name

    def play(self, act, data):
        """data: the open file with what was written."""
        kind, path = act["a"], act["p"]
        if kind == "folder":
            self._sync_folder(self._folder(path))
            return
        folder, name = self._split(path)
        if kind == "create":
            folder.seen[name] = _File()
        elif kind == "mkdir":
            folder.seen[name] = _Folder()
        elif kind in ("unlink", "rmdir"):
            del folder.seen[name]
        elif kind == "rename":
            target, new_name = self._split(act["q"])
            target.seen[new_name] = folder.seen.pop(name)
        else:
            file = folder.seen.setdefault(name, _File())
            data.seek(act["at"])
            bytes_of = data.read(act["n"])
            if kind == "file":
                file.safe, file.writes = bytes_of, []
            else:
                file.writes.append((act["to"], bytes_of))

    def _sync_folder(self, folder):
        """A rename is one act: what has come from elsewhere is safe here, and there no more."""
        new = [item for name, item in folder.seen.items() if folder.safe.get(name) is not item]
        for other in self._folders(self.top) if new else ():
            if other is not folder:
                for name in [name for name, item in other.safe.items() if item in new]:
                    if other.seen.get(name) is not other.safe[name]:
                        del other.safe[name]
        folder.safe = dict(folder.seen)

    def _folders(self, folder):
        yield folder
        for item in {id(item): item for item in
                     list(folder.seen.values()) + list(folder.safe.values())}.values():
            if isinstance(item, _Folder):
                yield from self._folders(item)

    def cut(self, root, chance=None, all_names=False):
        """all_names: the file system wrote names in order, as journals do, and no data unasked."""
        self._write(self.top, root, chance, all_names)

    def _write(self, folder, path, chance, all_names):
        os.makedirs(path, mode=0o700, exist_ok=True)
        for name, item in (folder.seen if all_names else folder.safe).items():
            below = os.path.join(path, name)
            if isinstance(item, _Folder):
                self._write(item, below, chance, all_names)
            else:
                # As the daemon makes them: what is secret would be refused if others could read it.
                with open(os.open(below, os.O_CREAT | os.O_WRONLY | os.O_TRUNC, 0o600), "wb") as stream:
                    stream.write(item.bytes(chance))


def read_acts(path):
    """The acts, with where each ends in the recording: what clients saw is told by that."""
    acts, end = [], 0
    with open(path, "rb") as stream:
        for line in stream:
            end += len(line)
            if line.endswith(b"\n"):
                acts.append((end, json.loads(line)))
    return acts
