"""Checks of commands that are not run: syntax, options, targets of make and paths."""
import os
import re
import subprocess

TOP_FOLDERS = ("api", "client", "core", "migrations", "server", "tests")


def joined(text):
    """The block's lines, with continued ones joined."""
    return re.sub(r"\\\n\s*", " ", text).splitlines()


def calls_of(text):
    """Each call of Oriel's programs in the block, as a list of words."""
    for line in joined(text):
        image = re.match(r"docker run .*\soriel(?=\s|$)(.*)$", line)
        if image:
            yield ["orield"] + image.group(1).split()
            continue
        for call in re.finditer(r"(?:^|[|;&(]|\$\(|run\s)\s*(?:\S*/)?(oriel|orield)((?:\s+[^|;&)]*)?)", line):
            words = re.sub(r"'[^']*'|\"[^\"]*\"", "QUOTED", call.group(2)).split()
            yield [call.group(1)] + words


class Programs:
    """What the built programs say about their commands and options."""

    def __init__(self, build):
        self.build = build
        self.texts = {}

    def help(self, words):
        key = tuple(words)
        if key not in self.texts:
            command = [os.path.join(self.build, words[0])] + list(words[1:]) + ["--help"]
            done = subprocess.run(command, capture_output=True, text=True, timeout=20)
            self.texts[key] = done.stdout + done.stderr if done.returncode == 0 else None
        return self.texts[key]

    def faults(self, words):
        """Says which command or option of a call does not exist."""
        commands = [word for word in words[1:3] if re.match(r"[a-z][a-z0-9-]+$", word)]
        known = [words[0]]
        for command in commands:
            if self.help(known + [command]) is None:
                break
            known.append(command)
        if words[0] == "oriel" and len(known) == 1 and commands:
            yield "oriel has no command '%s'" % commands[0]
            return
        told = self.help(known) or ""
        for word in words[1:]:
            option = re.match(r"(--?[A-Za-z][\w-]*)", word)
            if option and option.group(1) not in ("--help", "-h", "--version") and not re.search(
                    r"(?<![\w-])%s(?![\w-])" % re.escape(option.group(1)), told):
                yield "%s has no option '%s'" % (" ".join(known), option.group(1))


def targets_of(makefile):
    """Targets of the Makefile, and of the files that it includes."""
    for path in re.findall(r"^-?include ([\w./-]+)$", makefile, re.M):
        with open(path, encoding="utf-8") as stream:
            makefile += stream.read()
    rules = set()
    for line in re.findall(r"^([a-z][\w -]*):(?!=)", makefile, re.M):
        rules.update(line.split())
    return rules


def block_faults(text, programs, targets):
    """Yields what is wrong with a block of shell commands."""
    syntax = subprocess.run(["bash", "-n"], input=text, capture_output=True, text=True)
    if syntax.returncode != 0:
        yield "bash: " + syntax.stderr.strip()
        return
    for words in calls_of(text):
        yield from programs.faults(words)
    for line in joined(text):
        for name in re.findall(r"^(?:sudo )?make (?:[A-Z]+=\S+ )*([a-z][\w-]*)", line.split("#")[0].strip()):
            if name not in targets:
                yield "the Makefile has no target '%s'" % name
        for path in re.findall(r"(?<![\w./-])((?:%s)/[\w./-]+)" % "|".join(TOP_FOLDERS), line):
            if not os.path.exists(path):
                yield "there is no %s" % path
