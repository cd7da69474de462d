#!/usr/bin/env bash
# The examples of docs/how-to/components.md and docs/how-to/staged-tests.md, word for word, with the verdicts of
# compare and calibrate; and the message about missing columns of a component's record.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
export PATH=$SWINGBANK_BIN:$PATH TMPDIR=$work

# example FILE: runs the page's bash lines; their output is in `said`
example() {
  sed -n '/^```bash$/,/^```$/p' "$SWINGBANK_SOURCE/docs/how-to/$1" | grep -v '```' >"$work/example.sh"
  (cd "$work" && bash example.sh >said 2>said.errors)
}
# says PATTERN TIMES: this number of output lines matches
says() {
  [[ $(grep -cE "$1" "$work/said") == "$2" ]] ||
    fail "not $2 × '$1': $(tail -n 40 "$work/said") $(cat "$work/said.errors")"
}

example components.md || fail "components.md: $(cat "$work/said.errors")"
says '^Statistically complete: no\. Not adequate' 1
says '^Statistically complete: yes\. Structure adequate, parameter values were wrong.*KF 0\.05 -> 0\.03 pu' 1
says '^Statistically complete: yes\. Adequate' 1

example staged-tests.md || fail "staged-tests.md: $(cat "$work/said.errors")"
says '^Statistically complete: no\. Not adequate' 1
says '^Statistically complete: yes\. Structure adequate, parameter values were wrong' 1
says '^Statistically complete: yes\. Adequate' 1

cd "$work"
swingbank plant --raw "$SWINGBANK_SOURCE/configs/networks/ieee14_genrou.raw" --dyr "$SWINGBANK_SOURCE/configs/networks/ieee14_genrou.dyr" \
  --bus 2 --out unit.toml >/dev/null
{
  echo
  swingbank effects IEEET1 --toml
  echo
  swingbank effects STAB1 --toml
} >>unit.toml
{
  echo t_s,P_MW
  for k in $(seq 0 60); do echo "0.0$k,1"; done
} >few.csv
refuses "a record without V" "no column V_pu" swingbank compare --model unit.toml --record few.csv --component exciter
refuses "a record without Efd" "no column Efd_pu" swingbank compare --model unit.toml --record few.csv --component exciter
refuses "a record without speed" "omega_pu, speed_pu or f_pu" swingbank compare --model unit.toml --record few.csv --component exciter
# A staged event without its record is reported, since the name may be mistyped.
{ cat unit.toml && printf '\n[[event]]\nkind = "vref_step"\nrecord = "few.txt"\ntime = 1\nsize = 0.03\n'; } >mistyped.toml
refuses "a mistyped record" "vref_step of few.txt is not used" swingbank compare --model mistyped.toml --record few.csv
printf '\n[[event]]\nkind = "step"\ntime = 1\n' >>unit.toml
refuses "an unknown event" "load_rejection" swingbank compare --model unit.toml --record few.csv
