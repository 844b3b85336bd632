"""Manual pages in mdoc from the help texts: manuals.py ORIEL ORIELD VERSION DATE FOLDER."""
import os
import re
import sys

import help_text

EXIT = "Commands exit with 0 when they are done, 1 if they failed, and 2 if the command line is wrong."


def escape(text):
    """Text without meaning to roff; `code` and options are bold."""
    text = text.replace("\\", "\\e")
    text = re.sub(r"`([^`]*)`", r"\\fB\1\\fR", text)
    text = re.sub(r"(?<![\w-])(--?[a-z][a-z-]*)", lambda m: "\\fB" + m.group(1).replace("-", "\\-") + "\\fR", text)
    return re.sub(r"(?m)^([.'])", r"\\&\1", text)


def prose(text):
    """Lines of a paragraph: each sentence begins a line, as mdoc wants it."""
    lines = []
    for sentence in re.split(r"(?<=[\w)\"'`][.!?:])\s+(?=[A-Z`])|(?<=[.!?]\))\s+(?=[A-Z])", " ".join(text.split())):
        lines.extend(wrap(sentence, escape))
    return lines


def wrap(text, mark):
    """Lines of at most 78 bytes, where mark(text) is the text with its marks of roff."""
    lines, line = [], ""
    for word in text.split():
        longer = (line + " " + word).strip()
        if line and len(mark(longer).encode()) > 78:
            lines.append(mark(line))
            longer = word
        line = longer
    return lines + [mark(line)] if line else lines


def synopsis(text):
    """A synopsis: what is typed is bold, what stands for a value is slanted."""
    text = text.replace("\\", "\\e")
    text = re.sub(r"(--?[a-z][a-z-]*)|\b([A-Z][A-Z0-9]*(?:\.[a-z]+)?(?![A-Za-z]))|\b([a-z][a-z_-]*)",
                  lambda m: "\\fB%s\\fR" % (m.group(1) or m.group(3)).replace("-", "\\-") if not m.group(2)
                  else "\\fI%s\\fR" % m.group(2), text)
    return re.sub(r"(?m)^([.'])", r"\\&\1", text)


def paragraphs(blocks):
    """Paragraphs of a help text: prose, or a table if every line is indented."""
    lines = []
    for number, block in enumerate(blocks):
        is_table = all(line.startswith("  ") for line in block)
        if number and not is_table:  # a table has a paragraph's distance of its own
            lines.append(".Pp")
        if is_table:
            lines.extend(table(block))
        else:
            lines.extend(prose(" ".join(block)))
    return lines


def table(block):
    """Lines of "  name  text", with continuations that are indented further; or examples."""
    if not all(re.match(r"  \S+ {2,}\S| {4,}", line) for line in block):
        return [".Bd -literal -offset indent", *[escape(line.strip()) for line in block], ".Ed"]
    lines = [".Bl -tag -width Ds"]
    text = ""
    for line in block + [None]:
        found = line and re.match(r"  (\S+) +(\S.*)", line)
        if (found or line is None) and text:
            lines.extend(prose(text))
            text = ""
        if found:
            lines.append(".It Cm %s" % found.group(1))
            text = found.group(2)
        elif line:
            text += " " + line.strip()
    return lines + [".El"]


def option_table(options):
    lines = [".Bl -tag -width Ds"]
    for option in options:
        names = " , ".join("Fl " + name[1:].replace("-", "\\-") for name in option.names)
        value = (" Cm " if option.words() else " Ar ") + option.value.replace('"', "") if option.value else ""
        lines.append(".It " + names + value.replace("|", " | " if option.words() else "|"))
        text = option.text
        if text.partition(":")[0] not in option.words():  # a word of the value is typed in small letters
            text = text[:1].upper() + text[1:]
        lines.extend(prose(text + "."))
    return lines + [".El"]


def page(name, section, summary, body, also, version, date):
    """A whole page. also: the pages that it refers to."""
    title = name.upper()
    lines = [".Dd %s" % date, ".Dt %s %d" % (title, section), ".Os", ".Sh NAME",
             ".Nm %s" % name, ".Nd %s" % escape(summary[:1].lower() + summary[1:]), *body]
    lines.append(".Sh SEE ALSO")
    also = sorted(also, key=lambda page: (page[1], page[0]))
    lines.extend(".Xr %s %d%s" % (other, part, " ," if (other, part) != also[-1] else "") for other, part in also)
    lines += [".Sh VERSION", "Oriel %s" % version]
    return "\n".join(lines) + "\n"


