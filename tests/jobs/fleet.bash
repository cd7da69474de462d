# To be sourced by the tests of swingbank diagnose --fleet, after lib.bash.
# shellcheck disable=SC2154 # work is lib.bash's
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
mkdir "$work/records"
# Six seconds contain the fault and the first swings, and take half the time.
for k in 1 2 3 4; do head -361 "$SWINGBANK_SOURCE/configs/records/record-example/avr_ev$k.csv" >"$work/records/e$k.csv"; done
cp "$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml" "$work/model.toml"
# the model with the true exciter: nothing is missing, so the diagnosis is short
{
  cat "$work/model.toml"
  printf '[exciter]\neffect = "SEXS"\nTAoverTB = 0.1\nTB = 10.0\nK = 100.0\nTE = 0.05\nEMIN = -4.0\nEMAX = 5.0\n'
} >"$work/whole.toml"

# plant NAME RECORDS [LINE]: a section of a fleet file; its model is $model, by default the one without the exciter
plant() { printf '[plant.%s]\nmodel = "%s"\nrecords = [%s]\n%s\n' "$1" "${model:-model.toml}" "$2" "${3:-}"; }

# fleet FILE OUT [RANKS [OPTION...]]: prints the table; its exit code; progress goes to OUT.log
fleet() {
  local run=()
  if [[ -n ${3:-} ]]; then run=(mpirun --oversubscribe -np "$3"); fi
  "${run[@]}" "$SWINGBANK_BIN/swingbank" diagnose --fleet "$1" --out "$2" "${@:4}" 2>"$2.log"
}
# expect CODE COMMAND...
expect() {
  local wanted=$1 code=0
  shift
  "$@" >"$work/table" || code=$?
  ((code == wanted)) || fail "exit code $code, expected $wanted: $*: $(cat "$work/table" "$work"/*.log)"
}
same_table() {
  local file
  for file in fleet.json fleet.csv fleet.html; do
    cmp "$1/$file" "$2/$file" || fail "$file differs: $1, $2"
  done
}
