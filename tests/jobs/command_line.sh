#!/usr/bin/env bash
# Options: one set for all commands that play records into a plant model, help in groups with an example, and one
# message for each unknown option.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

# the same options with the same descriptions in all four commands
shared='model records columns from until component point power-only user-model switch step-threshold pre-event out pdf quiet by accept json verbose threads'
for command in compare calibrate diagnose add; do
  "$swingbank" "$command" --help >"$work/help"
  for option in $shared; do
    grep -qE -- "^  (-[a-z],)?--$option\b" "$work/help" || fail "$command --help lacks --$option"
  done
  for group in Input Events Output Expert Help; do
    grep -q "^$group:" "$work/help" || fail "$command --help has no group $group"
  done
  sed -n '/^Events:/,/^Output:/p' "$work/help" | grep -E '^  --(switch|jump|pre)' >"$work/events-$command"
  cmp "$work/events-compare" "$work/events-$command" || fail "$command describes the options of events otherwise than compare"
  grep -A1 '^Example:' "$work/help" | grep -q "^  swingbank $command " || fail "$command --help has no example"
done
for command in calibrate diagnose add; do
  holds -q -- '--prior-sd' < <("$swingbank" "$command" --help) || fail "$command --help lacks --prior-sd"
done
"$swingbank" simulate --help >"$work/help"
for group in Input 'Power flow' Models Events Measurements Output Expert; do
  grep -q "^$group:" "$work/help" || fail "simulate --help has no group $group"
done
for command in inventory plant export simulate effects tables generate databank verify merge; do
  holds -qE "^ +swingbank $command [^-]*.*[a-z]" < <("$swingbank" "$command" --help) || fail "$command --help has no example"
done
# the option for a plant file has the same name everywhere
"$swingbank" export --dyr plant.toml 2>"$work/words" >&2 && fail "export reads a plant file from --dyr"
grep -q "unknown option at '--dyr'" "$work/words" || fail "export --dyr: $(cat "$work/words")"

# every unknown word in the given order, with the most similar option
status=0
"$swingbank" add SEXS --model a.toml --records r.csv --thread 1 --step-treshold=0.1 --xyzzy 3 4 --law l.toml 2>"$work/words" >&2 || status=$?
((status == 1)) || fail "exit code $status, expected 1"
cat >"$work/expected" <<'TEXT'
unknown option at '--thread' (swingbank add has no such option): did you mean --threads?
unknown option at '--step-treshold' (swingbank add has no such option): did you mean --step-threshold?
unknown option at '--xyzzy' (swingbank add has no such option): see swingbank add --help
unknown option at '--law' (swingbank add has no such option): did you mean --user-model?
TEXT
diff "$work/expected" "$work/words" || fail "unknown options are reported otherwise"
"$swingbank" plant --raw a.raw extra 2>"$work/words" >&2 && fail "an unexpected argument is accepted"
echo "unexpected argument 'extra': swingbank plant takes no positional arguments; see swingbank plant --help" >"$work/expected"
diff "$work/expected" "$work/words" || fail "an unexpected argument is reported otherwise"

# Several values after one use of an option are accepted where the help shows dots, and only there.
"$swingbank" compare --help >"$work/help"
grep -q -- '--records,--record TEXT \.\.\.' "$work/help" || fail "the help of --records has no dots"
! grep -q -- '--switch TEXT \.\.\.' "$work/help" || fail "the help of --switch has dots, but it takes one value at a time"
misused "two values of --switch" "unexpected argument '2.1'" "$swingbank" compare --model a.toml --switch 2.0 2.1 --records r.csv
refuses "two uses of --switch" "a.toml" "$swingbank" compare --model a.toml --records r.csv --switch 2.0 --switch 2.1

# Without /proc the commands are found by the path of the started program.
as_user=()
if ((EUID != 0)); then as_user=(--user --map-root-user); fi
without_proc() { unshare "${as_user[@]}" --mount bash -c 'mount -t tmpfs none /proc && exec "$@"' - "$@"; }
ln -s "$swingbank" "$work/linked"
for start in "$swingbank" "$work/linked"; do
  without_proc "$start" compare --help >"$work/without" || fail "without /proc: $(cat "$work/without")"
  cmp "$work/help" "$work/without" || fail "without /proc compare --help says something else"
done
[[ $(without_proc "$swingbank" configs) == "$("$swingbank" configs)" ]] || fail "configs without /proc"

# the validation commands come first; internal ones are not listed
"$swingbank" --help >"$work/help"
awk '/^[A-Z].*:$/ {print}' "$work/help" >"$work/groups"
printf '%s\n' 'Validate a plant:' 'Simulate and generate:' 'Train:' 'Benchmarks:' >"$work/expected"
grep -vx 'Train:' "$work/groups" | diff <(grep -vx 'Train:' "$work/expected") - || fail "groups of swingbank --help"
first=$(sed -n '/^Validate a plant:/,/^$/p' "$work/help" | awk '/^  / {print $1}' | xargs)
[[ $first == 'inventory plant compare benchmark diagnose add calibrate serve export' ]] || fail "validation lists $first"
[[ -n $(internal_commands) ]] || fail "no internal command is found"
for command in $(internal_commands); do
  ! grep -q "^  $command " "$work/help" || fail "the internal command $command is listed"
done

# a result that cannot be written to standard output
for command in "effects" "export --model $SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml"; do
  code=0
  # shellcheck disable=SC2086 # words of the command
  "$swingbank" $command >/dev/full 2>"$work/stderr" || code=$?
  ((code == 1)) || fail "$command: exit code $code with a full disk"
  grep -q 'cannot write the result at standard output (No space left on device): free space' "$work/stderr" ||
    fail "$command says: $(cat "$work/stderr")"
done
