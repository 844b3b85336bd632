"""Pages of README and guide: their fenced blocks, prose, headings and links.

The info string of a block says what the test does with it:

    ```sh test            runs in each `make check`
    ```sh long            runs in `make guide-check`
    ```sh daemon          starts a daemon that later blocks of the page use
    ```sh                 is not run; its syntax, options, targets and paths are checked
    ```text output        is compared with what the block before it printed
    ```json file=job.json is written to that file
    ```python test        runs as a script, or `long`
"""
import glob
import os
import re

GUIDE = "client/guide"
README = "README.md"
GENERATED = GUIDE + "/reference/"


class Block:
    """A fenced block: its language, the other words of its info string, first line and text."""

    def __init__(self, page, line, info, text):
        words = info.split()
        self.page, self.line, self.text = page, line, text
        self.language = words[0] if words else ""
        self.words = [word for word in words[1:] if "=" not in word]
        self.values = dict(word.split("=", 1) for word in words[1:] if "=" in word)

    def place(self):
        return "%s:%d" % (self.page, self.line)


def all_pages():
    """README and the pages of the guide."""
    return [README] + sorted(glob.glob(GUIDE + "/**/*.md", recursive=True))


def written_pages():
    """Pages with commands: all but those that are generated, whose examples have tests of their own."""
    return [page for page in all_pages() if not is_generated(page)]


def is_generated(page):
    return page.startswith(GENERATED)


def text_of(path):
    with open(path, encoding="utf-8") as stream:
        return stream.read()


def split_page(page, text):
    """Returns the page's blocks, and its other lines with their numbers."""
    blocks, prose, opened = [], [], None
    for number, line in enumerate(text.splitlines(), 1):
        fence = re.match(r"```(.*)$", line)
        if not fence and opened is None:
            prose.append((number, line))
        elif not fence:
            opened[2].append(line)
        elif opened is None:
            opened = (number, fence.group(1), [])
        else:
            blocks.append(Block(page, opened[0], opened[1], "".join(line + "\n" for line in opened[2])))
            opened = None
    if opened is not None:
        raise ValueError("%s:%d: this block has no end" % (page, opened[0]))
    return blocks, prose


def anchor_of(heading):
    """The anchor of a heading: lower case, without punctuation, blanks as hyphens."""
    plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").strip().lower()
    return re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")


def anchors_of(path):
    _, prose = split_page(path, text_of(path))
    return {anchor_of(line.lstrip("#")) for _, line in prose if re.match(r"#{1,6} ", line)}


def folder_of(page):
    return os.path.dirname(page) or "."
