"""Runs the blocks of one page in a scratch folder, with a daemon if the page starts one."""
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile

ADDRESS = "http://127.0.0.1:8423"
BLOCK_SECONDS = 600
NEAR = 0.05  # numbers of an expected output and of the actual one may differ by this share


def is_near(wanted, got):
    """Compares two words. Numbers may differ by NEAR, because processors round differently.

    A word that ends with "..." stands for all words that begin like it.
    """
    if wanted == got or (wanted.endswith("...") and got.startswith(wanted[:-3])):
        return True
    parts = re.compile(r"-?\d+(?:\.\d+)?")
    if parts.sub("#", wanted) != parts.sub("#", got):
        return False
    pairs = zip(parts.findall(wanted), parts.findall(got))
    return all(abs(float(a) - float(b)) <= NEAR * max(abs(float(a)), abs(float(b)), 1e-9) for a, b in pairs)


def line_matches(wanted, got):
    """Compares two lines word by word; "..." stands for any words."""
    wanted_words, got_words = wanted.split(), got.split()
    if "..." not in wanted_words:
        return len(wanted_words) == len(got_words) and all(map(is_near, wanted_words, got_words))
    cut = wanted_words.index("...")
    head, tail = wanted_words[:cut], wanted_words[cut + 1:]
    if len(got_words) < len(head) or not all(map(is_near, head, got_words)):
        return False
    rest = got_words[len(head):]
    if not tail:
        return True
    return any(line_matches(" ".join(tail), " ".join(rest[skip:])) for skip in range(len(rest)))


def first_difference(wanted, got):
    """Returns the first expected line that the output lacks, or None. A line "..." skips any lines."""
    lines = [line for line in got.splitlines() if line.strip()]
    at, free = 0, False
    for line in wanted.splitlines():
        if line.strip() == "...":
            free = True
        elif line.strip():
            while free and at < len(lines) and not line_matches(line, lines[at]):
                at += 1
            if at >= len(lines) or not line_matches(line, lines[at]):
                return line
            at, free = at + 1, False
    return None if free or at == len(lines) else "(end)"


class Session:
    """A scratch folder with links to the repository's folders, and the state of the page's shell."""

    def __init__(self, build):
        self.top = os.getcwd()
        self.build = os.path.abspath(build)
        self.folder = tempfile.mkdtemp(prefix="oriel-guide-")
        for name in ("client", "server", "README.md"):
            os.symlink(os.path.join(self.top, name), os.path.join(self.folder, name))
        os.symlink(self.build, os.path.join(self.folder, "build"))
        self.daemon, self.url = None, None
        self.output = ""
        self.environment = {
            "PATH": "%s:/usr/local/bin:/usr/bin:/bin" % self.build, "HOME": self.folder, "LC_ALL": "C.UTF-8",
            "TERM": "dumb", "PYTHONDONTWRITEBYTECODE": "1",
            "PYTHONPATH": os.path.join(self.top, "client/python")}

    def close(self):
        if self.daemon:
            self.daemon.send_signal(signal.SIGTERM)
            try:
                self.daemon.wait(timeout=60)
            except subprocess.TimeoutExpired:
                self.daemon.kill()
                self.daemon.wait()
            self.daemon.stdout.close()
        shutil.rmtree(self.folder)

    def localized(self, text):
        return text.replace(ADDRESS, self.url) if self.url else text

    def start_daemon(self, text):
        """Runs the block, which is one command, in the background on a free port."""
        with open(os.path.join(self.folder, "orield.log"), "wb") as log:
            self.daemon = subprocess.Popen(
                ["bash", "-c", "exec %s --port 0" % text.strip().rstrip("&")], cwd=self.folder,
                env=self.environment, stdout=subprocess.PIPE, stderr=log, text=True)
        line = self.daemon.stdout.readline()
        address = re.match(r"listening on (\S+)", line)
        if not address:
            return "the daemon said '%s'" % line.strip()
        self.url = address.group(1).rstrip("/")
        self.environment["ORIEL_URL"] = self.url
        self.output = line.replace(self.url, ADDRESS)
        return None

    def write(self, name, text):
        path = os.path.join(self.folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as stream:
            stream.write(self.localized(text))

    def run_shell(self, text):
        """Runs commands in a shell that goes on where the last block of the page left off."""
        state = os.path.join(self.folder, ".shell")
        script = "[ ! -e %s ] || . %s\nset -ea\n%s\nset +a\n{ export -p; printf 'cd %%q\\n' \"$PWD\"; } >%s\n" % (
            state, state, self.localized(text), state)
        return self.run(["bash", "-c", script])

    def run_script(self, program, text):
        return self.run([program, "-"], self.localized(text))

    def run(self, command, text=None):
        done = subprocess.run(command, cwd=self.folder, env=self.environment, input=text, capture_output=True,
                              text=True, timeout=BLOCK_SECONDS)
        self.output = done.stdout
        if self.url:
            self.output = self.output.replace(self.url, ADDRESS)
        return None if done.returncode == 0 else "exit status %d\n%s%s" % (
            done.returncode, done.stdout[-2000:], done.stderr[-3000:])

    def compare(self, wanted):
        """Returns what is wrong with the last block's output."""
        line = first_difference(wanted, self.output)
        return None if line is None else "the output lacks '%s'; it is\n%s" % (line, self.output[-4000:])


def interpreter(language):
    return {"python": sys.executable, "js": "node"}[language]
