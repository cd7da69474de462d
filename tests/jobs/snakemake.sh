#!/usr/bin/env bash
# configs/workflows/Snakefile makes a dataset in parts, equal to that of `swingbank generate`.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
export PATH=$SWINGBANK_BIN:$PATH OMP_NUM_THREADS=1 HOME=$work
config=$SWINGBANK_SOURCE/configs/datasets/ieee14_genrou_bus3.toml
cd "$work"
# Debian's own Python, for which the package is built
/usr/bin/python3 /usr/bin/snakemake -s "$SWINGBANK_SOURCE/configs/workflows/Snakefile" --cores 2 --quiet \
  --config "dataset=$config" draws=2000 out=data parts=3 >"$work/log" 2>&1 || fail "$(tail -20 "$work/log")"
"$swingbank" generate "$config" --draws 2000 --out whole --progress none >/dev/null 2>&1
diff -r whole/shards data/shards || fail "other bytes"
grep -q "$(swingbank verify whole | grep -o 'dataset [0-9a-f]*$')" data.verified || fail "another hash: $(cat data.verified)"
