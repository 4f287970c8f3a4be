"""Builds the documentation as one site with a search: `build.py [OUT]`, by default `target/site`.

Needs mdbook and latex2mathml. The pages are those of SUMMARY.md as they are in the repository; formulas become MathML, so that no page
loads anything from a network. Fails if a page links to something that the site lacks.
"""

import html.parser
import os
import pathlib
import re
import shutil
import subprocess
import sys
import urllib.parse

from latex2mathml.converter import convert

SITE = pathlib.Path(__file__).resolve().parent
ROOT = SITE.parent.parent
OUT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/site").resolve()
LINK = re.compile(r"\[([^\]]*)\]\(([^)\s]+)\)")
# Code, which stays as it is, or a formula.
FORMULA = re.compile(r"```.*?```|`[^`]*`|\$\$(.+?)\$\$|\$([^$]+)\$", re.DOTALL)


def formula(found):
    """MathML of a formula; code as it is."""
    block, line = found.groups()
    if block or line:
        return convert(block or line, display="block" if block else "inline")
    return found[0]


def as_index(path):
    """A folder's page has another name in the site."""
    return path.replace("README.md", "index.md")


def stage(source):
    """Copies the pages, and the files that they link to, to where mdbook reads them."""
    summary = (SITE / "SUMMARY.md").read_text()
    pages = [path for _, path in LINK.findall(summary)]
    for page in pages:
        def link(found):
            words, path = found[1], found[2].split("#")[0]
            target = (ROOT / page).parent / path
            if ":" in path or not path:
                return found[0]
            if target.is_dir():
                return words
            if target.suffix == ".md":
                return as_index(found[0])
            copy = source / os.path.relpath(target.resolve(), ROOT)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(target, copy)
            return found[0]

        text = LINK.sub(link, (ROOT / page).read_text())
        if page == "docs/theory.md":
            text = FORMULA.sub(formula, text)
        path = source / as_index(page)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    (source / "SUMMARY.md").write_text(as_index(summary))


class Links(html.parser.HTMLParser):
    """What a page of the site links to, and the names of its places."""

    def __init__(self, path):
        super().__init__()
        self.links, self.ids = [], set()
        self.feed(path.read_text())

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if name in ("href", "src") and value:
                self.links.append(value)
            if name == "id":
                self.ids.add(value)


def dead_links():
    """Links within the site that lead nowhere."""
    pages = {path: Links(path) for path in OUT.rglob("*.html") if path.name not in ("print.html", "404.html", "toc.html")}
    for path, page in pages.items():
        for link in page.links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
            known = pages[target].ids if target in pages else None
            if not target.exists() or (parts.fragment and known is not None and parts.fragment not in known):
                yield f"{path.relative_to(OUT)}: {link}"


shutil.rmtree(OUT, ignore_errors=True)
book = OUT.with_name(OUT.name + "-source")
shutil.rmtree(book, ignore_errors=True)
(book / "src").mkdir(parents=True)
shutil.copy(SITE / "book.toml", book)
stage(book / "src")
subprocess.run(["mdbook", "build", "--dest-dir", OUT, book], check=True)
dead = sorted(dead_links())
print("\n".join(dead) or f"{OUT}/index.html: every link within the site leads somewhere")
sys.exit(1 if dead else 0)
