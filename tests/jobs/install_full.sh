#!/usr/bin/env bash
# cmake --install into a scratch prefix. From an empty folder the commands, the README's example, the man pages and
# the completions of bash, zsh and fish work there; the installation builds nothing.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
prefix=$work/prefix build=$(cd "$SWINGBANK_BIN/.." && pwd)

built() { find "$SWINGBANK_BIN" -name 'swingbank*' -printf '%f %s %T@\n' | sort; }
built >"$work/before"
cmake --install "$build" --prefix "$prefix" >"$work/log" 2>&1 || fail "cmake --install: $(tail -n 5 "$work/log")"
built | cmp - "$work/before" || fail "cmake --install built a program again"

# Every command, but no tests and none of research/. bin has a link to the dispatcher; the programs are in libexec.
installed=$prefix/libexec/swingbank
[[ $(ls "$prefix/bin") == swingbank && $(realpath "$prefix/bin/swingbank") == "$(realpath "$installed")/swingbank" ]] ||
  fail "bin is not one link: $(ls -l "$prefix/bin")"
programs() { (cd "$1" && find . -maxdepth 1 -name 'swingbank*' ! -name 'swingbank_research*' ! -lname 'swingbank_research*' -printf '%f\n' | sort); }
cmp <(programs "$SWINGBANK_BIN") <(programs "$installed") || fail "the installed programs are not those that were built"
others=$(find "$installed" \( -not -name 'swingbank*' -o -name 'swingbank_research*' \) -type f)
[[ -z $others ]] || fail "no commands, but installed: $others"
cmp <(cd "$SWINGBANK_SOURCE/configs" && find . -type f ! -path './schema/*' | sort) \
  <(cd "$prefix/share/swingbank/configs" && find . -type f ! -path './schema/*' | sort) ||
  fail "the installed configs are not those of the source tree"
for file in README.md LICENSE CHANGELOG.md docs/reference/formats.md validate/README.md uplot.copyright; do
  [[ -s $prefix/share/doc/swingbank/$file ]] || fail "no share/doc/swingbank/$file"
done

# Every link of an installed document leads to an installed file.
/usr/bin/python3 - "$prefix" <<'PYTHON' || fail "links of installed documents"
import pathlib, re, sys
prefix, links, broken = pathlib.Path(sys.argv[1]), 0, []
for document in prefix.rglob("*.md"):
    text = re.sub(r"^```.*?^```", "", document.read_text(), flags=re.DOTALL | re.MULTILINE)
    for target in re.findall(r"\]\(([^()\s]+)\)", text):
        if re.match(r"[a-z]+:|#", target):
            continue
        links += 1
        if not (document.parent / target.partition("#")[0]).exists():
            broken.append(f"{document.relative_to(prefix)}: {target}")
assert links > 100, links
sys.exit("\n".join(broken) or None)
PYTHON
grep -qF 'Containerfile' "$prefix/share/doc/swingbank/docs/how-to/install.md" || fail "the text of a link is lost"

# The environment module, in a shell that knows nothing of the prefix.
in_shell() { env -i PATH=/usr/bin:/bin HOME="$work" MODULEPATH="$prefix/share/modulefiles" bash -c "$1"; }
load='eval "$(modulecmd bash load swingbank)"'
[[ $(in_shell "$load; command -v swingbank") == "$prefix/bin/swingbank" ]] || fail "the module's PATH"
[[ $(in_shell "$load; swingbank --version") == "$("$SWINGBANK_BIN/swingbank" --version)" ]] || fail "the module's swingbank"
[[ $(in_shell "$load; echo \$CMAKE_PREFIX_PATH") == "$prefix" ]] || fail "the module's CMAKE_PREFIX_PATH"
if [[ -d $prefix/lib/python3/dist-packages/swingbank ]]; then
  in_shell "$load; /usr/bin/python3 -c 'import swingbank'" || fail "the module's PYTHONPATH"
fi
[[ -z $(in_shell "$load; eval \"\$(modulecmd bash unload swingbank)\"; command -v swingbank") ]] || fail "unloading the module"

