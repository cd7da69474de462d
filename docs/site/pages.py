#!/usr/bin/python3
"""Writes the source folder of the documentation site: all pages reached by links from the README, in Python-Markdown.

    python3 docs/site/pages.py FOLDER    writes FOLDER/pages and FOLDER/mkdocs.yml

Paths are the same as in the repository, so relative links remain valid. A linked source file becomes a page with its
text, a notebook a page with its cells. All broken links are reported at once. The pages are written for GitHub;
Python-Markdown also needs a blank line before a list or table, and four columns of indentation for nested blocks.
"""
import json
import os
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
HOME, MAP = "README.md", "docs/README.md"
LINK = re.compile(r"(?<=\]\()([^()\s#]*)(#[^()\s]*)?(?=\))")
CODE = re.compile(r"(`+)(?!`).*?(?<!`)\1(?!`)")
FENCE = re.compile(r" *(```+|~~~+)")
ITEM = re.compile(r"( *)([-*]|\d+\.)( +)(?=\S)")
LANGUAGES = {".hpp": "cpp", ".cpp": "cpp", ".cmake": "cmake", ".toml": "toml", ".py": "python", ".sh": "bash"}


def fenced(text, language=""):
    """Returns a code block whose fence is longer than any in the text."""
    longest = max((len(run) for run in re.findall(r"~+", text)), default=0)
    fence = "~" * max(3, longest + 1)
    return f"{fence}{language}\n{text.rstrip()}\n{fence}\n"


def page_of_source(path):
    """Returns a source file as Markdown."""
    text = (ROOT / path).read_text(encoding="utf-8")
    if path.endswith(".ipynb"):
        cells = ((cell["cell_type"], "".join(cell["source"])) for cell in json.loads(text)["cells"])
        return "\n\n".join(source if kind == "markdown" else fenced(source, "python") for kind, source in cells)
    name = pathlib.PurePath(path)
    return f"# {name.name}\n\n`{path}`\n\n" + fenced(text, LANGUAGES.get(name.suffix, ""))


def is_page(path):
    """Returns whether the file is a Markdown page."""
    return path.endswith(".md")


def is_picture(path):
    """Returns whether the file is a picture, which is copied unchanged."""
    return path.endswith((".png", ".svg"))


def outside_fences(lines):
    """Yields each line, and whether this line is outside fenced code."""
    fence = ""
    for line in lines:
        mark = FENCE.match(line)
        if not fence and mark:
            fence = mark[1]
            yield line, False
        elif fence:
            if mark and mark[1].startswith(fence) and not line[mark.end():].strip():
                fence = ""
            yield line, False
        else:
            yield line, True


class Site:
    """Pages and pictures reached from the README, with the links between them."""

    def __init__(self):
        self.texts, self.pictures, self.broken = {}, set(), []
        waiting = [HOME]
        while waiting:
            path = waiting.pop()
            if path not in self.texts:
                self.texts[path] = self.read(path, waiting)

    def read(self, path, waiting):
        """Returns the page with links to files of the site, and appends the linked pages to `waiting`."""
        text = (ROOT / path).read_text(encoding="utf-8") if is_page(path) else page_of_source(path)
        if path.endswith((".md", ".ipynb")):
            lines = []
            for number, (line, prose) in enumerate(outside_fences(text.splitlines()), 1):
                lines.append(self.linked(path, number, line, waiting) if prose else line)
            text = "\n".join(lines)
        return text + "\n"

    def linked(self, path, number, line, waiting):
        """Returns the line with each link resolved."""
        codes = [code.span() for code in CODE.finditer(line)]

        def replace(link):
            target, anchor = link[1], link[2] or ""
            if not target or re.match(r"[a-z]+:", target) or any(a <= link.start() < b for a, b in codes):
                return link[0]
            folder = os.path.dirname(path)
            file = os.path.normpath(os.path.join(folder, target))
            if (ROOT / file).is_dir():
                file += "/README.md"
            if file.startswith("..") or not (ROOT / file).is_file():
                self.broken.append(f"broken link {target} at {path}:{number} (no such file): correct the path")
                return link[0]
            if is_picture(file):
                self.pictures.add(file)
                return link[0]
            waiting.append(file)
            return os.path.relpath(file if is_page(file) else file + ".md", folder or ".") + anchor

        return LINK.sub(replace, line)


