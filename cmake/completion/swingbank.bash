# bash completion of `swingbank`. from_help.sh writes the tables of commands and options before the part below "---".
# shellcheck disable=SC2034,SC2154
# ---
_swingbank() {
  local word=$2 before=$3 command=${COMP_WORDS[1]-} words=
  if ((COMP_CWORD == 1)); then
    words="$_swingbank_commands help --help --version"
  elif ((COMP_CWORD == 2)) && [[ $command == help ]]; then
    words=$_swingbank_commands
  elif [[ -n ${_swingbank_choices["$command $before"]-} ]]; then
    words=${_swingbank_choices["$command $before"]}
  elif [[ $word == -* ]]; then
    words=${_swingbank_options["$command"]-}
  fi
  # Without matching words, bash completes file names (-o default).
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -o default -F _swingbank swingbank
