"""The help texts of oriel and orield as data, from which manuals and completions are made.

Both programs print their help in one layout: usage, paragraphs, and a table of options whose first
column holds the names and the value. In a value, capitals stand for what the user gives (DIR,
JOB.json), and small letters are typed as they are (text|json).
"""
import re
import subprocess

OPTION = re.compile(r"^ {2,6}((?:-\w, )?--[a-z][a-z-]*(?:, --[a-z][a-z-]*)*)(.*)$")
COMMAND = re.compile(r"^  ([a-z][a-z-]*) +(\S.*)$")


class Option:
    """An option: its names, the value as the help names it ("" for a flag), and its help."""

    def __init__(self, names, value, text):
        self.names, self.value, self.text = names, value, text

    def words(self):
        """The words that the value can be; none if the user is free."""
        return self.value.split("|") if re.fullmatch(r"[a-z_0-9-]+(\|[a-z_0-9-]+)+", self.value) else []


class Help:
    """A help text: usage lines, paragraphs before and behind the options, and the options."""

    def __init__(self, text):
        self.usage, self.before, self.options, self.after = [], [], [], []
        lines = text.rstrip("\n").split("\n")
        at = self._read_usage(lines)
        paragraphs = self.before
        block = []
        while at <= len(lines):
            line = lines[at] if at < len(lines) else ""
            if OPTION.match(line):
                at = self._read_option(lines, at)
                paragraphs = self.after
                continue
            if line.strip() and line.strip() not in ("options:", "options"):
                block.append(line)
            elif block:
                paragraphs.append(block)
                block = []
            at += 1

    def _read_usage(self, lines):
        """Takes the lines of "usage: ..." and their continuations, which are indented."""
        at = next(i for i, line in enumerate(lines) if re.match(r"usage: ", line, re.I))
        self.before.extend([[line] for line in lines[:at] if line])
        self.usage.append(lines[at][len("usage: "):])
        at += 1
        while at < len(lines) and lines[at].startswith("  "):
            self.usage.append(lines[at].strip())
            at += 1
        return at

    def _read_option(self, lines, at):
        """Takes an option with all lines of its help."""
        names, rest = OPTION.match(lines[at]).groups()
        value, text = split_value(rest)
        at += 1
        while at < len(lines) and lines[at].startswith(" " * 12):
            text = (text + " " + lines[at].strip()).strip()
            at += 1
        self.options.append(Option(names.split(", "), value, text))
        return at


def split_value(rest):
    """Splits " DIR   folder for ..." into the value and the help. A value in quotes may have spaces."""
    if not rest or rest.startswith("  "):
        return "", rest.strip()
    # A value can be so long that one space alone is between it and the help.
    value, text = re.match(r'("[^"]*"|\S+) *(.*)', rest.strip()).groups()
    return value, text


def run(program, *arguments):
    """What a program prints on standard output."""
    return subprocess.run([program, *arguments], stdout=subprocess.PIPE, check=True,
                          universal_newlines=True).stdout


class Command:
    """A command of oriel: its help, and the help of each verb that has options of its own."""

    def __init__(self, program, name, summary):
        self.name, self.summary = name, summary
        self.help = Help(run(program, name, "--help"))
        synopsis = " ".join(self.help.usage)[len("oriel %s" % name):].strip()
        self.alternatives = split_alternatives(synopsis)
        self.verbs = {}
        for verb in self.verb_names():
            self.verbs[verb] = Help(run(program, name, verb, "--help"))

    def verb_names(self):
        """First words that are typed as they are: "check FILE | fit DATA", "job|scene ID".

        A help with many of them lists them in a sentence: "NAME is one of: a, b, c."
        """
        names = []
        text = " ".join(line for block in self.help.before for line in block)
        listed = {name: words for name, words in re.findall(r"\b([A-Z]+) is one of: ([a-z0-9, -]+)\.", text)}
        for alternative in self.alternatives:
            first = alternative.split(" ")[0]
            if first in listed:
                return listed[first].split(", ")
            if re.fullmatch(r"[a-z|]+", first):
                names.extend(word for word in first.split("|") if word not in names)
        return names

    def operands(self, verb=None):
        """Operands as the synopsis names them, "JOB.json|PROJECT", without options."""
        names = []
        for alternative in self.alternatives:
            words = without_options(alternative)
            if verb:
                if not words or verb not in words[0].split("|") and re.match("[a-z]", words[0]):
                    continue
                words = words[1:]
            names.extend(word for word in words if word not in names)
        return names


def split_alternatives(synopsis):
    """Splits at bars that stand alone: "check FILE | fit DATA" has two alternatives."""
    return [part.strip() for part in re.split(r" \| ", synopsis)] if synopsis else []


def without_options(alternative):
    """The operands of a synopsis: no options, no brackets, no dots."""
    text, before = alternative, ""
    while text != before:  # brackets within brackets go first
        before, text = text, re.sub(r"\[-[^][]*\]", " ", text)
    text = re.sub(r"(^| )--?[a-z-]+ [A-Z.a-z]+", " ", text)
    return [word for word in re.sub(r"\.\.\.|[][]", " ", text).split() if not word.startswith("-")]


class Client:
    """oriel: what it is for, its commands, and what holds for all of them."""

    def __init__(self, program):
        lines = run(program, "--help").rstrip("\n").split("\n")
        found = [i for i, line in enumerate(lines) if COMMAND.match(line)]
        self.purpose = lines[0].partition(": ")[2]
        self.commands = [Command(program, *COMMAND.match(lines[i]).groups()) for i in found]
        self.notes = " ".join(lines[found[-1] + 1:]).strip()


class Daemon:
    """orield: its own help, and the helps of the commands beside it."""

    def __init__(self, program):
        self.help = Help(run(program, "--help"))
        self.tokens = Help(run(program, "token", "--help"))
        self.storage = Help(run(program, "scrub", "--help"))
        self.verbs = {"token": ["add", "list", "remove"], "scrub": [], "backup": []}