def for_python_markdown(text):
    """Returns the page with blank lines before lists and tables, and nested blocks indented by four columns a level."""
    lines, levels, before, fence, second = [], [], "", False, False
    for line, prose in outside_fences(text.splitlines()):
        if prose and (not line.strip() or re.fullmatch(r"\s*<!--.*-->\s*", line)):
            lines.append("")
            before, fence, second = "", False, bool(levels)  # the next line is a further paragraph of the list item
            continue
        indent = len(line) - len(line.lstrip(" "))
        opens = not prose and not fence
        item = ITEM.match(line) if prose else None
        if item and before and not levels and item[2][0].isdigit() and item[2] != "1.":
            item = None  # only number 1 interrupts a paragraph
        table = prose and line.startswith("|")
        was_list = bool(levels)
        if item or opens or not before or table or (prose and line.startswith("#")):
            while levels and indent < levels[-1]:
                levels.pop()
        if before and ((item and (second or not was_list)) or (table and not before.startswith("|"))):
            lines.append("")
        if opens:
            line = re.sub(r"(```\w*|~~~\w*) .*", r"\1", line)
        depth, column = len(levels), levels[-1] if levels else 0
        start = item.end() if item else min(column, indent)
        rest = line[start:]
        if prose:  # no heading without a space
            rest = re.sub(r"^( *)(#+[^# ])", r"\1\\\2", rest)
        lines.append(" " * 4 * depth + (item[2].ljust(4) if item else "") + rest)
        if item:
            levels.append(item.end())
            second = False
        before, fence = line, not prose
    return "\n".join(lines) + "\n"


def title_of(text):
    """Returns the first heading of a page."""
    heading = re.search(r"^#+ +(.+)$", text, re.M)
    return re.sub(r"[`*]|\]\([^)]*\)|\[", "", heading[1]) if heading else ""


def navigation(site):
    """Returns the menu: the pages of docs/README.md by kind, then all others by folder."""
    seen, kind, kinds = {HOME, MAP}, "", {}
    for row in re.findall(r"^\| *([^|]*?) *\| *(\[[^|]+)\|", site.texts[MAP], re.M):
        kind = row[0].capitalize() or kind
        for index, (title, link) in enumerate(re.findall(r"\[([^]]+)\]\(([^)#]+)", row[1])):
            page = os.path.normpath(os.path.join("docs", link))
            kinds.setdefault(kind, []).append({title if index == 0 else title_of(site.texts[page]): page})
            seen.add(page)
    for pages in kinds.values():  # decisions and logs are listed after their README
        for entry in pages:
            (title, page), = entry.items()
            others = sorted(p for p in site.texts if os.path.dirname(p) == os.path.dirname(page) and p not in seen)
            if page.startswith("docs/") and page.endswith("README.md") and others:
                entry[title] = [{"Overview": page}] + [{title_of(site.texts[p]): p} for p in others]
                seen.update(others)
    folders = {}
    for page in sorted(p for p in site.texts if p not in seen and is_page(p)):
        folder = page.split("/")[0] if "/" in page else ""
        title = page.removesuffix("/README.md") if page.endswith("/README.md") else title_of(site.texts[page])
        folders.setdefault(folder, []).append({title: page})
    top = [{"Map of the documentation": MAP}] + folders.pop("", [])
    menu = [{name: pages if len(pages) > 1 else list(pages[0].values())[0]} for name, pages in kinds.items()]
    return [{"Home": HOME}] + menu + [{"Sources": top + [{name: pages} for name, pages in folders.items()]}]


def main():
    """Writes the folder of the site."""
    if len(sys.argv) != 2:
        sys.exit("one folder is needed at docs/site/pages.py (it writes the site's pages there): give its path")
    out = pathlib.Path(sys.argv[1]).resolve()
    site = Site()
    if site.broken:
        sys.exit("\n".join(site.broken))
    for path, text in site.texts.items():
        file = out / "pages" / (path if is_page(path) else path + ".md")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(for_python_markdown(text), encoding="utf-8")
    for path in site.pictures:
        file = out / "pages" / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes((ROOT / path).read_bytes())
    folder = ROOT / "docs/site"
    config = {"INHERIT": str(folder / "mkdocs.yml"), "docs_dir": str(out / "pages"),
              "theme": {"custom_dir": str(folder / "theme")}, "nav": navigation(site)}
    (out / "mkdocs.yml").write_text(json.dumps(config), encoding="utf-8")


if __name__ == "__main__":
    main()
