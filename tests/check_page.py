#!/usr/bin/env python3
"""Checks that an HTML page needs nothing but itself, and prints what is on it.

    check_page.py FILE

Prints JSON: counts of elements, texts of headings and preformatted blocks. Exit status 1 and a line on standard error
for a reference to anything outside, a script, a link within that leads nowhere, or elements that are not closed.
"""
import collections
import html.parser
import json
import re
import sys

VOID = {"img", "meta", "br", "input", "line", "link", "hr", "wbr"}
FORBIDDEN = {"script", "link", "iframe", "object", "embed", "base", "video", "audio"}
REFERENCES = {"src", "href", "xlink:href", "srcset", "poster", "data", "action", "background"}


class Page(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.ids, self.links = [], set(), set()
        self.counts = collections.Counter()
        self.texts = collections.defaultdict(list)
        self.problems = []

    def handle_starttag(self, tag, attributes):
        self.counts[tag] += 1
        if tag in FORBIDDEN:
            self.problems.append("there is a <%s>" % tag)
        for name, value in attributes:
            if name in REFERENCES and not (value or "").startswith(("#", "data:")):
                self.problems.append("%s=%r leads outside" % (name, (value or "")[:60]))
            if name in REFERENCES and (value or "").startswith("#"):
                self.links.add(value[1:])
            if name.startswith("on"):
                self.problems.append("%s is a script" % name)
            if name == "id":
                if value in self.ids:
                    self.problems.append("id %s is there twice" % value)
                self.ids.add(value)
            if name == "style":
                self.check_style(value)
        if tag == "img" and not dict(attributes).get("alt"):
            self.problems.append("a picture has no words")
        if tag not in VOID:
            self.open.append(tag)
            if tag in ("h1", "h2", "pre", "title", "text"):
                self.texts[tag].append("")

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.handle_endtag(tag)

    def handle_endtag(self, tag):
        if not self.open or self.open[-1] != tag:
            self.problems.append("</%s> closes %s" % (tag, self.open[-1:]))
        else:
            self.open.pop()

    def handle_data(self, data):
        if self.open and self.open[-1] in self.texts:
            self.texts[self.open[-1]][-1] += data
        if self.open and self.open[-1] == "style":
            self.check_style(data)

    def check_style(self, text):
        if re.search(r"url\(|@import|expression\(", text or ""):
            self.problems.append("a style refers to something outside")


def main():
    with open(sys.argv[1], encoding="utf-8") as f:
        text = f.read()
    page = Page()
    page.feed(text)
    page.close()
    if page.open:
        page.problems.append("not closed: %s" % page.open)
    page.problems += ["#%s leads nowhere" % link for link in sorted(page.links - page.ids)]
    if page.problems:
        sys.exit("check_page: " + "; ".join(page.problems[:10]))
    print(json.dumps({"counts": page.counts, "texts": page.texts}))


if __name__ == "__main__":
    main()
