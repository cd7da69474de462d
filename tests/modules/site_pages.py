"""Compares a built documentation site with GitHub's rendering of its sources, and follows every link.

  site_pages.py SITE"""
import collections
import html.parser
import pathlib
import re
import sys
import urllib.parse

import cmarkgfm

COUNTED = {"a", "blockquote", "code", "em", "h1", "h2", "h3", "h4", "img", "li", "pre", "strong", "tr"}
LOADED = {tag: "src" for tag in ("audio", "embed", "iframe", "img", "script", "source", "video")} | {"link": "href"}


class Page(html.parser.HTMLParser):
    """Text and elements of the article (of the whole page if it has no article), and all links and anchors."""

    def __init__(self, text, article):
        super().__init__()
        self.inside, self.headerlink, self.words = not article, False, []
        self.counts, self.links, self.loads, self.anchors = collections.Counter(), [], [], {"", "__skip"}
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        of = dict(attributes)
        self.inside = self.inside or tag == "article"
        self.anchors |= {of[key] for key in ("id", "name") if of.get(key)}
        if tag in LOADED and of.get(LOADED[tag]) and of.get("rel") != "canonical":
            self.loads.append(of[LOADED[tag]])
        if tag == "a" and of.get("href"):
            self.links.append(of["href"])
        if tag == "a" and of.get("class") == "headerlink":
            self.headerlink = True
        elif self.inside and tag in COUNTED and (tag != "a" or of.get("href")):
            self.counts[tag] += 1

    def handle_endtag(self, tag):
        self.inside = self.inside and tag != "article"
        self.headerlink = self.headerlink and tag != "a"

    def handle_data(self, data):
        if self.inside and not self.headerlink:
            self.words.append(data)

    def text(self):
        return "".join("".join(self.words).split())


site, wrong = pathlib.Path(sys.argv[1]), []
pages = {path.relative_to(site).as_posix(): Page(path.read_text(encoding="utf-8"), True)
         for path in sorted(site.rglob("*.html"))}
compared = 0
for name, page in pages.items():
    source = pathlib.Path(re.sub(r"(^|/)index\.html$", r"\1README.html", name)).with_suffix(".md")
    if source.exists():
        markdown = source.read_text(encoding="utf-8")
        github = Page(cmarkgfm.markdown_to_html_with_extensions(
            markdown, options=cmarkgfm.cmark.Options.CMARK_OPT_UNSAFE, extensions=["table"]), False)
        compared += 1
        if github.text() != page.text() or github.counts != page.counts:
            at = next((i for i, (a, b) in enumerate(zip(github.text(), page.text())) if a != b), 0)
            wrong.append(f"{source} differs from GitHub's rendering near '{github.text()[at:at + 40]}': "
                         f"{github.counts - page.counts} missing, {page.counts - github.counts} too many")
    if name == "404.html":
        continue
    for link in page.links + page.loads:
        target = urllib.parse.urlparse(link)
        if target.scheme or target.netloc:
            if link in page.loads:
                wrong.append(f"{name} loads {link}")
            continue
        path = (site / name).parent / urllib.parse.unquote(target.path) if target.path else site / name
        other = path.resolve().relative_to(site.resolve()).as_posix() if path.is_file() else ""
        if not other:
            wrong.append(f"{name} links to {link}, which is no file")
        elif other in pages and urllib.parse.unquote(target.fragment) not in pages[other].anchors:
            wrong.append(f"{name} links to {link}, which has no such anchor")
assert compared > 100 and len(pages) > compared, (compared, len(pages))
sources = {p.as_posix() for p in pathlib.Path("docs").rglob("*.md")}
shown = {re.sub(r"(^|/)index\.html$", r"\1README.html", name).removesuffix(".html") + ".md" for name in pages}
wrong += [f"no page of the site leads to {path}" for path in sorted(sources - shown)]
sys.exit("\n".join(wrong) or None)
