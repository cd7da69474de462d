# To be sourced: how scripts run the long programs. Contract of the programs: SIGUSR1 -> save, then exit code 2 =
# "saved, run me again to go on".

stop_wanted=0
child=''

# A signal that arrives between two programs is remembered; Ctrl-C saves too. (bash runs a trap only between commands
# or in `wait`, hence programs run in the background.)
on_stop_signal() {
  stop_wanted=1
  if [[ -n $child ]]; then kill -USR1 "$child" 2>/dev/null || true; fi
}
trap on_stop_signal USR1 TERM INT

# run_saving PROGRAM...: runs it, hands stop signals on as SIGUSR1, returns its exit code
run_saving() {
  local status before
  if ((stop_wanted)); then return 2; fi
  "$@" &
  child=$!
  while :; do
    before=$stop_wanted status=0
    stop_wanted=0
    wait "$child" || status=$?
    if ((!stop_wanted)); then
      stop_wanted=$before
      break
    fi # else the wait was interrupted, and the program may still be saving
  done
  child=''
  return "$status"
}
