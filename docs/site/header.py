"""The C header as a page. Directive `header`: its conventions, then everything that it declares under the headings that stand in
it, each function with the examples that call it. Directive `examples`: these programs."""

import glob
import os
import re

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.util.docutils import SphinxDirective
from sphinx.util.nodes import nested_parse_with_titles

_COMMENT = re.compile(r"/\*\*(.*?)\*/\n(.*?)(?=\n\n|\n/\*|\Z)", re.S)
_NAME = re.compile(r"\b(hol_\w*[a-z])\b(\(\))?")


class Declared:
    """A comment and what is declared after it."""

    def __init__(self, comment, code):
        lines = [re.sub(r"^ ?\* ?", "", line) for line in comment.strip("\n").split("\n")]
        lines[0] = lines[0].strip()
        while lines and not lines[-1].strip():
            lines.pop()
        self.text, self.arguments, self.result = [], [], []
        part = self.text
        for line in lines:
            argument = re.match(r"@param(?:\[([a-z,]*)\])? *(\w+(?:, *\w+)+(?= )|\w+) *(.*)", line)
            if argument:
                self.arguments.append((argument.group(2), argument.group(1), [argument.group(3)]))
                part = self.arguments[-1][2]
            elif line.startswith("@return"):
                part = self.result
                part.append(line[len("@return"):].strip())
            elif line.startswith("@file"):
                continue
            else:
                part = self.text if not line.strip() else part
                part.append(line.rstrip() if part is self.text else line.strip())
        code = re.sub(r"HOL_API | HOL_IS_INT|^static inline (?=.*\()", "", code, flags=re.M)
        code = re.sub(r" \{\n    (?:return|hol_).*?\n\}", ";", code, flags=re.S)  # bodies of functions
        self.functions = [" ".join(one.split()) for one in re.findall(r"^(?!typedef)\w[^;{]*\)(?=;)", code, re.M)]
        self.type = re.search(r"^typedef (enum|struct) (hol_\w+)", code, re.M)
        self.code = code


def declared(path):
    """The conventions, and (heading, [Declared]) for each part."""
    with open(path) as file:
        text = file.read()
    pieces = re.split(r"^/\* -+ (.*) \*/$", text, flags=re.M)
    conventions = Declared(*_COMMENT.search(pieces[0]).groups())
    parts = []
    for heading, piece in zip(pieces[1::2], pieces[2::2]):
        parts.append((heading[0].upper() + heading[1:], [Declared(*found.groups()) for found in _COMMENT.finditer(piece)]))
    return conventions, parts


def prose(text):
    """Signs of RST are text; functions and pages are links, constants code."""
    text = re.sub(r"([\\*|`])", r"\\\1", text)
    text = re.sub(r"_(?!\w)", r"\\_", text)
    text = re.sub(r"\bHOL_[A-Z_]+\b", r"``\g<0>``", text)
    text = re.sub(r"\bdocs/(\w+)\.md", r":doc:`\1 </docs/\1>`", text)
    return re.sub(r"(?<![\w/`])(hol_\w*[a-z])\b(?!\.[a-z])(\(\))?", r":c:expr:`\1`", text)


def paragraphs(lines):
    """Lines of a comment as RST: items stay items, deeper lines are equations."""
    out, literal, item = [], False, False
    for line in lines:
        deep = line.startswith("    ") and not item
        if deep and not literal:
            out += ["", "::", ""]
        elif not deep and literal:
            out.append("")
        literal = deep
        if line.startswith("- "):
            if not item:
                out.append("")
            item = True
        elif line and not line.startswith(" "):
            if item:
                out.append("")
            item = False
        out.append(line if deep else prose(line))
    return out


def rst_of(thing, calls):
    names = [re.search(r"(hol_\w+)\(", one).group(1) for one in thing.functions]
    if thing.functions:
        lines = [f".. c:function:: {thing.functions[0]}"] + [f"              {one}" for one in thing.functions[1:]]
    elif thing.type:
        lines = [f".. c:{thing.type.group(1)}:: {thing.type.group(2)}"]
    else:
        return []
    body = paragraphs(thing.text) + [""]
    if thing.type and "{" in thing.code:
        shown = re.sub(r"/\*\*<", "/*", thing.code)
        body += [".. code-block:: c", ""] + ["   " + line for line in shown.split("\n")] + [""]
    for name, way, words in thing.arguments:
        body += [f":{name}: {f'({way}) ' if way else ''}" + prose(" ".join(words))]
    if thing.arguments:
        body += [""]
    if thing.result:
        body += ["Returns " + prose(" ".join(thing.result)), ""]
    shown = sorted({example for name in names for example in calls.get(name, [])})
    shown = [example for example in shown if f"hol_{example}" in names] or shown[:2]  # the one that is about it
    if shown:
        body += ["Example: " + ", ".join(f":ref:`{example}.c <example-{example}>`" for example in shown), ""]
    return lines + [""] + ["   " + line if line else "" for line in body] + [""]


def examples(folder):
    """Which programs call a function."""
    calls = {}
    for path in sorted(glob.glob(os.path.join(folder, "*.c"))):
        with open(path) as file:
            for name in set(re.findall(r"\b(hol_\w+)\(", file.read())):
                calls.setdefault(name, []).append(os.path.splitext(os.path.basename(path))[0])
    return calls


class Page(SphinxDirective):
    def lines(self, folder):
        raise NotImplementedError

    def run(self):
        section = nodes.section()
        section.document = self.state.document
        lines = self.lines(os.path.join(self.env.srcdir, "examples", "functions"))
        nested_parse_with_titles(self.state, StringList(lines, source=self.env.docname), section)
        return section.children


def heading(text):
    return [text, "-" * len(text), ""]


class Header(Page):
    def lines(self, folder):
        path = os.path.join(self.env.srcdir, "capi", "holonomic.h")
        self.env.note_dependency(path)
        calls = examples(folder)
        conventions, parts = declared(path)
        lines = heading("Conventions of all functions") + paragraphs(conventions.text) + [""]
        for title, things in parts:
            lines += heading(title)
            for thing in things:
                lines += rst_of(thing, calls)
        return lines


class Examples(Page):
    def lines(self, folder):
        lines = []
        for path in sorted(glob.glob(os.path.join(folder, "*.c"))):
            self.env.note_dependency(path)
            name = os.path.splitext(os.path.basename(path))[0]
            lines += [f".. _example-{name}:", ""] + heading(f"{name}.c")
            lines += [f".. literalinclude:: /examples/functions/{name}.c", "   :language: c", ""]
        return lines


def setup(app):
    app.add_directive("header", Header)
    app.add_directive("examples", Examples)
    return {"parallel_read_safe": True}
