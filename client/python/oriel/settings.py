"""The user's settings: servers and access tokens in oriel.toml, as the oriel command reads them.

The file is $XDG_CONFIG_HOME/oriel.toml, or else ~/.config/oriel.toml, and may be absent:

    server = "https://oriel.example.org"      # or the name of a table below
    token_file = "~/.config/oriel.token"

    [servers.office]
    url = "http://127.0.0.1:8423"
    token_file = "office.token"               # relative to the folder of oriel.toml

The syntax is a subset of TOML 1.0: comments, tables with bare keys, and strings of one line, basic
("...") with the escapes \\" \\\\ \\t, or literal ('...'). Everything else is refused with its line.

A server is chosen by the argument, then $ORIEL_URL, then the file's "server", then the loopback
default. $ORIEL_TOKEN overrides every token_file. A token is sent only to the server beside which the
file names it.
"""

import os
import re
import stat
import warnings
from pathlib import Path
from typing import Dict, NamedTuple, Optional

from .errors import SettingsError

DEFAULT_URL = "http://127.0.0.1:8423"

_TABLE = re.compile(r"\[[ \t]*servers[ \t]*\.[ \t]*([A-Za-z0-9_-]+)[ \t]*\][ \t]*(#.*)?$")
_MEMBER = re.compile(r"([A-Za-z0-9_-]+)[ \t]*=[ \t]*(.*)$")
_STRING = re.compile(r"""(?:"((?:[^"\\\x00-\x08\x0a-\x1f]|\\["\\t])+)"|'([^'\x00-\x08\x0a-\x1f]+)')[ \t]*(#.*)?$""")
_ESCAPES = {'\\"': '"', "\\\\": "\\", "\\t": "\t"}


class Server(NamedTuple):
    """A daemon's URL, and the token for it or None."""

    url: str
    token: Optional[str]


class Settings:
    """Contents of oriel.toml. tables[""] has the members at the top of the file."""

    def __init__(self, path: Path, text: str = "") -> None:
        self.path = path
        self.tables: Dict[str, Dict[str, str]] = {"": {}}
        self._table = ""
        for number, line in enumerate(text.split("\n"), 1):
            self._read_line(number, line.strip(" \t\r"))
        for name, table in self.tables.items():
            if name and "url" not in table:
                raise SettingsError('%s: the server "%s" has no "url"' % (path, name))

    def _fail(self, number: int, what: str, hint: Optional[str] = None) -> SettingsError:
        return SettingsError("%s:%d: %s" % (self.path, number, what), hint)

    def _read_line(self, number: int, line: str) -> None:
        if not line or line.startswith("#"):
            return
        if line.startswith("["):
            self._open_table(number, line)
            return
        member = _MEMBER.match(line)
        if not member:
            raise self._fail(number, 'KEY = "TEXT" or [servers.NAME] is expected')
        key, value = member.groups()
        known = ("url" if self._table else "server", "token_file")
        if key not in known:
            raise self._fail(number, '"%s" is not a setting here' % key, "known are %s and %s" % known)
        if key in self.tables[self._table]:
            raise self._fail(number, "the setting is given twice")
        self.tables[self._table][key] = self._text_of(number, value)

    def _open_table(self, number: int, line: str) -> None:
        table = _TABLE.match(line)
        if not table:
            raise self._fail(number, "a table is expected as [servers.NAME]",
                             "names have letters, digits, '-' and '_'")
        self._table = table.group(1)
        if self._table in self.tables:
            raise self._fail(number, "a second table has the same name")
        self.tables[self._table] = {}

    def _text_of(self, number: int, value: str) -> str:
        string = _STRING.match(value)
        if not string:
            raise self._fail(number, "a string of one line, in quotes, is expected after '='",
                             "the escapes are \\\" \\\\ and \\t; '...' has none")
        basic, literal = string.group(1), string.group(2)
        if basic is None:
            return str(literal)
        return re.sub(r'\\["\\t]', lambda escape: _ESCAPES[escape.group()], basic)

    def choose(self, given: Optional[str]) -> Server:
        """Returns the server: given is a URL, the name of a table, or None."""
        top = self.tables[""]
        chosen = given or os.environ.get("ORIEL_URL") or top.get("server") or DEFAULT_URL
        table: Optional[Dict[str, str]] = None
        if "://" in chosen:
            same = (one for one in self.tables.values()
                    if one.get("url", one.get("server", "")).rstrip("/") == chosen.rstrip("/"))
            table, url = next(same, None), chosen
        elif chosen and chosen in self.tables:
            table = self.tables[chosen]
            url = table["url"]
        else:
            raise SettingsError('"%s" is neither a URL nor a server that the settings name' % chosen,
                                "write http://HOST:PORT, or add [servers.%s] to %s" % (chosen, self.path))
        token = os.environ.get("ORIEL_TOKEN")
        if not token and table and "token_file" in table:
            token = self._token_in(table["token_file"])
        return Server(url.rstrip("/"), token or None)

    def _token_in(self, name: str) -> str:
        path = self.path.parent / os.path.expanduser(name)
        try:
            mode = path.stat().st_mode
            token = path.read_text(encoding="utf-8-sig").strip()
        except (OSError, ValueError) as error:
            raise SettingsError("cannot read the access token in %s: %s" % (path, error)) from error
        if os.name == "posix" and mode & (stat.S_IRGRP | stat.S_IROTH):
            warnings.warn("other users can read the access token in %s: run chmod 600" % path, stacklevel=2)
        if not re.fullmatch(r"[!-~]{1,1023}", token):
            raise SettingsError("%s: the file must have one access token, and no more" % path)
        return token


def settings_path() -> Path:
    """Returns the path of oriel.toml, which may not exist."""
    config = os.environ.get("XDG_CONFIG_HOME")
    folder = config if config and os.path.isabs(config) else os.path.join("~", ".config")
    return Path(os.path.expanduser(folder)) / "oriel.toml"


def read_settings() -> Settings:
    """Reads the user's file. Settings are empty if there is none."""
    path = settings_path()
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        return Settings(path)
    except (OSError, ValueError) as error:
        raise SettingsError("cannot read %s: %s" % (path, error)) from error
    return Settings(path, text)
