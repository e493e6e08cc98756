#!/usr/bin/env python3
"""Every local link of HTML pages leads to a file of their folder, and to a name in it if it gives one.

    html_links.py FOLDER
"""

import os
import sys
from html.parser import HTMLParser
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.links, self.names = set(), set()
        with open(path, encoding="utf-8") as file:
            self.feed(file.read())

    def handle_starttag(self, tag, attributes):
        for key, value in attributes:
            if key in ("href", "src") and value:
                self.links.add(value)
            elif key == "id" or (key == "name" and tag == "a"):
                self.names.add(value)


folder = sys.argv[1]
pages = {}
for where, folders, files in os.walk(folder):
    folders[:] = [name for name in folders if not name.startswith(".")]
    pages.update((os.path.join(where, name), None) for name in files if name.endswith(".html"))
for path in pages:
    pages[path] = Page(path)
dead = n = 0
for path, page in sorted(pages.items()):
    for link in sorted(page.links):
        parts = urlsplit(link)
        if parts.scheme or parts.netloc:
            continue
        n += 1
        target = os.path.normpath(os.path.join(os.path.dirname(path), unquote(parts.path))) if parts.path else path
        there = os.path.exists(target)
        if there and parts.fragment and target in pages:
            there = unquote(parts.fragment) in pages[target].names
        if not there:
            print(f"{os.path.relpath(path, folder)}: {link} leads nowhere")
            dead += 1
print(f"{n} links in {len(pages)} pages, {dead} of them dead")
sys.exit(0 if n and not dead else 1)
