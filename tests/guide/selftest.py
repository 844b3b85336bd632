"""The checks find broken pages: each case has a fault that must be named."""
import importlib.machinery
import importlib.util
import os
import tempfile

from blocks import split_page
from commands import block_faults
from documents import document_fault
from session import first_difference

FENCE = "```"


def check_outputs():
    assert first_difference("a 1.00 b\n", "a 1.04 b\n") is None
    assert first_difference("a 1.00 b\n", "a 1.10 b\n") == "a 1.00 b"
    assert first_difference("...\nlast ...\n", "first\nlast one\n") is None
    assert first_difference("first\n", "first\nsecond\n") == "(end)"
    assert first_difference("{\"id\":... ...\n", "{\"id\":\"7\", \"b\": 1}\n") is None


def check_commands(programs, targets):
    def faults(text):
        return " ".join(block_faults(text, programs, targets))
    assert faults("oriel run job.json -o out\nmake check\norield --listen 0.0.0.0:1\n") == ""
    assert "no option '--outptu'" in faults("oriel run job.json --outptu out\n")
    assert "no command 'rnu'" in faults("oriel rnu job.json\n")
    assert "no target 'chekc'" in faults("make chekc\n")
    assert "there is no client/absent" in faults("cp client/absent .\n")
    assert "bash" in faults("for x in\n")


def check_blocks():
    text = "# Page\n\n%ssh test\ntrue\n%s\n\n%sjson file=a.json\n{}\n%s\n" % (FENCE, FENCE, FENCE, FENCE)
    blocks, prose = split_page("page.md", text)
    assert [block.language for block in blocks] == ["sh", "json"]
    assert blocks[0].words == ["test"] and blocks[1].values == {"file": "a.json"}
    assert prose[0] == (1, "# Page")


def load_check_guide():
    loader = importlib.machinery.SourceFileLoader("check_guide", "tests/check_guide")
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("check_guide", loader))
    loader.exec_module(module)
    return module


def check_texts(targets):
    """Each line of a bad page has a fault."""
    lines = ["# Title", "", "A %s." % " ".join(["word"] * 40), "", "See [this](absent.md) and [that](#nowhere).", "",
             "`make chekc` and `core/absent.c`.", "", "    indented"] + [""] * 250
    guide = load_check_guide()
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "page.md")
        with open(path, "w", encoding="utf-8") as stream:
            stream.write("\n".join(lines))
        page = guide.Page(path)
        page.check_size()
        page.check_blocks()
        page.check_sentences()
        page.check_names(targets)
        page.check_links()
    found = " ".join(page.faults)
    for fault in ("lines; at most 250", "indented block", "sentence of 41 words", "no target 'chekc'",
                  "no core/absent.c", "absent.md", "no heading 'nowhere'"):
        assert fault in found, fault


def check_documents(build):
    assert document_fault(build, '{"technique": "direct"}', ["render"]) is None
    assert "there is no such member" in document_fault(build, '{"technik": "direct"}', ["render"])
    assert "no JSON" in document_fault(build, "{", ["render"])
    assert "needs a word" in document_fault(build, "{}", [])


def check_all(build, programs, targets):
    check_outputs()
    check_documents(build)
    check_commands(programs, targets)
    check_blocks()
    check_texts(targets)
