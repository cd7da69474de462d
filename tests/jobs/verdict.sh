#!/usr/bin/env bash
# The two verdicts on a model, fit for purpose and statistically complete: each exit code, and invalid limits.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
# shellcheck disable=SC2154 # set by verdict.bash
source "$(dirname "${BASH_SOURCE[0]}")/verdict.bash"

sexs 85 >"$work/near.toml"
limits() { printf 'name = "%s"\nsource = "this test"\npreset = "dtr-test"\n' "$1"; }
{ limits tight && printf '[P.pre_fault]\nmxe = 0.01\n'; } >"$work/tight.toml"
{ limits wide && printf '[Q.post_fault]\nmxe = 50\nme = 40\nmae = 40\n[movement]\nerror = 150\n'; } >"$work/wide.toml"
gives 0 '^calibrated: Fit for purpose: yes .all 20 errors .* limits dtr-test' calibrate
grep -q '^Statistically complete: yes' "$work/text" || fail "the other verdict is missing: $(cat "$work/text")"
gives 5 '^calibrated: Fit for purpose: no .* exceed the limits tight.. .* MXE of P in the pre-fault window' calibrate --accept "$work/tight.toml"
gives 3 '^Fit for purpose: no .* limits dtr-test.. Largest violation: RMS error of Q after the last switching .*limit 25 %.. Regression coefficient .*: -0.1[0-9] ' compare --model "$bent"
gives 4 '^Fit for purpose: yes .* limits wide' compare --model "$bent" --accept "$work/wide.toml"
gives 4 '^Statistically complete: no' compare --model "$work/near.toml" --accept dtr-simulation
python3 - "$work/out/compare.json" <<'PYTHON'
import json, sys
r = json.load(open(sys.argv[1]))
assert r["fitness"]["fit_for_purpose"] is True and r["statistically_complete"] is False and r["fitness"]["limits"] == "dtr-simulation"
rows = r["fitness"]["errors_percent_of_mva"]
assert [(e["channel"], e["window"]) for e in rows] == [(c, w) for c in "PQ" for w in ("pre-fault", "fault", "post-fault")]
assert all(abs(e["me"]) <= e["mae"] <= e["mxe"] <= e["limits"]["mxe"] for e in rows), rows
PYTHON
for command in compare calibrate add diagnose; do
  "$swingbank" "$command" --help | tr -s ' \n' ' ' | holds -q '3 neither, 4 fit for purpose, but not statistically complete, 5' ||
    fail "$command --help does not list the exit codes"
done

for command in compare calibrate add diagnose effects export; do
  "$swingbank" "$command" --version | holds -qE "^swingbank $command [0-9.]+, commit [0-9a-z]" || fail "$command --version"
  "$swingbank" "$command" --help | holds -qE "^Usage: swingbank $command( |$)" || fail "$command: another usage line"
done

rm -r "$work/out"
{ limits wrong && printf '[P.fault]\nmxe = -1\nmax = 3\n[left_out]\nafter_fault = 9\n'; } >"$work/wrong.toml"
refuses "wrong limits" 'wrong.toml:5' compare --model "$bent" --accept "$work/wrong.toml" --out "$work/out"
for line in 6 8; do grep -q "wrong.toml:$line" "$work/stderr" || fail "line $line is not reported: $(cat "$work/stderr")"; done
refuses "no such limits" 'dtr-test, dtr-simulation' calibrate --accept nonesuch --out "$work/out"
mkdir "$work/bin"
refuses "a PDF without a browser" 'no Chromium at --pdf' env PATH="$work/bin" "$swingbank" compare --model "$bent" --records "$one" \
  --pdf "$work/none/page.pdf" --accept nonesuch --out "$work/out"
for words in 'there is no .*none' 'dtr-simulation'; do grep -q "$words" "$work/stderr" || fail "'$words' is not reported at once"; done
[[ ! -e $work/out ]] || fail "files left behind"
