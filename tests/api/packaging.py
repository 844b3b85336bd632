"""Versions, manuals, completion, installation and the files for containers: packaging.py CASE BUILD FOLDER.

A case that finds something wrong ends with a traceback and status 1. FOLDER is empty, and its own.
"""
import fcntl
import json
import os
import pty
import re
import select
import shutil
import signal
import struct
import subprocess
import sys
import termios
import time

import yaml

BUILD, FOLDER = os.path.abspath(sys.argv[2]), sys.argv[3]
ORIEL, ORIELD = os.path.join(BUILD, "oriel"), os.path.join(BUILD, "orield")
BASH_FILES = os.path.join(BUILD, "packaging", "bash")
ZSH_FILES = os.path.join(BUILD, "packaging", "zsh")
MANUALS = os.path.join(BUILD, "packaging", "man")


def output(*command, **named):
    return subprocess.run(command, stdout=subprocess.PIPE, check=True, universal_newlines=True, **named).stdout


def header_version():
    with open("core/include/oriel/base/version.h") as stream:
        return re.search(r'ORL_VERSION "([^"]+)"', stream.read()).group(1)


def commands():
    """Names of the commands, as `oriel --help` lists them."""
    return re.findall(r"(?m)^  ([a-z]+) +\S", output(ORIEL, "--help"))


def help_of(command):
    """The help of "run", "bsdf make" or, with "", of orield."""
    return output(ORIEL, *command.split(), "--help") if command else output(ORIELD, "--help")


def options_of(text):
    """All options of a help text, with their values: {"--output": "DIR", "-o": "DIR", ...}."""
    found = {}
    for names, value in re.findall(r"(?m)^ {2,6}((?:-\w, )?--[a-z-]+(?:, --[a-z-]+)*)(?: (\S+))?", text):
        for name in names.split(", "):
            found[name] = value
    return found


def contexts():
    """Commands, and verbs of bsdf, that have options of their own."""
    return commands() + ["bsdf " + verb for verb in ("check", "fit", "make", "convert", "compare", "plot")]


def version():
    names = {}
    for program in (ORIEL, ORIELD):
        lines = output(program, "--version").splitlines()
        values = dict(line.split(" ", 1) for line in lines)
        assert lines[0] == "%s %s" % (os.path.basename(program), header_version()), lines[0]
        assert values["license"] == "MIT"
        # Of git, or of a copy that says which.
        assert re.fullmatch(r"[0-9a-f]{7,40}|unknown", values["commit"]), values["commit"]
        read = json.loads(output(program, "--version", "--json"))
        assert [read["program"], read["version"]] == lines[0].split(" ")
        assert read["commit"] == (None if values["commit"] == "unknown" else values["commit"])
        assert read["libraries"] == {name: values[name] for name in list(values)[3:]}
        for name, number in read["libraries"].items():
            assert re.fullmatch(r"\d+(\.\d+)+\S*", number), (name, number)
        names[os.path.basename(program)] = set(read["libraries"])
    shared = {"Embree", "OpenEXRCore", "libpng", "libtiff", "zlib", "expat", "jansson", "libsodium", "Nettle"}
    assert names["oriel"] == shared | {"libcurl"}, names
    assert names["orield"] == shared | {"SQLite", "libmicrohttpd", "libuv", "GnuTLS", "libarchive"}, names
    assert output(ORIEL, "version") == output(ORIEL, "--version")
    # The versions are those at run time.
    curl = re.match(r"curl \S+ .*libcurl/(\S+)", output("curl", "--version")).group(1)
    assert json.loads(output(ORIEL, "version", "--json"))["libraries"]["libcurl"] == curl


def one_version():
    """All that has a version reads it from the header, or has the same."""
    number = header_version()
    assert re.fullmatch(r"(0|[1-9]\d*)\.(0|[1-9]\d*)\.(0|[1-9]\d*)(-[0-9A-Za-z.-]+)?", number), number
    with open(os.path.join(BUILD, "generated", "openapi.yaml")) as stream:
        assert str(yaml.safe_load(stream)["info"]["version"]) == number
    for page in os.listdir(os.path.join(MANUALS, "man1")):
        with open(os.path.join(MANUALS, "man1", page)) as stream:
            assert stream.read().endswith("\nOriel %s\n" % number), page
    with open("client/packaging/debian/changelog.in") as stream:
        assert stream.read().startswith("oriel (@VERSION@) ")
    assert output("make", "-s", "--no-print-directory", "print-version").strip() == number
    for place in ("client/python/pyproject.toml", "client/javascript/package.json"):
        if os.path.exists(place):
            with open(place) as stream:
                text = stream.read()
            stated = re.search(r'(?m)^\s*"?version"?\s*[:=]\s*"([^"]+)"', text)
            assert (stated and stated.group(1) == number) or '"version"' in text, place


