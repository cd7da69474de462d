#!/usr/bin/env bash
# swingbank blind-test on several ranks: the same cases as on one rank, each judged once; existing verdicts are kept.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
tiny=(--config "$SWINGBANK_SOURCE/configs/blind/tiny.toml" --seed 5 --kinds "SEXS,none" --make 5)
ranks() { mpirun --oversubscribe -np "$1" "$swingbank" blind-test "${@:2}"; }

"$swingbank" blind-test "${tiny[@]}" --out "$work/one" >/dev/null 2>&1
ranks 3 "${tiny[@]}" --out "$work/three" >"$work/text" 2>"$work/log"
grep -q 'made 5 cases' "$work/text" || fail "said: $(cat "$work/text")"
grep -q '^5/5 cases (100 %' "$work/log" || fail "progress: $(cat "$work/log")"
diff -r "$work/one" "$work/three" || fail "three ranks made other cases than one"
rm -r "$work/three/cases/c0002"
ranks 2 "${tiny[@]}" --out "$work/three" >"$work/text" 2>/dev/null
grep -q 'made 1 cases .* 4 existed already' "$work/text" || fail "said: $(cat "$work/text")"
diff -r "$work/one" "$work/three" || fail "another case after one was removed"

# every case is judged once, by any free rank; --part is allowed
cat >"$work/judge" <<'JUDGE'
#!/bin/sh
echo "$1" >>"$(dirname "$0")/asked"
echo '{"verdict": "adequate", "effects": [], "set": [], "side": "none", "seconds": 0.5}' >"$2"
JUDGE
chmod +x "$work/judge"
ranks 3 --out "$work/three" --judge "$work/judge" --part 1/2 >"$work/text" 2>/dev/null
grep -q 'judged 3 cases, 0 failed' "$work/text" || fail "said: $(cat "$work/text")"
ranks 3 --out "$work/three" --judge "$work/judge" >"$work/text" 2>/dev/null
grep -q 'judged 2 cases, 0 failed' "$work/text" || fail "said: $(cat "$work/text")"
[[ $(sort "$work/asked" | uniq -d | wc -l) == 0 && $(wc -l <"$work/asked") == 5 ]] || fail "asked: $(cat "$work/asked")"

# if one rank fails, all ranks return its exit code
rm "$work/three/verdicts/c0003.json"
code=0
ranks 2 --out "$work/three" --judge "$work/nobody" >/dev/null 2>"$work/log" || code=$?
((code == 1)) || fail "exit code $code with a judge that does not exist"
grep -q 'code 127' "$work/log" || fail "said: $(cat "$work/log")"
code=0
ranks 3 "${tiny[@]}" --out "$work/three" --size 3 >/dev/null 2>"$work/log" || code=$?
((code == 1)) || fail "exit code $code with another plan"
[[ $(grep -c 'another run' "$work/log") == 1 ]] || fail "reported more than once: $(cat "$work/log")"
