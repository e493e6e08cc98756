"""The Python package for autodoc: imported without its library, its comments as they stand."""

import ctypes
import re


class _Function:
    restype = argtypes = None

    def __call__(self, *arguments):
        return 10**6  # of hol_version_number: young enough


class _Library:
    def __getattr__(self, name):
        return _Function()

    def __getitem__(self, name):
        return _Function()


def _import():
    real, ctypes.CDLL = ctypes.CDLL, lambda *arguments, **options: _Library()
    try:
        import holonomic  # noqa: F401
    finally:
        ctypes.CDLL = real


def as_it_stands(app, what, name, thing, options, lines):
    """Comments are plain text: names in single quotes are code, paragraphs with columns or deeper lines keep their lines."""
    text = "\n".join(lines)
    paragraphs = []
    for paragraph in re.split(r"\n\s*\n", text):
        if re.search(r"\S {2,}\S", paragraph) or re.search(r"^ {2,}\S", paragraph, re.M):
            paragraph = "::\n\n" + "\n".join("    " + line for line in paragraph.split("\n"))
        else:
            words = re.split(r"(`[^`]+`)", paragraph)
            paragraph = "".join(f"`{word}`" if word[:1] == "`" else re.sub(r"([\\*_|])", r"\\\1", word) for word in words)
        paragraphs.append(paragraph)
    lines[:] = "\n\n".join(paragraphs).split("\n") + [""]


def setup(app):
    _import()
    app.connect("autodoc-process-docstring", as_it_stands)
    return {"parallel_read_safe": True}