def manuals():
    pages = sorted(os.listdir(os.path.join(MANUALS, "man1"))) + os.listdir(os.path.join(MANUALS, "man8"))
    assert pages == sorted(["oriel.1"] + ["oriel-%s.1" % name for name in commands()]) + ["orield.8"], pages
    for page in pages:
        path = os.path.join(MANUALS, "man" + page[-1], page)
        lint = subprocess.run(["mandoc", "-Tlint", path], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True).stdout
        # mandoc looks for other pages among those that are installed.
        wrong = [line for line in lint.splitlines() if "referenced manual not found" not in line]
        assert not wrong, wrong
        with open(path) as stream:
            source = stream.read()
        for name, section in re.findall(r"(?m)^\.(?:It )?Xr (\S+) (\d)", source):
            assert os.path.exists(os.path.join(MANUALS, "man" + section, "%s.%s" % (name, section))), (page, name)
        text = re.sub(r".\x08", "", output("mandoc", "-Tascii", path))
        command = page[:-2].partition("-")[2] if page != "orield.8" else ""
        if page == "oriel.1":
            continue
        for option in options_of(help_of(command)):
            assert re.search(r"(?m)^ +(\S+, )*%s\b" % re.escape(option), text), (page, option)
    with open(os.path.join(MANUALS, "man1", "oriel-bsdf.1")) as stream:
        assert ".Ss oriel bsdf make" in stream.read()


def bash(*words, cwd="."):
    """What bash completes the last of the words to."""
    program = words[0]
    script = "source %s/%s; COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _%s %s \"${@: -1}\" \"${@: -2:1}\"; " \
        "printf '%%s\\n' \"${COMPREPLY[@]}\"" % (BASH_FILES, program, program, program)
    return [line for line in output("bash", "-c", script, "bash", *words, cwd=cwd).splitlines() if line]


def bash_options():
    assert bash("oriel", "") == commands()
    assert bash("oriel", "bs") == ["bsdf"]
    assert "--version" in bash("oriel", "--")
    for context in contexts():
        words = context.split()
        assert words[-1] in bash("oriel", *words[:-1], words[-1][:2]), context
        assert set(bash("oriel", *words, "-")) == set(options_of(help_of(context))), context
    assert bash("orield", "") == ["token", "scrub", "backup"]
    assert set(bash("orield", "-")) == set(options_of(help_of("")))
    assert bash("orield", "token", "") == ["add", "list", "remove"]
    # Options follow operands and values, too.
    assert bash("oriel", "run", "a.json", "-o", "out", "--thr") == ["--threads"]
    assert bash("oriel", "bsdf", "make", "a.rad", "--res") == ["--resolution"]


def bash_values():
    """Words of enumerations, also behind "="."""
    count = 0
    for context in contexts() + [""]:
        program = ["oriel", *context.split()] if context else ["orield"]
        for name, value in options_of(help_of(context)).items():
            if re.fullmatch(r"[a-z_0-9-]+(\|[a-z_0-9-]+)+", value):
                words = value.split("|")
                assert bash(*program, name, "") == words, (context, name)
                assert bash(*program, name, "=", words[0][:2]) == [w for w in words if w.startswith(words[0][:2])]
                count += 1
    assert count >= 12, count
    # The longest enumeration is whole.
    assert bash("oriel", "bsdf", "make", "--basis", "t") == ["tensor_tree_3", "tensor_tree_4"]
    assert bash("oriel", "remove", "") == ["job", "scene", "bsdf"]
    assert bash("oriel", "list", "b") == ["bsdfs"]
    assert bash("orield", "token", "add", "--scope", "a") == ["admin"]
    assert bash("oriel", "run", "--threads", "") == []


def bash_files():
    for name in ("job.json", "two rooms.hbjson", "panel.rad", "view.hdr", "note.txt"):
        open(os.path.join(FOLDER, name), "w").close()
    os.mkdir(os.path.join(FOLDER, "out"))

    def found(*words):
        return sorted(bash(*words, cwd=FOLDER))
    assert found("oriel", "run", "") == ["job.json", "out", "two rooms.hbjson"]
    assert found("oriel", "run", "two") == ["two rooms.hbjson"]
    assert found("oriel", "run", "job.json", "-o", "") == ["out"]
    assert found("oriel", "run", "job.json", "--output", "=", "o") == ["out"]
    assert found("oriel", "bsdf", "make", "p") == ["panel.rad"]
    assert found("oriel", "glare", "") == ["out", "view.hdr"]
    assert found("oriel", "annual", "--weather", "note") == ["note.txt"]
    assert found("oriel", "upload", "scene", "")[:2] == ["job.json", "note.txt"]
    assert found("orield", "--data", "") == ["out"]


