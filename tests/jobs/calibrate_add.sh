#!/usr/bin/env bash
# swingbank calibrate and add: output files, exit codes, and one message for each bad input.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

model=$work/plant.toml
cat "$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml" - >"$model" <<'TOML'
[nameplate]
owner = "A & B"
recorded = "2026-03-01"
[nameplate.exciter]
manufacturer = "ABC"
TOML
records=$SWINGBANK_SOURCE/configs/records/record-example
one=$records/avr_ev1.csv two=$records/avr_ev2.csv
export OMP_NUM_THREADS=2

# the missing exciter: added, fitted to one event, tested on the other
"$swingbank" add SEXS --model "$model" --records "$one" "$two" --hold-out avr_ev2 --power-only --out "$work/added" --json \
  >"$work/printed.json"
cmp "$work/printed.json" "$work/added/add.json" || fail "--json prints something else than it writes"
python3 - "$work/added/add.json" <<'PYTHON'
import json, sys
r = json.load(open(sys.argv[1]))
assert r["effect"] == "SEXS" and r["accepted"] and r["adequate"], r["sentence"]
seen, unseen = r["events"]
assert (seen["record"], seen["seen"], unseen["seen"]) == ("avr_ev1.csv", True, False)
assert [e["use"] for e in r["events"]] == ["fit", "verification"]
assert r["nameplate"]["given"] == {"owner": "A & B", "recorded": "2026-03-01", "exciter.manufacturer": "ABC"}, r["nameplate"]
assert "exciter.model" in r["nameplate"]["missing"] and "governor.model" not in r["nameplate"]["missing"], r["nameplate"]
u = r["usability"]
assert u["usable"] and "SEXS" in u["step"] and len(u["operating_points"]) == 2, u
assert all(0 < o["oscillation"]["damping_ratio"] < 1 and 0.1 < o["oscillation"]["frequency_hz"] < 5 for o in u["operating_points"]), u
assert unseen["reduced_chi2_before"] > 100 * unseen["reduced_chi2_after"]
assert [e["unit"] for e in r["errors"] if e["model"] == "submitted" and e["record"] == "avr_ev2.csv"] == ["MW", "Mvar"]
PYTHON
# the errors of the submitted model equal those of compare
"$swingbank" compare --model "$model" --records "$one" "$two" --out "$work/before" >/dev/null || (($? == 3 || $? == 4))
python3 - "$work/added/add.json" "$work/before/compare.json" <<'PYTHON'
import json, sys
added, compared = (json.load(open(f)) for f in sys.argv[1:])
before = {(e["record"], e["channel"]): e for e in added["errors"] if e["model"] == "submitted"}
assert len(before) == 4, before
for event in compared["events"]:
    for c in event["channels"]:
        if c["name"] not in "PQ": continue
        own = before[event["record"], c["name"]]
        assert own["rms"] == c["whole"]["rms_pu"] * c["units_in_pu"], (own, c["whole"])
        assert own["noise"] == c["noise_pu"] * c["units_in_pu"], own
        assert abs(own["rms_over_noise"] - own["rms"] / own["noise"]) < 1e-9 * own["rms_over_noise"], own
PYTHON
for words in 'Added effect' 'evidence' 'event 1 (fit)' 'event 2 (verification)' 'completed' 'Model information' 'A &amp; B' \
  'verified by the independent event avr_ev2.csv' 'the step response is damped' '<section class="signatures">'; do
  grep -qF -- "$words" "$work/added/report.html" || fail "'$words' is not on the page"
done
grep -q '^owner = "A & B"' "$work/added/model.toml" || fail "the new model has lost its nameplate"
grep -q '^// Excitation system, manufacturer: ABC' "$work/added/model.dyr" || fail "the records have lost the nameplate"
grep -q '^effect = "SEXS"' "$work/added/model.toml" || fail "the new model has no SEXS"
grep -q '^# Command: swingbank add SEXS' "$work/added/model.toml" || fail "the new model does not say where it comes from"

