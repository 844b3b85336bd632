"""Completion for bash and zsh from the help texts: completions.py ORIEL ORIELD FOLDER."""
import os
import re
import sys

import help_text

BASH = """# Completion of {program} for bash, made from its help.
_{program}_options() {{
    case $1 in
{options}
    esac
}}
# What follows an option, or the operands (-): words, or files with an ending, or folders.
_{program}_values() {{
    case $1 in
{values}
    esac
}}
_{program}_files() {{ # word, endings...
    local word=$1 ending
    shift
    compopt -o filenames 2>/dev/null
    COMPREPLY+=($(compgen -d -- "$word"))
    for ending; do
        case $ending in
        /) ;;
        '*') COMPREPLY=($(compgen -f -- "$word")) ;;
        *) COMPREPLY+=($(compgen -f -X "!*$ending" -- "$word")) ;;
        esac
    done
}}
_{program}() {{
    local IFS=$'\\n' word=$2 before=$3 context='' kind='' at=1 spec=()
    COMPREPLY=()
    # The command, and its verb if it has verbs.
    while [ "$at" -lt "$COMP_CWORD" ]; do
        case ${{COMP_WORDS[at]}} in
        -*) [ -n "$context" ] || break ;;
        *)
            [ -n "$(_{program}_options "$context${{context:+ }}${{COMP_WORDS[at]}}")" ] || break
            context=$context${{context:+ }}${{COMP_WORDS[at]}}
            ;;
        esac
        at=$((at + 1))
    done
    # "--name=value" is three words for bash.
    if [ "$word" = = ]; then
        word=
    elif [ "$before" = = ]; then
        before=${{COMP_WORDS[COMP_CWORD - 2]}}
    fi
    case $before in
    -*) kind=$(_{program}_values "$context $before") ;;
    esac
    if [ -z "$kind" ]; then
        case $word in
        -*)
            COMPREPLY=($(compgen -W "$(_{program}_options "$context")" -- "$word"))
            return
            ;;
        esac
        kind=$(_{program}_values "$context -")
    fi
    read -r -d '' -a spec <<<"$kind" || :
    case ${{spec[0]}} in
    words) COMPREPLY=($(compgen -W "${{spec[*]:1}}" -- "$word")) ;;
    files) _{program}_files "$word" "${{spec[@]:1}}" ;;
    esac
}}
complete -F _{program} {program}
"""

ZSH = """#compdef {program}
# Completion of {program} for zsh, made from its help.
_{program}_command() {{
    case $1 in
{cases}
    esac
}}
_{program}() {{
    local -a names
    names=(
{names}
    )
    if (( CURRENT == 2 )) && [[ $words[2] != -* ]]; then
        _describe -t commands command names
        {also}return
    fi
    local context=$words[2]
    [[ $context == -* ]] && context=
    if [[ -n $context ]]; then
        words[1]=()
        (( CURRENT-- ))
        if (( CURRENT > 2 )) && _{program}_has "$context $words[2]"; then
            context="$context $words[2]"
            words[1]=()
            (( CURRENT-- ))
        fi
    fi
    _{program}_command "$context"
}}
_{program}_has() {{
    case $1 in
    {verbs}) return 0 ;;
    esac
    return 1
}}
_{program} "$@"
"""

# Endings of the files that a placeholder stands for; "/" is a folder, "*" any file.
KINDS = {"DIR": ["/"], "FOLDER": ["/"], "FILE": ["*"], "DATA": ["*"], "RESULT": ["*"], "PICTURE": ["*"], "TO": ["/"],
         "ZIP": [".zip"], "PROJECT": [".hbjson", ".rif", ".cfg", "/"]}


def kind(value):
    """How a value is completed: ["words", ...], ["files", ...], or [] if it is anything."""
    if re.fullmatch(r"[a-z_0-9-]+(\|[a-z_0-9-]+)*", value):
        return ["words", *value.split("|")]
    endings = []
    for part in value.split("|"):
        endings.extend(KINDS.get(part, ["." + part.partition(".")[2]] if re.fullmatch(r"[A-Z]+\.[a-z]+", part) else []))
    if "*" in endings:
        endings = ["*"]
    return ["files", *endings] if endings else []


def operand_kind(names):
    """The same for all operands of a command together."""
    kinds = [kind(name) for name in names]
    words = [word for found in kinds if found[:1] == ["words"] for word in found[1:]]
    if words:
        return ["words", *words]
    endings = [ending for found in kinds if found[:1] == ["files"] for ending in found[1:]]
    return ["files", *(["*"] if "*" in endings else dict.fromkeys(endings))] if endings else []