class Zsh:
    """An interactive zsh with the completions, on a terminal so large that it shows every list whole."""

    def __init__(self):
        self.pid, self.terminal = pty.fork()
        if self.pid == 0:
            os.environ["TERM"] = "xterm"
            os.execvp("zsh", ["zsh", "-f", "-i"])
        fcntl.ioctl(self.terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 3000, 200, 0, 0))
        self.run("PS1='ready> '; LISTMAX=10000; fpath=(%s $fpath); autoload -Uz compinit" % ZSH_FILES)
        self.run("compinit -u -d %s; bindkey '^]' list-choices" % os.path.join(FOLDER, "dump"))

    def run(self, command):
        """Runs a command, and returns what the terminal has shown until its end."""
        # The shell shows what is typed, which therefore is not what is waited for.
        os.write(self.terminal, (command + "\rprint end''-of-command\r").encode())
        shown, began = b"", time.monotonic()
        # Behind the prompt the line editor reads: keys before it would be the terminal's own.
        while b"ready> " not in shown.partition(b"end-of-command")[2]:
            assert time.monotonic() - began < 30, shown
            if select.select([self.terminal], [], [], 1)[0]:
                shown += os.read(self.terminal, 65536)
        return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", shown.decode("utf-8", "replace"))

    def list(self, line):
        """What zsh offers behind the line; Ctrl-] lists it, Ctrl-U removes the line."""
        return self.run(line + "\x1d\x15")

    def end(self):
        os.kill(self.pid, signal.SIGKILL)
        os.waitpid(self.pid, 0)


def zsh():
    """zsh, where it is installed, lists the commands, the options of each, and words."""
    if not shutil.which("zsh"):
        return
    shell = Zsh()
    shown = shell.list("oriel ")
    for command in commands():
        assert re.search(r"(?m)(^|\s)%s +--" % command, shown), (command, shown)
    for context in contexts() + [""]:
        shown = shell.list("oriel %s -" % context if context else "orield -")
        for option in options_of(help_of(context)):
            assert re.search(r"(?m)(^|\s)%s(\s|$)" % re.escape(option), shown), (context, option, shown)
    assert re.search(r"\ssucceeded\s", shell.list("oriel status --state "))
    assert re.search(r"\scompare\s", shell.list("oriel bsdf "))
    assert re.search(r"\sremove\s", shell.list("orield token "))
    shell.end()


def make(target, *variables):
    output("make", "-s", "--no-print-directory", "BUILD=" + BUILD, "DESTDIR=" + FOLDER, *variables, target)


def files():
    return sorted(os.path.relpath(os.path.join(folder, name), FOLDER)
                  for folder, _, names in os.walk(FOLDER) for name in names)


