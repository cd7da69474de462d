# Prints zsh's completions of a command line, one a line, as an interactive shell offers them.
#   zsh -f complete.zsh FOLDER-OF-COMPLETIONS LINE
if [[ $1 == --inside ]]; then # in the interactive shell
  fpath=($SWINGBANK_COMPLETIONS $fpath)
  autoload -Uz compinit
  compinit -u -D
  compadd() {
    if [[ ${@[1,(i)(-|--)]} != *-[OAD]\ * ]]; then
      local -a offered
      builtin compadd -A offered "$@"
      print -rl -- $offered >>$SWINGBANK_OFFERED
    fi
    builtin compadd "$@"
  }
  offer() {
    _main_complete
    print -r -- '<end>' >>$SWINGBANK_OFFERED
  }
  zle -C offer complete-word offer
  bindkey '^I' offer
  print '<ready>'
  return
fi

zmodload zsh/zpty
export SWINGBANK_COMPLETIONS=$1 SWINGBANK_OFFERED=$(mktemp)
zpty shell zsh -f -i
zpty -w shell "source ${(q)${(%):-%x}:A} --inside"
while zpty -r shell said; do
  [[ $said != '<ready>'* ]] || break
done
zpty -w -n shell "$2"$'\t'
integer tries=0
until [[ $(tail -n 1 $SWINGBANK_OFFERED) == '<end>' ]] || ((++tries > 600)); do
  zpty -r -t shell said || sleep 0.05
done
zpty -d shell
sed '/^<end>$/d; /^$/d' $SWINGBANK_OFFERED
rm -f $SWINGBANK_OFFERED