class Context:
    """A place on the command line: its name ("run", "bsdf make"), options and operands."""

    def __init__(self, name, summary, options, operands):
        self.name, self.summary, self.options, self.operands = name, summary, options, operands


def of_client(client):
    found = [Context("", "", [help_text.Option(["--help"], "", "print an overview"),
                              help_text.Option(["--version"], "", "print the version")],
                     ["|".join(command.name for command in client.commands)])]
    for command in client.commands:
        verbs = command.verb_names()
        found.append(Context(command.name, command.summary, command.help.options,
                             ["|".join(verbs)] if verbs else command.operands()))
        for verb, text in command.verbs.items():
            found.append(Context(command.name + " " + verb, "", text.options, command.operands(verb)))
    return found


def of_daemon(daemon):
    found = [Context("", "", daemon.help.options, ["|".join(daemon.verbs)])]
    for name, verbs in daemon.verbs.items():
        options = (daemon.tokens if name == "token" else daemon.storage).options
        line = next(line for line in daemon.help.usage if name in line.split())
        found.append(Context(name, line.rpartition("   ")[2], options,
                             ["|".join(verbs)] if verbs else ["TO"] if name == "backup" else []))
        found.extend(Context(name + " " + verb, "", options, []) for verb in verbs)
    return found


def bash(program, contexts):
    options, values = [], []
    for context in contexts:
        names = [name for option in context.options for name in option.names]
        options.append("    '%s') printf '%%s\\n' %s ;;" % (context.name, " ".join(names)))
        for option in context.options:
            words = kind(option.value)
            if option.value:  # a value of no kind is still a value: options do not follow
                for name in option.names:
                    values.append("    '%s %s') printf '%%s\\n' %s ;;"
                                  % (context.name, name, " ".join(map(quote, words or ["any"]))))
        words = operand_kind(context.operands)
        if words:
            values.append("    '%s -') printf '%%s\\n' %s ;;" % (context.name, " ".join(map(quote, words))))
    return BASH.format(program=program, options="\n".join(options), values="\n".join(values))


def quote(word):
    return "'%s'" % word if re.search(r"[^\w.-]", word) else word


def zsh_action(words):
    """The last part of a specification of zsh's _arguments."""
    if words[:1] == ["words"]:
        return "(%s)" % " ".join(words[1:])
    if words == ["files", "/"]:
        return "_files -/"
    if words[:1] == ["files"] and "*" not in words:
        endings = [word[1:] for word in words[1:] if word != "/"]
        # One ending in brackets would be flags of the pattern.
        return '_files -g "*.%s"' % ("(%s)" % "|".join(endings) if len(endings) > 1 else endings[0])
    return "_files" if words else " "


def zsh_text(text):
    return re.sub(r"([][:\\])", r"\\\1", text).replace("'", "'\\''")


def zsh_options(context):
    lines = []
    for option in context.options:
        names = "{%s}" % ",".join(option.names) if len(option.names) > 1 else option.names[0]
        value = ":%s:%s" % (zsh_text(option.value.replace('"', "")), zsh_action(kind(option.value))) if option.value else ""
        lines.append("            %s'[%s]%s'" % (names, zsh_text(option.text), value))
    lines.append("            '*:operand:%s'" % zsh_action(operand_kind(context.operands)))
    return lines


def zsh(program, contexts):
    cases = ["    '%s')\n        _arguments -s : \\\n%s\n        ;;"
             % (context.name, " \\\n".join(zsh_options(context))) for context in contexts]
    top = [context for context in contexts if context.name and " " not in context.name]
    names = ["        '%s:%s'" % (context.name, zsh_text(context.summary)) for context in top]
    verbs = "|".join("'%s'" % context.name for context in contexts if " " in context.name)
    return ZSH.format(program=program, cases="\n".join(cases), names="\n".join(names), verbs=verbs,
                      also="" if program == "oriel" else "_%s_command ''\n        " % program)


def main(oriel, orield, folder):
    programs = {"oriel": of_client(help_text.Client(oriel)), "orield": of_daemon(help_text.Daemon(orield))}
    for program, contexts in programs.items():
        for name, text in (("bash/" + program, bash(program, contexts)), ("zsh/_" + program, zsh(program, contexts))):
            path = os.path.join(folder, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)


if __name__ == "__main__":
    main(*sys.argv[1:])