def usage(lines):
    """The synopsis, a line for each line of the usage."""
    out = [".Sh SYNOPSIS"]
    for number, line in enumerate(lines):
        line = re.sub(r" {3,}.*", "", line)
        if number:
            out.append(".br")
        out.extend(wrap(line, synopsis))
    return out


def is_example(block):
    return len(block) > 1 and block[0].rstrip(":") in ("example", "examples")


def by_verb(block, verbs):
    """A paragraph cut where a line begins with a verb, behind the end of a sentence."""
    parts = [[]]
    for line in block:
        if parts[-1] and parts[-1][-1].endswith(".") and line.split(" ")[0] in verbs:
            parts.append([])
        parts[-1].append(line)
    return parts


def command_page(command, version, date):
    """The page of a command of oriel."""
    described = [part for block in command.help.before for part in by_verb(block, command.verbs)]
    body = usage(command.help.usage) + [".Sh DESCRIPTION"] + paragraphs(described)
    separate = {verb: text for verb, text in command.verbs.items()
                if [o.names for o in text.options] != [o.names for o in command.help.options]}
    body += [".Sh OPTIONS", *option_table(command.help.options)]
    for verb, text in separate.items():
        body += [".Ss oriel %s %s" % (command.name, verb)]
        if text.before != command.help.before:
            body += paragraphs(text.before)
        body += option_table(text.options)
    body += [".Sh EXIT STATUS", *prose(EXIT)]
    notes = [block for block in command.help.after if not is_example(block)]
    examples = [block for block in command.help.after if is_example(block)]
    for block in examples:
        body += [".Sh EXAMPLES", ".Bd -literal", *[escape(line[2:]) for line in block[1:]], ".Ed"]
    if notes:
        body += [".Sh NOTES", *paragraphs(notes)]
    return page("oriel-" + command.name, 1, command.summary, body, [("oriel", 1), ("orield", 8)], version, date)


def client_page(client, version, date):
    body = [".Sh SYNOPSIS", ".Nm", ".Ar COMMAND ...", ".Sh DESCRIPTION", ".Nm",
            *prose("runs the command that its first argument names."), ".Pp", *prose(client.notes), ".Sh COMMANDS",
            ".Bl -tag -width Ds"]
    for command in client.commands:
        body.append(".It Xr oriel-%s 1" % command.name)
        body.extend(prose(command.summary + "."))
    body.append(".El")
    return page("oriel", 1, client.purpose, body, [("orield", 8)], version, date)


def daemon_page(daemon, version, date):
    body = usage(daemon.help.usage) + [".Sh DESCRIPTION"] + paragraphs(daemon.help.before + daemon.help.after)
    body += [".Sh OPTIONS", *option_table(daemon.help.options)]
    for title, text in (("ACCESS TOKENS", daemon.tokens), ("STORED DATA", daemon.storage)):
        body += [".Sh " + title]
        for number, line in enumerate(text.usage):
            body += ([".br"] if number else []) + [synopsis(line)]
        body += [".Pp", *paragraphs(text.before), *option_table(text.options), *paragraphs(text.after)]
    body += [".Sh FILES", ".Bl -tag -width Ds", ".It Pa /etc/oriel/orield.env",
             *prose("Options of the daemon that systemd starts."), ".It Pa /var/lib/oriel",
             *prose("Data of that daemon."), ".El"]
    return page("orield", 8, "daylight rendering daemon", body, [("oriel", 1)], version, date)


def main(oriel, orield, version, date, folder):
    client, daemon = help_text.Client(oriel), help_text.Daemon(orield)
    pages = {"man1/oriel.1": client_page(client, version, date), "man8/orield.8": daemon_page(daemon, version, date)}
    for command in client.commands:
        pages["man1/oriel-%s.1" % command.name] = command_page(command, version, date)
    for name, text in pages.items():
        path = os.path.join(folder, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)


if __name__ == "__main__":
    main(*sys.argv[1:])
