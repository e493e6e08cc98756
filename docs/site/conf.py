"""The site: Sphinx runs with this file from the top of the tree (scripts/docs), so that links lead where they do in the tree.

Pages are those of the tree (MyST); the C reference comes from the comments of the header (header.py), the
Python reference from the package (autodoc).
"""

import os
import re
import sys

here = os.path.dirname(os.path.abspath(__file__))
top = os.path.dirname(os.path.dirname(here))
sys.path[:0] = [here, os.path.join(top, "python")]

with open(os.path.join(top, "capi", "holonomic.h")) as file:
    release = ".".join(re.findall(r"#define HOL_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", file.read()))
project = "holonomic"
version = release
copyright = "the authors of holonomic"

extensions = ["myst_parser", "sphinx.ext.autodoc", "header", "package"]
root_doc = "docs/site/index"
include_patterns = [
    "docs/site/*.rst", "README.md", "CHANGELOG.md", "CONTRIBUTING.md", "docs/**.md", "examples/**.md", "hosts/*/README.md", "python/README.md",
    "core/**/README.md", "tests/oracle/**README.md",
]
exclude_patterns = ["build", ".git", "bench", "docs/development/archive"]

myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # pages may begin with small headings
highlight_language = "none"
autodoc_member_order = "bysource"
autodoc_typehints = "none"  # what arrays they take is said in words
autodoc_mock_imports = ["ase"]

html_theme = "sphinx_rtd_theme"
html_title = f"holonomic {release}"
html_static_path = ["pages.css"]
html_css_files = ["pages.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"navigation_depth": 3, "collapse_navigation": True, "style_external_links": False}


def setup(app):
    """A folder of the tree has no page: its name is text. All else that leads nowhere is an error."""

    def folder(app, env, node, text):
        page = os.path.dirname(env.doc2path(node.get("refdoc", root_doc)))
        return text if os.path.isdir(os.path.join(page, node["reftarget"])) else None

    app.connect("missing-reference", folder)
