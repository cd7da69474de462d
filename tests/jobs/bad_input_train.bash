# To be sourced after lib.bash: a tiny experiment and its dataset, for tests with bad input.
# shellcheck disable=SC2034,SC2154 # work and swingbank are lib.bash's
source "$(dirname "${BASH_SOURCE[0]}")/tiny_experiment.bash"
export OMP_NUM_THREADS=1

tiny_experiment "$work"
experiment=$work/tiny.toml data=$work/data out=$work/out
"$swingbank" generate "$work/tiny_data.toml" --draws 100 --out "$data" >/dev/null 2>&1
mkdir "$out"
# validate DATA EXPERIMENT [OPTION...]
validate() { "$swingbank" cross-validate "$1" --experiment "$2" --out "$out" "${@:3}"; }
# edit NAME SED: writes the experiment, changed by SED, as NAME.toml
edit() { sed "$2" "$experiment" >"$work/$1.toml"; }
