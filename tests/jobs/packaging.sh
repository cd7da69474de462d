#!/usr/bin/env bash
# packaging/: the Apptainer definition, as far as possible without Apptainer; ranks of another MPI's launcher are
# refused.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
folder=$SWINGBANK_SOURCE/packaging

source "$(dirname "${BASH_SOURCE[0]}")/apptainer.bash"
for section in post environment test runscript; do
  { echo '#!/bin/sh'; section_of "$section"; } >"$work/$section.sh"
  (($(wc -l <"$work/$section.sh") > 1)) || fail "no %$section"
  sh -n "$work/$section.sh" || fail "%$section is no script"
  if command -v shellcheck >/dev/null; then shellcheck -s sh -S warning "$work/$section.sh" || fail "%$section"; fi
done
grep -q '^From: debian:12$' "$folder/swingbank.def" || fail "not Debian 12"
# %files names the Debian packages of the programs, in the build folder of a preset
section_of files >"$work/files"
read -r file target <"$work/files"
[[ $(wc -l <"$work/files") == 1 && $file =~ ^build/([a-z]+)/swingbank\*_\*\.deb$ && $target == /packages/ ]] ||
  fail "%files: $(cat "$work/files")"
grep -q "\"name\": \"${BASH_REMATCH[1]}\"" "$SWINGBANK_SOURCE/CMakePresets.json" || fail "no preset ${BASH_REMATCH[1]}"
[[ $("$swingbank" effects) == *GENROU* ]] || fail "%test would fail"
echo "ok: Apptainer definition"

for variable in PMI_SIZE OMPI_COMM_WORLD_SIZE; do
  refuses "ranks of another launcher ($variable)" "unconnected ranks at the launcher .*$variable it started 4" \
    env $variable=4 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "$SWINGBANK_BIN/swingbank-generate" \
    "$SWINGBANK_SOURCE/configs/datasets/ieee39_gencls.toml" --draws 10 --out "$work/data"
  [[ ! -e $work/data ]] || fail "a refused command wrote data"
done
