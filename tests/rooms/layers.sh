#!/usr/bin/env bash
# A room sees its own files and the public headers of the rooms it names; anything else must not compile. Each line of
# `forbidden` is a source compiled with the very options of a room and one include that must not be found; each line of
# `allowed` proves that the same way of compiling finds what it may.
set -euo pipefail
build=${SWINGBANK_BIN:?}/..
source=${SWINGBANK_SOURCE:?}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# compile ROOM-SOURCE HEADER: with the options of that source.
compile() {
  printf '#include "%s"\n' "$2" >"$work/try.cpp"
  python3 - "$build/compile_commands.json" "$source/$1" "$work/try.cpp" <<'PYTHON'
import json, shlex, subprocess, sys
commands, source, attempt = sys.argv[1:]
def compiles(file):  # by itself, or as one of several (CMAKE_UNITY_BUILD)
    return file == source or "/Unity/" in file and f'"{source}"' in open(file).read()
entry = next(e for e in json.load(open(commands)) if compiles(e["file"]))
source = entry["file"]
words = [w for w in shlex.split(entry["command"])]
at = next(i for i, w in enumerate(words) if w.startswith("-D") or w.startswith("-I"))
kept, skip = [words[at - 1]], False
for word in words[at:]:
    if skip or word in (source, "-c"):
        skip = False
    elif word in ("-o", "-include"):
        skip = True
    else:
        kept.append(word)
done = subprocess.run(kept + ["-fsyntax-only", attempt], cwd=entry["directory"], capture_output=True, text=True)
sys.stderr.write(done.stderr)
sys.exit(done.returncode)
PYTHON
}

failed=0
while read -r from header; do
  if compile "$from" "$header" 2>"$work/said"; then
    echo "$from can include $header: a room must not see that" >&2
    failed=1
  elif ! grep -q "$header: No such file" "$work/said"; then
    cat "$work/said" >&2
    echo "$from with $header fails for another reason than a header out of sight" >&2
    failed=1
  fi
done <<'FORBIDDEN'
base/config.cpp sim/core/effect.hpp
sim/core/effect.cpp validate/record/record.hpp
sim/lanes/batch.cpp validate/fit/fit.hpp
mpi/store/dataset.cpp mpi/ranks/generate.hpp
validate/record/record.cpp validate/fit/fit.hpp
validate/report/page.cpp validate/diagnose/diagnose.hpp
validate/diagnose/diagnose.cpp validate/blind/score/score.hpp
validate/calibrate/calibrate.cpp validate/fit/detail/cost.hpp
FORBIDDEN
while read -r from header; do
  if ! compile "$from" "$header"; then
    echo "$from cannot include $header, which it names" >&2
    failed=1
  fi
done <<'ALLOWED'
validate/calibrate/calibrate.cpp validate/fit/fit.hpp
validate/fit/fit.cpp validate/fit/detail/cost.hpp
sim/core/effect.cpp base/problem.hpp
ALLOWED
exit "$failed"
