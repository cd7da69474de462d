#!/usr/bin/env bash
# Named constants are unique: two constants of the same name have the same value in all modules. Pi, a full turn and
# the quantiles of the normal distribution are written in base/constants.hpp only. Thresholds of a verdict are defined
# in validate/thresholds only.
set -euo pipefail
cd "${SWINGBANK_SOURCE:?}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cat >"$work/check.py" <<'PYTHON'
import collections, pathlib, re, sys

root = pathlib.Path(sys.argv[1])
arithmetic = r"(?:double|float|long double|int|unsigned|char|std::size_t|std::u?int\d+_t|Eigen::Index)"
literals = re.compile(r"(?<![\d.])(?:3\.1415|6\.283|1\.9599|1\.96(?!\d)|2\.575|57\.29)")
files = [f for module in ("base", "sim", "mpi", "train", "validate", "research", "jobs") for f in sorted((root / module).rglob("*.?pp"))]

def parts(text):
    """The declarators of one declaration, cut at the commas outside brackets."""
    depth, all = 0, [""]
    for c in text:
        depth += (c in "([{") - (c in ")]}")
        if c == "," and depth == 0:
            all.append("")
        else:
            all[-1] += c
    return [p for p in all if re.match(r"\s*k[A-Z]\w*\s*=", p)]

def number(text):
    try:
        return float(eval(text, {"__builtins__": {}}))
    except Exception:
        return " ".join(text.split())

values, failed = collections.defaultdict(lambda: collections.defaultdict(set)), []
for file in files:
    name = str(file.relative_to(root))
    text = re.sub(r"//[^\n]*", "", file.read_text())
    if name != "base/constants.hpp":
        for found in literals.findall(text):
            failed.append(f"{name} writes {found}...: take it from base/constants.hpp")
    for declaration in re.findall(rf"constexpr\s+{arithmetic}\s+(k[A-Z]\w*\s*=[^;]*);", text):
        for part in parts(declaration):
            constant, value = (p.strip() for p in part.split("=", 1))
            values[constant][number(value)].add(name)
for constant, by_value in values.items():
    if len(by_value) > 1 and len(set().union(*by_value.values())) > 1:
        failed.append(f"{constant} has several values: " + "; ".join(f"{v} in {', '.join(sorted(f))}" for v, f in by_value.items()))
header = (root / "validate/thresholds/thresholds.hpp").read_text()
fields = re.findall(r"Threshold (\w+)\{\s*\"(\w+)\.(\w+)\"", header)
assert len(fields) > 40, f"{len(fields)} thresholds read"
for field, stage, printed in fields:
    if field != printed:
        failed.append(f"the threshold {field} is printed as {stage}.{printed}")
    camel = lambda words: "".join(w.capitalize() for w in words.split("_"))
    for constant, folder in (("k" + camel(field), "validate/"), ("k" + camel(stage) + camel(field), "")):
        for where in sorted(f for f in set().union(*values[constant].values()) if f.startswith(folder)):
            failed.append(f"{constant} in {where}: {stage}.{field} stands in validate/thresholds")
print("\n".join(failed))
sys.exit(bool(failed))
PYTHON

# violations in a copy of the sources, which the check must refuse
plant() {
  rm -rf "$work/tree" && mkdir "$work/tree" && cp -r base sim mpi train validate research jobs "$work/tree"
  printf '%s\n' "$2" >"$work/tree/$1"
  if python3 "$work/check.py" "$work/tree" >"$work/said"; then
    echo "the check does not see '$2'" >&2
    exit 1
  fi
  grep -q "$1" "$work/said" || { cat "$work/said" >&2 && exit 1; }
}
plant base/planted.hpp 'constexpr double kStates = 5;'
plant jobs/planted.cpp 'double x = 2 * 3.14159265;'
plant validate/fit/planted.cpp 'constexpr double kOther = 1, kEvidenceAccepted = 40;'

python3 "$work/check.py" . >&2
