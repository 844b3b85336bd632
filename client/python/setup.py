"""Build of the wheel. The version comes from the C header, and is written into the package as VERSION."""

import re
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

HERE = Path(__file__).resolve().parent
HEADER = HERE.parents[1] / "core" / "include" / "oriel" / "base" / "version.h"


def read_version():
    found = re.search(r'#define ORL_VERSION "([^"]+)"', HEADER.read_text(encoding="utf-8"))
    if not found:
        raise SystemExit("%s has no ORL_VERSION" % HEADER)
    return found.group(1)


class BuildWithVersion(build_py):
    """Copies the package, and adds VERSION."""

    def run(self):
        super().run()
        target = Path(self.build_lib) / "oriel" / "VERSION"
        target.write_text(read_version() + "\n", encoding="ascii")


setup(version=read_version(), cmdclass={"build_py": BuildWithVersion})
