#!/usr/bin/env bash
# cmake --install into a scratch prefix. From an empty folder the commands, the README's example, the man pages and
# the completion work there; the installation builds nothing.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
prefix=$work/prefix build=$(cd "$SWINGBANK_BIN/.." && pwd)

built() { find "$SWINGBANK_BIN" -name 'swingbank*' -printf '%f %s %T@\n' | sort; }
built >"$work/before"
cmake --install "$build" --prefix "$prefix" >"$work/log" 2>&1 || fail "cmake --install: $(tail -n 5 "$work/log")"
built | cmp - "$work/before" || fail "cmake --install built a program again"

# Every command, but no tests and none of research/.
programs() { (cd "$1" && find . -maxdepth 1 -name 'swingbank*' ! -name 'swingbank_research*' ! -lname 'swingbank_research*' -printf '%f\n' | sort); }
cmp <(programs "$SWINGBANK_BIN") <(programs "$prefix/bin") || fail "the installed programs are not those that were built"
others=$(find "$prefix/bin" \( -not -name 'swingbank*' -o -name 'swingbank_research*' \) -type f)
[[ -z $others ]] || fail "no commands, but installed: $others"
cmp <(cd "$SWINGBANK_SOURCE/configs" && find . -type f | sort) <(cd "$prefix/share/swingbank/configs" && find . -type f | sort) ||
  fail "the installed configs are not those of the source tree"
for file in README.md LICENSE CHANGELOG.md docs/reference/formats.md validate/README.md uplot.copyright; do
  [[ -s $prefix/share/doc/swingbank/$file ]] || fail "no share/doc/swingbank/$file"
done

# From PATH, in an empty folder, without the build folder and the source tree.
export PATH=$prefix/bin:$PATH
mkdir "$work/empty"
cd "$work/empty"
[[ $(swingbank --version) == "$("$SWINGBANK_BIN/swingbank" --version)" ]] || fail "--version"
swingbank effects >"$work/effects"
grep -q '^  SEXS ' "$work/effects" || fail "swingbank effects does not list SEXS"
[[ $(swingbank configs) == "$(realpath "$prefix")/share/swingbank/configs" ]] || fail "configs: $(swingbank configs)"

# A missing file is reported with the searched folders and with the example; nothing is written.
model=configs/plants/ieee14_bus2.toml records=configs/records/record-example/avr_ev1.csv
refuses "no model" "looked for in $work/empty.*$prefix/share/swingbank/$model" swingbank compare --model $model --records $records
[[ -z $(ls) ]] || fail "left behind: $(ls)"

# The README's lines: copies the examples, then uses its arguments. `compare` takes seconds, `diagnose` minutes.
copy="cp -r \"\$(swingbank configs)\" ."
grep -qF "$copy" "$SWINGBANK_SOURCE/README.md" || fail "the README does not say: $copy"
eval "$copy"
read -r -a example < <(sed -n 's/^swingbank diagnose \(--model .*\) --power-only --out diagnosis$/\1/p' "$SWINGBANK_SOURCE/README.md")
((${#example[@]} == 4)) || fail "the README's example is not found: ${example[*]}"
status=0
# shellcheck disable=SC2068 # the pattern expands to the files
swingbank compare ${example[@]} --out report >"$work/compare" 2>&1 || status=$?
((status == 3)) || fail "compare: exit code $status: $(tail -n 5 "$work/compare")"
[[ -s report/report.html ]] || fail "compare wrote no report"

# A man page of every command that --help lists, with every option. read-hdf5 is internal.
man1=$prefix/share/man/man1
for program in $(programs "$SWINGBANK_BIN" | grep -v -e -read-hdf5 -e swingbank_); do
  [[ -s $man1/$program.1 ]] || fail "no man page of $program"
done
for command in compare effects; do
  grep -qF ".B swingbank-$command" "$man1/swingbank.1" || grep -qF "swingbank-$command" "$man1/swingbank.1" || fail "swingbank(1) lacks $command"
  for option in $(swingbank "$command" --help | grep -oE '^  -[^ {]+' | tr ',' ' '); do
    grep -qF -- "${option//-/\\-}" "$man1/swingbank-$command.1" || fail "swingbank-$command(1) lacks $option"
  done
done

# complete WORD...: completions after the words, the last of which is unfinished
complete_after() {
  bash -c '
    source "$1"; shift
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
    _swingbank "$1" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
    printf "%s\n" "${COMPREPLY[@]}"' - "$prefix/share/bash-completion/completions/swingbank" "$@" | sort
}
cmp <(complete_after swingbank "" | grep -v -e '^-' -e '^help$') \
  <(programs "$prefix/bin" | sed -n 's/^swingbank-//p' | grep -vx read-hdf5 | sort) || fail "completion does not list the commands"
cmp <(complete_after swingbank compare --) \
  <(swingbank compare --help | grep -oE '^  -[^ {]+' | tr ',' '\n' | tr -d ' ' | grep -e '^--' | sort) ||
  fail "completion does not list the options of compare"
[[ $(complete_after swingbank comp) == compare ]] || fail "completion of comp"
[[ $(complete_after swingbank compare --drive "" | xargs) == "pq voltage" ]] || fail "completion of --drive"
[[ -z $(complete_after swingbank compare --model "") ]] || fail "completion of a file must be left to the shell"
