#!/usr/bin/env bash
# swingbank blind-test: makes, resumes, judges and scores a run; refuses invalid input.
set -euo pipefail
bin=${SWINGBANK_BIN:?} source=${SWINGBANK_SOURCE:?}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
run=$folder/run
tiny=(--config "$source/configs/blind/tiny.toml" --out "$run" --seed 5 --kinds "SEXS,none" --make 2)

"$bin/swingbank-blind-test" "${tiny[@]}" >"$folder/log"
grep -q 'made 2 cases' "$folder/log"
before=$(cd "$run" && find . -type f -exec sha256sum {} + | sort)

# a missing and a partly written case are made again with the same bytes
rm -r "$run/cases/c0002"
mkdir "$run/cases/.c0002.partial"
"$bin/swingbank-blind-test" "${tiny[@]}" >"$folder/log"
grep -q 'made 1 cases .* 1 existed already' "$folder/log"
[ "$before" = "$(cd "$run" && find . -type f -exec sha256sum {} + | sort)" ]
[ ! -e "$run/cases/.c0002.partial" ]

cat >"$folder/judge" <<'JUDGE'
#!/bin/sh
[ -e "$1/model.toml" ] || exit 3
echo '{"verdict": "adequate", "effects": [], "set": [], "side": "none", "seconds": 0.5}' >"$2"
JUDGE
chmod +x "$folder/judge"
"$bin/swingbank-blind-test" --out "$run" --judge "$folder/judge" --score \
  --targets "$source/configs/blind/targets.toml" >"$folder/log"
grep -q 'nothing hidden: adequate | 100.0 % (1 of 1' "$folder/log"
[ -s "$run/score.md" ] && [ -s "$run/score.json" ]

refused() {
  local words=$1
  shift
  if "$bin/swingbank-blind-test" "$@" >"$folder/log" 2>&1; then
    echo "accepted: $*"
    exit 1
  fi
  grep -q -- "$words" "$folder/log" || { cat "$folder/log"; exit 1; }
}
refused 'another run' "${tiny[@]}" --size 3
refused 'nothing to do' --out "$run"
refused 'no kind' --config "$source/configs/blind/tiny.toml" --out "$folder/other" --kinds AVR --make 1
refused 'a part is K/N' "${tiny[@]}" --part 3/2
refused 'no cases of a blind test' --out "$folder/nothing" --score --targets "$source/configs/blind/targets.toml"
rm "$run/verdicts/c0001.json"
refused 'code 127' --out "$run" --judge "$folder/nobody"
