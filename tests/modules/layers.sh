#!/usr/bin/env bash
# A module sees its own files and the public headers of the modules that it names; any other include must not compile.
# Each line of `forbidden` names a source and a header that must not be found with the options of that source. Each
# line of `allowed` names a header that must be found in the same way.
set -euo pipefail
build=${SWINGBANK_BIN:?}/..
source=${SWINGBANK_SOURCE:?}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# try_all FILE: for each line (a source and a header) adds whether the header was found, and otherwise the compiler's
# message. The preprocessor suffices, because only the search for the header is tested.
try_all() {
  python3 - "$build/compile_commands.json" "$source" "$work/try.cpp" "$1" <<'PYTHON'
import json, shlex, subprocess, sys
commands, source, attempt, wanted = sys.argv[1:]
entry_of = {}
for entry in json.load(open(commands)):  # a single source, or several in one unit (CMAKE_UNITY_BUILD)
    entry_of.setdefault(entry["file"], entry)
    if "/Unity/" in entry["file"]:
        for line in open(entry["file"]):
            if line.startswith("#include"):
                entry_of.setdefault(line.split('"')[1], entry)
for line in open(wanted):
    module_source, header = line.split()
    entry = entry_of[f"{source}/{module_source}"]
    words = shlex.split(entry["command"])
    at = next(i for i, w in enumerate(words) if w.startswith("-D") or w.startswith("-I"))
    kept, skip = [words[at - 1]], False
    for word in words[at:]:
        if skip or word in (entry["file"], "-c"):
            skip = False
        elif word in ("-o", "-include"):
            skip = True
        else:
            kept.append(word)
    with open(attempt, "w") as file:
        file.write(f'#include "{header}"\n')
    done = subprocess.run(kept + ["-E", "-o", "/dev/null", attempt], cwd=entry["directory"], capture_output=True, text=True)
    print(module_source, header, "found" if done.returncode == 0 else " ".join(done.stderr.split()))
PYTHON
}

cat >"$work/forbidden" <<'FORBIDDEN'
base/config.cpp sim/core/effect.hpp
sim/core/effect.cpp validate/record/record.hpp
sim/batch/batch.cpp validate/fit/fit.hpp
mpi/store/dataset.cpp mpi/ranks/generate.hpp
validate/record/record.cpp validate/fit/fit.hpp
validate/report/html.cpp validate/diagnose/diagnose.hpp
validate/diagnose/diagnose.cpp research/blind/score/score.hpp
validate/calibrate/calibrate.cpp validate/fit/detail/cost.hpp
FORBIDDEN
cat >"$work/allowed" <<'ALLOWED'
validate/calibrate/calibrate.cpp validate/fit/fit.hpp
validate/fit/fit.cpp validate/fit/detail/cost.hpp
sim/core/effect.cpp base/problem.hpp
ALLOWED
failed=0
try_all "$work/forbidden" >"$work/tried"
while read -r from header said; do
  if [[ $said == found ]]; then
    echo "$from can include $header: a module must not see that" >&2
    failed=1
  elif [[ $said != *"$header: No such file"* ]]; then
    echo "$from with $header fails for another reason than a missing header: $said" >&2
    failed=1
  fi
done <"$work/tried"
try_all "$work/allowed" >"$work/tried"
while read -r from header said; do
  if [[ $said != found ]]; then
    echo "$from cannot include $header, which it names: $said" >&2
    failed=1
  fi
done <"$work/tried"
exit "$failed"
