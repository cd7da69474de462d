# To be sourced by the tests of verdicts and their pages, after lib.bash.
# shellcheck disable=SC2154 # work, swingbank are lib.bash's
bent=$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml
one=$SWINGBANK_SOURCE/configs/records/record-example/avr_ev1.csv
export OMP_NUM_THREADS=2
# sexs K: the same plant with its exciter, of gain K. The errors of its values are within a grid code's limits, but
# exceed the noise.
sexs() { cat "$bent"; printf '[exciter]\neffect = "SEXS"\nTAoverTB = 0.1\nTB = 10\nK = %s\nTE = 0.05\nEMIN = -4\nEMAX = 5\n' "$1"; }
sexs 100 >"$work/right.toml"

# gives CODE SENTENCE COMMAND...: this exit code, and a line with this sentence
gives() {
  local expected=$1 said=$2 code=0
  shift 2
  rm -rf "$work/out"
  "$@" --out "$work/out" >"$work/text" 2>"$work/notes" || code=$?
  ((code == expected)) || fail "exit code $code, expected $expected: $* said: $(tail -n 3 "$work/text" "$work/notes")"
  grep -q -- "$said" "$work/text" || fail "'$said' is not in: $(cat "$work/text")"
}
calibrate() { "$swingbank" calibrate --model "$work/right.toml" --records "$one" --power-only --draws 0 --starts 0 "$@"; }
compare() { "$swingbank" compare --records "$one" "$@"; }
