"""The version of Oriel that this package belongs to."""

import pkgutil
import re
from pathlib import Path


def _read() -> str:
    """Reads VERSION, which the build of the wheel writes, or else the header of the source tree."""
    try:
        data = pkgutil.get_data(__package__, "VERSION")
    except OSError:
        data = None
    if data:
        return data.decode("ascii").strip()
    header = Path(__file__).resolve().parents[3] / "core" / "include" / "oriel" / "base" / "version.h"
    found = re.search(r'#define ORL_VERSION "([^"]+)"', header.read_text(encoding="utf-8"))
    if not found:
        raise ImportError("%s has no ORL_VERSION" % header)
    return found.group(1)


__version__ = _read()
