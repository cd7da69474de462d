#!/usr/bin/env bash
# A fleet that is killed, stopped or loses one diagnosis ends in the same table as an undisturbed run.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/fleet.bash"

{
  echo '[options]'
  echo 'power_only = true'
  plant p1 '"records/e1.csv", "records/e2.csv"'
  plant p2 '"records/e3.csv", "records/e4.csv"'
  plant p3 '"records/e1.csv", "records/e4.csv"'
  plant bad '"records/nowhere.csv", "records/e4.csv"'
} >"$work/fleet.toml"
expect 1 fleet "$work/fleet.toml" "$work/whole"
/usr/bin/python3 - "$work/whole" <<'PYTHON'
import csv, json, sys
folder = sys.argv[1]
plants = {p["plant"]: p for p in json.load(open(folder + "/fleet.json"))["plants"]}
for name in ("p1", "p2", "p3"):
    p = plants[name]
    # two events of six seconds hardly distinguish exciters
    assert p["verdict"] in ("missing", "confusable") and p["side"] == "excitation", p
    assert "SEXS" in p["effects"][:1] + p["equivalent"], p
    # on events outside the fit, the residual without an exciter is tens of standard deviations; with the exciter, only
    # noise remains
    assert p["unseen_normalised_rms_before"] > 10 and p["unseen_normalised_rms_after"] < 1.1, p
rows = {r["plant"]: r for r in csv.DictReader(open(folder + "/fleet.csv"))}
assert rows["p1"]["effects"].startswith("SEXS"), rows["p1"]
PYTHON
grep -q 'SEXS' "$work/whole/p1/report.html" || fail "no report of p1"

# done_in FOLDER: how many plants are finished
done_in() { find "$1" -mindepth 2 -name diagnosis.json -not -path '*.part/*' 2>/dev/null | wc -l; }
# wait_for FOLDER COUNT
wait_for() {
  local end=$((SECONDS + 1500)) # a busy machine may take minutes for one plant
  while ((SECONDS < end)); do
    if (($(done_in "$1") >= $2)); then return; fi
    sleep 0.1
  done
  fail "no $2 plants after 25 minutes: $(cat "$1.log")"
}
# of_fleet FOLDER: prints the processes of the fleet with this output folder
of_fleet() { pgrep -f -- "--fleet $work/fleet.toml .*--out $1" || true; }

# kill -9 of every process when one plant is finished and another is running
fleet "$work/fleet.toml" "$work/killed" 2 >"$work/table" &
started=$!
wait_for "$work/killed" 1
mapfile -t ids < <(of_fleet "$work/killed")
kill -9 "${ids[@]}" 2>/dev/null || true
if wait "$started"; then fail "a killed run cannot succeed"; fi
[[ ! -e $work/killed/fleet.json ]] || fail "killed too late to prove anything"
sleep 1 # the diagnosis of a plant ends when its rank is killed
[[ -z $(of_fleet "$work/killed") ]] || fail "left running: $(of_fleet "$work/killed")"
expect 1 fleet "$work/fleet.toml" "$work/killed" 3
(($(grep -c 'existed already' "$work/killed.log") >= 1)) || fail "finished plants were computed again"
same_table "$work/whole" "$work/killed"
[[ -z $(find "$work/killed" -name '*.part' -o -name '*.old') ]] || fail "left behind: $(find "$work/killed")"

# a signal: running diagnoses finish, no new one starts, exit code 2
fleet "$work/fleet.toml" "$work/soft" >"$work/table" &
started=$!
wait_for "$work/soft" 1
kill -USR1 "$(pgrep -o -f -- "--fleet $work/fleet.toml .*--out $work/soft")" # the oldest is the fleet's process
code=0
wait "$started" || code=$?
((code == 2)) || fail "exit code $code after SIGUSR1"
grep -q 'run the same command again' "$work/table" || fail "after SIGUSR1: $(cat "$work/table")"
(($(done_in "$work/soft") < 3)) || fail "stopped too late to prove anything"

# one diagnosis is killed: its plant fails with a message, the others finish; the next run repairs it
rm -rf "$work/soft/p3"
fleet "$work/fleet.toml" "$work/soft" >"$work/table" &
started=$!
child=
for _ in $(seq 15000); do
  child=$(pgrep -f -- "--plant p3 --out $work/soft" || true)
  if [[ -n $child ]]; then break; fi
  sleep 0.1
done
kill -9 "$child"
code=0
wait "$started" || code=$?
((code == 1)) || fail "exit code $code with a diagnosis killed"
grep -q 'p3 failed: The diagnosis was ended by signal 9' "$work/table" || fail "the killed diagnosis is not reported: $(cat "$work/table")"
grep -q '2 failed' "$work/table" || fail "others failed too: $(cat "$work/table")"
expect 1 fleet "$work/fleet.toml" "$work/soft"
same_table "$work/whole" "$work/soft"

# after a change of a record, only the plants with this record are diagnosed again
sed -i 's/^0.05,[^,]*/0.05,1.045/' "$work/records/e4.csv"
expect 1 fleet "$work/fleet.toml" "$work/soft"
(($(grep -c 'existed already' "$work/soft.log") == 1)) || fail "not one plant existed already: $(cat "$work/soft.log")"