# From PATH, in an empty folder, without the build folder and the source tree.
export PATH=$prefix/bin:$PATH
mkdir "$work/empty"
cd "$work/empty"
[[ $(swingbank --version) == "$("$SWINGBANK_BIN/swingbank" --version)" ]] || fail "--version"
swingbank effects >"$work/effects"
grep -q '^  SEXS ' "$work/effects" || fail "swingbank effects does not list SEXS"
[[ $(swingbank configs) == "$(realpath "$prefix")/share/swingbank/configs" ]] || fail "configs: $(swingbank configs)"

# Without the programs of the component train (Debian package swingbank-train) their commands name that package.
mkdir "$work/whole"
cp -r "$installed" "$work/whole/libexec"
(cd "$work/whole/libexec" && find . -lname swingbank_datasets -delete && rm swingbank_datasets)
refuses "command that is not installed" 'install swingbank-train' "$work/whole/libexec/swingbank" generate
refuses "fleet on ranks without MPI" 'diagnose-fleet.*install swingbank-train' env PMIX_RANK=0 \
  "$work/whole/libexec/swingbank" diagnose --fleet fleet.toml

# A missing file is reported with the searched folders and with the example; nothing is written.
model=configs/plants/ieee14_bus2.toml records=configs/records/record-example/avr_ev1.csv
refuses "no model" "searched in $work/empty.*$prefix/share/swingbank/$model" swingbank compare --model $model --records $records
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

# A man page of every command that --help lists, with every option.
man1=$prefix/share/man/man1
for program in $(programs "$SWINGBANK_BIN" | grep -vx -f <(internal_commands | sed 's/^/swingbank-/') | grep -v swingbank_); do
  [[ -s $man1/$program.1 ]] || fail "no man page of $program"
done
for command in compare effects; do
  grep -qF ".B swingbank-$command" "$man1/swingbank.1" || grep -qF "swingbank-$command" "$man1/swingbank.1" || fail "swingbank(1) lacks $command"
  for option in $(swingbank "$command" --help | grep -oE '^  -[^ {]+' | tr ',' ' '); do
    grep -qF -- "${option//-/\\-}" "$man1/swingbank-$command.1" || fail "swingbank-$command(1) lacks $option"
  done
done

# complete_SHELL WORD...: completions after the words, the last of which is unfinished
complete_bash() {
  bash -c '
    source "$1"; shift
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
    _swingbank "$1" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
    printf "%s\n" "${COMPREPLY[@]}"' - "$prefix/share/bash-completion/completions/swingbank" "$@"
}
complete_zsh() {
  HOME=$work zsh -f "$SWINGBANK_SOURCE/tests/jobs/complete.zsh" "$prefix/share/zsh/vendor-completions" "$*"
}
complete_fish() {
  HOME=$work XDG_CONFIG_HOME=$work/fish XDG_DATA_HOME=$work/fish XDG_DATA_DIRS=$prefix/share \
    fish -c 'complete --do-complete "$argv"' "$*" | cut -f1
}
programs "$installed" | sed -n 's/^swingbank-//p' | grep -vx -f <(internal_commands) | sort >"$work/commands"
swingbank compare --help | grep -oE '^  -[^ {]+' | tr ',' '\n' | tr -d ' ' | grep -e '^--' | sort >"$work/options"
for shell in bash zsh fish; do
  completed() { "complete_$shell" "$@" | sort; }
  cmp <(completed swingbank "" | grep -v -e '^-' -e '^help$') "$work/commands" || fail "$shell does not complete commands"
  cmp <(completed swingbank compare --) "$work/options" || fail "$shell does not complete the options of compare"
  cmp <(completed swingbank compare --component plant --) "$work/options" || fail "$shell takes a value for a command"
  [[ $(completed swingbank comp) == compare ]] || fail "$shell does not complete comp"
  [[ $(completed swingbank help comp) == compare ]] || fail "$shell does not complete help comp"
  [[ $(completed swingbank schema pl) == plant ]] || fail "$shell does not complete schema pl"
  [[ $(completed swingbank compare --playback "" | xargs) == "pq voltage" ]] || fail "$shell does not complete --playback"
  [[ -z $(completed swingbank compare --threads "") ]] || [[ $shell == bash ]] || fail "$shell completes a number"
  file=$(completed swingbank compare --model ${model%.toml})
  # bash completes files itself (-o default).
  if [[ $shell == bash ]]; then [[ -z $file ]]; else [[ $file == *"${model##*/}" ]]; fi ||
    fail "$shell completes a file to '$file'"
done