# the output is a valid model: it can be calibrated again and remains adequate
"$swingbank" calibrate --model "$work/added/model.toml" --records "$one" "$two" --power-only --draws 0 --starts 0 --out "$work/again" >"$work/text"
[[ -s $work/again/model.toml && -s $work/again/calibrate.json ]] || fail "model.toml and calibrate.json expected"
grep -q "^2 'SEXS' '1' " "$work/added/model.dyr" || fail "add wrote no .dyr of the example plant"
sed '/^bus = 2/d' "$work/added/model.toml" >"$work/unnumbered.toml"
"$swingbank" calibrate --model "$work/unnumbered.toml" --records "$one" --power-only --draws 0 --starts 0 --out "$work/unnumbered" >"$work/said"
grep -q 'no .dyr was written: no bus number' "$work/said" || fail "no message about the missing .dyr"
"$swingbank" calibrate --model "$work/added/model.toml" --records "$one" --power-only --draws 0 --starts 0 --out "$work/numbered" >/dev/null
grep -q '^// changed or new: GENROU, SEXS' "$work/numbered/model.dyr" || fail "the records do not say what changed"
cmp <("$swingbank" export --model "$work/numbered/model.toml" | grep -v '^//') <(grep -v '^//' "$work/numbered/model.dyr") || fail "model.dyr is not what export makes"
grep -q 'SEXS.K' "$work/text" || fail "the table lacks the exciter's gain"
grep -q 'no independent event verifies the fit' "$work/again/report.html" || fail "the page does not say that no event was held out"
grep -q '^Usability: Initialises; the step response is damped' "$work/text" || fail "no usability on the terminal"

# given switching times are used unchanged
"$swingbank" calibrate --model "$work/added/model.toml" --records "$one" "$two" --switch avr_ev1.csv=2 --switch avr_ev1.csv=2.1 --power-only \
  --draws 0 --starts 0 --out "$work/told" >/dev/null
holds -q '2.1000 s (given)' <"$work/told/report.html" || fail "the page does not state that the switching times were given"

fits_schema "$work/added/add.json" "$work/before/compare.json" "$work/again/calibrate.json"
sed 's/"use": *"fit"/"use": "fitted"/' "$work/added/add.json" >"$work/altered.json"
(fits_schema "$work/altered.json") 2>/dev/null && fail "the schema accepts an unknown use"

# without the exciter the structure is inadequate: exit code 3, and the files are written nevertheless
status=0
"$swingbank" calibrate --model "$model" --records "$one" --power-only --draws 0 --starts 0 --out "$work/poor" >"$work/text" || status=$?
((status == 3)) || fail "exit code $status, expected 3"
[[ -s $work/poor/model-not-adequate.toml && ! -e $work/poor/model.toml && ! -e $work/poor/model.dyr ]] ||
  fail "a model that is not adequate is in $(ls "$work/poor")"
grep -q '^# NOT ADEQUATE' "$work/poor/model-not-adequate.toml" || fail "the model does not state that it is not adequate"
grep -q "^next: .*swingbank diagnose --model $model" "$work/text" || fail "it does not say what is next"
"$swingbank" compare --model "$work/poor/model-not-adequate.toml" --records "$one" --out "$work/bent" >/dev/null 2>"$work/notes" || (($? == 3))
grep -q 'contains the result of an inadequate calibration' "$work/notes" || fail "a model that is not adequate is accepted without a warning"
grep -q 'Structure not adequate' "$work/text" || fail "it does not state that something is missing: $(head -1 "$work/text")"

out=$work/out
mkdir "$out"
calibrate() { "$swingbank" calibrate --model "$model" --out "$out" "$@"; }
add() { "$swingbank" add --model "$model" --out "$out" "$@"; }
refuses "no such model" "none.toml" "$swingbank" calibrate --model "$work/none.toml" --records "$one" --out "$out"
refuses "no such records" "none1.csv" calibrate --records "$work/none1.csv" "$work/none2.csv"
grep -q none2.csv "$work/stderr" || fail "only the first missing record is named"
refuses "one event, held out" "every event is held out" calibrate --records "$one" --hold-out 1
refuses "unknown event held out" "avr_ev2.csv" calibrate --records "$one" "$two" --hold-out avr_ev9
refuses "switching times of an unknown record" "no --record has that file name" calibrate --records "$one" --switch avr_ev9.csv=2
refuses "an instant of two records" "several records are given" calibrate --records "$one" "$two" --switch 2
refuses "unknown parameter fixed" "GENROU.Xdp" calibrate --records "$one" --fix GENROU.Xyz
refuses "the same record twice" "two records named" calibrate --records "$one" "$one"
refuses "truth of no known form" "blind-test" calibrate --records "$one" --truth "$work/added/add.json"
misused "no records" "records" calibrate
misused "method" "method" calibrate --records "$one" --method guess
misused "prior" "prior-sd" calibrate --records "$one" --prior-sd -1
refuses "unknown effect" "SEXS" add NONESUCH --records "$one"
refuses "an effect of one event" "describes one event" add VREFSTEP --records "$one"
refuses "slot taken" "no free place" add GENCLS --records "$one"
refuses "no effect named" "until-adequate" add --records "$one"
refuses "named and looked for" "until-adequate" add SEXS --until-adequate --records "$one"
refuses "one event, held out" "every event is held out" add SEXS --records "$one" --hold-out avr_ev1
refuses "no such user-defined model" "none.toml" add SEXS --records "$one" --user-model "$work/none.toml"
leaves_nothing "$out"
