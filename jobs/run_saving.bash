# To be sourced: how scripts run the long programs. Contract of the programs: SIGUSR1 -> save, then exit code 2 =
# "saved, run me again to go on".

stop_wanted=0
stop_signal='' # the last one
child=''

# A signal that arrives between two programs is remembered; Ctrl-C saves too. (bash runs a trap only between commands
# or in `wait`, hence programs run in the background.)
on_stop_signal() {
  stop_wanted=1 stop_signal=$1
  if [[ -n $child ]]; then kill -USR1 "$child" 2>/dev/null || true; fi
}
for stop_signal in USR1 TERM INT; do
  # shellcheck disable=SC2064 # the name as it is now
  trap "on_stop_signal $stop_signal" "$stop_signal"
done
stop_signal=''

# run_saving PROGRAM...: runs it, hands stop signals on as SIGUSR1, returns its exit code.
# A launcher that a signal meets while it starts dies of it (mpirun: 244); finished shards and checkpoints are on the
# disk at any time, so that counts as saved too.
run_saving() {
  local status before stopped=0
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
    fi
    stopped=1 # the wait was interrupted, and the program may still be saving
  done
  child=''
  if ((stopped && status > 2)); then status=2; fi
  return "$status"
}
