#!/usr/bin/env bash
# Words that have a standard term (docs/glossary.md, CONTRIBUTING.md) appear in no heading of a document and in no new identifier.
# tests/modules/words_kept.txt lists identifiers in which such a word has its standard meaning, with the meaning.
set -euo pipefail
cd "${SWINGBANK_SOURCE:?}"
/usr/bin/python3 - <<'PYTHON'
import pathlib
import re
import subprocess
import sys

WORDS = {  # word in an identifier or heading -> standard term
    "answer": "response", "basin": "local optimum", "belief": "prior", "bent": "biased", "course": "time series, plan",
    "direction": "sensitivity parameter", "drive": "playback", "driven": "playback", "fewest": "least number, sparse selection",
    "instant": "switching time", "jump": "step", "law": "user-defined model", "misfit": "reduced chi-square",
    "neutral": "null value", "night": "nightly", "odd": "unlisted", "rival": "competitor", "room": "module",
    "slope": "sensitivity", "smear": "filter", "smeared": "filtered", "tell": "report", "told": "given",
}
TOKEN = re.compile(
    r'R"(?P<d>[^()\\ ]{0,16})\((?:.|\n)*?\)(?P=d)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|//[^\n]*|/\*(?:.|\n)*?\*/|(?P<id>[A-Za-z_]\w*)')
TEST_NAME = re.compile(r"^(TEST(?:_[FP])?\(\w+,\s*)\w+\)", re.M)


def listed(words):
    found = set()
    for word in words:
        word = word.lower()
        found |= {w for w in (word, word[:-1] if word.endswith("s") else word) if w in WORDS}
    return found


def parts(identifier):
    return re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", identifier)


files = subprocess.run(["git", "ls-files"], check=True, capture_output=True, text=True).stdout.splitlines()
identifiers = {}
for name in files:
    if name.endswith((".cpp", ".hpp")):
        text = TEST_NAME.sub(r"\1_)", pathlib.Path(name).read_text())
        for match in TOKEN.finditer(text):
            identifier = match["id"]
            if identifier and identifier not in identifiers and listed(parts(identifier)):
                identifiers[identifier] = f"{name}:{text.count(chr(10), 0, match.start()) + 1}"
kept_file = pathlib.Path("tests/modules/words_kept.txt")
kept = {line.split()[0] for line in kept_file.read_text().splitlines() if line and not line.startswith("#")}
failed = False
for identifier in sorted(set(identifiers) - kept):
    words = listed(parts(identifier))
    terms = "; ".join(f"{w}: {WORDS[w]}" for w in sorted(words))
    print(f"home-made word in {identifier} at {identifiers[identifier]} ({terms}): use the standard term", file=sys.stderr)
    failed = True
for identifier in sorted(kept - set(identifiers)):
    print(f"unused entry {identifier} at {kept_file} (no file contains it): remove the line", file=sys.stderr)
    failed = True
for name in files:
    if name.endswith(".md") and not name.startswith(("docs/log/", "docs/tables/")):
        fenced = False
        for number, line in enumerate(pathlib.Path(name).read_text().splitlines(), 1):
            fenced ^= line.startswith("```")
            heading = re.match(r"#+ (.*)", line)
            if heading and not fenced:
                for word in sorted(listed(re.findall(r"[A-Za-z]+", re.sub(r"`[^`]*`|\S+/\S+", "", heading[1])))):
                    print(f"home-made word '{word}' at {name}:{number} (a heading; {WORDS[word]}): use the standard term", file=sys.stderr)
                    failed = True
sys.exit(failed)
PYTHON