def install():
    make("install-files", "prefix=/usr", "pythondir=/usr/lib/python3/dist-packages")
    found = set(files())
    wanted = {"usr/bin/oriel", "usr/bin/orield", "etc/oriel/orield.env", "usr/lib/systemd/system/orield.service",
              "usr/share/man/man1/oriel.1", "usr/share/man/man8/orield.8", "usr/share/doc/oriel/LICENSE",
              "usr/share/doc/oriel/compose.yaml", "usr/share/bash-completion/completions/oriel",
              "usr/share/bash-completion/completions/orield", "usr/share/zsh/site-functions/_oriel",
              "usr/share/zsh/site-functions/_orield", "usr/share/doc/oriel/examples/office/office.json"}
    wanted |= {"usr/share/man/man1/oriel-%s.1" % name for name in commands()}
    for source, place in (("client/guide", "usr/share/doc/oriel/guide"), ("client/examples", "usr/share/doc/oriel/examples")):
        for folder, _, names in os.walk(source):
            wanted |= {os.path.join(place, os.path.relpath(os.path.join(folder, name), source)) for name in names}
    assert wanted <= found, sorted(wanted - found)
    assert os.access(os.path.join(FOLDER, "usr/share/doc/oriel/examples/office/demo"), os.X_OK)
    with open(os.path.join(FOLDER, "usr/lib/systemd/system/orield.service")) as stream:
        unit = stream.read()
    assert "\nExecStart=/usr/bin/orield $ORIEL_OPTIONS\n" in unit and "\nEnvironmentFile=-/etc/oriel/orield.env\n" in unit
    assert "/usr/local" not in unit
    module = os.path.join(FOLDER, "usr/lib/python3/dist-packages")
    stated = output("/usr/bin/python3", "-B", "-c", "import oriel; oriel.Client; print(vars(oriel).get('__version__'))",
                    cwd=FOLDER, env={"PYTHONPATH": module}).strip()
    assert stated in (header_version(), "None"), stated
    assert output(os.path.join(FOLDER, "usr/bin/oriel"), "--version") == output(ORIEL, "--version")
    # Options that are set stay; uninstall leaves only them.
    options = os.path.join(FOLDER, "etc/oriel/orield.env")
    with open(options, "w") as stream:
        stream.write("ORIEL_OPTIONS=--jobs 2\n")
    make("install-files", "prefix=/usr", "pythondir=/usr/lib/python3/dist-packages")
    with open(options) as stream:
        assert stream.read() == "ORIEL_OPTIONS=--jobs 2\n"
    make("uninstall", "prefix=/usr", "pythondir=/usr/lib/python3/dist-packages")
    assert files() == ["etc/oriel/orield.env"], files()


def install_elsewhere():
    """A prefix of its own, and GNU's variables."""
    make("install-files", "PREFIX=/opt/oriel", "mandir=/usr/man")
    found = files()
    assert "opt/oriel/bin/orield" in found and "opt/oriel/etc/oriel/orield.env" in found
    assert "usr/man/man1/oriel-run.1" in found
    with open(os.path.join(FOLDER, "opt/oriel/lib/systemd/system/orield.service")) as stream:
        assert "\nExecStart=/opt/oriel/bin/orield $ORIEL_OPTIONS\n" in stream.read()


def image_root():
    """The root of the image has all libraries of both programs, no shell, and their licences."""
    output("client/packaging/image_root", FOLDER, ORIELD, ORIEL)
    found = files()
    assert not [name for name in found if os.path.basename(name) in ("sh", "bash", "curl")]
    loader = os.path.realpath(os.path.join(FOLDER, next(n for n in found if "/ld-linux" in n)))
    folders = {os.path.dirname(os.path.join(FOLDER, name)) for name in found if ".so" in name}
    for program in ("usr/bin/orield", "usr/bin/oriel"):
        listed = output(loader, "--inhibit-cache", "--library-path", ":".join(folders), "--list",
                        os.path.join(FOLDER, program))
        for path in re.findall(r"=> (\S+)", listed):
            assert path.startswith(FOLDER) or "/ld-linux" in path, (program, path)
    for package in ("libembree3-3", "libsqlite3-0", "libc6"):
        assert "usr/share/doc/%s/copyright" % package in found, package
    size = sum(os.path.getsize(os.path.join(FOLDER, name)) for name in found)
    # Programs with sanitizers are larger, and no part of an image.
    assert size < 150e6 or [name for name in found if "san.so" in name], size


def image_packages():
    """The image is built with the packages that the Makefile names."""
    with open("Dockerfile") as stream:
        words = stream.read().split()
    missing = [name for name in output("make", "-s", "--no-print-directory", "print-packages").split() if name not in words]
    assert not missing, missing


def compose():
    """The compose file runs the image as safely as its head says."""
    with open("client/packaging/compose.yaml") as stream:
        document = yaml.safe_load(stream)
    service = document["services"]["oriel"]
    assert service["image"] == "oriel:latest" and service["network_mode"] == "host"
    assert service["read_only"] is True and service["cap_drop"] == ["ALL"]
    volume, _, place = service["volumes"][0].partition(":")
    assert volume in document["volumes"]
    with open("Dockerfile") as stream:
        assert "\nVOLUME %s\n" % place in stream.read()


def apparmor():
    """The profile is accepted, where AppArmor's tools are installed, and names the unit's folders."""
    profile = "client/packaging/apparmor/usr.bin.orield"
    with open(profile) as stream:
        text = stream.read()
    assert "/var/lib/oriel/** rwkl," in text and "/usr/bin/orield mrix," in text
    parser = shutil.which("apparmor_parser") or shutil.which("/usr/sbin/apparmor_parser")
    if parser:
        output(parser, "--skip-kernel-load", "--skip-cache", profile)


if __name__ == "__main__":
    globals()[sys.argv[1]]()
