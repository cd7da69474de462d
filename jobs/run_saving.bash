# To be sourced: running the long programs from scripts. Contract of the programs: SIGUSR1 -> save, then exit code 2 =
# "saved, run again to continue".

stop_wanted=0
stop_signal='' # the last one
child=''

# A signal that arrives between two programs is stored; Ctrl-C saves too. (bash runs a trap only between commands or
# in `wait`, hence programs run in the background.)
on_stop_signal() {
  stop_wanted=1 stop_signal=$1
  if [[ -n $child ]]; then kill -USR1 "$child" 2>/dev/null || true; fi
}
for stop_signal in USR1 TERM INT; do
  # shellcheck disable=SC2064 # the name as it is now
  trap "on_stop_signal $stop_signal" "$stop_signal"
done
stop_signal=''

launcher_patience=${SWINGBANK_LAUNCHER_PATIENCE:-30} # [s]

# is_lost LAUNCHER: true if all its processes have ended without its noticing, or one was stopped and others wait for
# it. Sets `lost`, the process to kill to end the whole: the launcher, or the stopped process.
is_lost() {
  lost=$1
  local process state dead=0 all
  read -ra all < <(cat "/proc/$1"/task/*/children 2>/dev/null) || true
  for process in ${all[@]+"${all[@]}"}; do
    state=$(sed -n 's/^State:[[:space:]]*\(.\).*/\1/p' "/proc/$process/status" 2>/dev/null) || true
    case ${state:-Z} in
      T) lost=$process && return 0 ;;
      Z | X) dead=$((dead + 1)) ;;
    esac
  done
  ((dead > 0 && dead == ${#all[@]}))
}

# watch_launcher LAUNCHER: ends OpenMPI 4.1's launcher, which may hang if a rank dies during startup.
watch_launcher() {
  local seconds=0 lost
  while sleep 1 && kill -0 "$1" 2>/dev/null; do
    if is_lost "$1"; then seconds=$((seconds + 1)); else seconds=0; fi
    if ((seconds >= launcher_patience)); then
      echo "a process killed at $lost (for $seconds s it was stopped while others wait for it, or it is a launcher that" \
        "outlived its processes): what is finished is safe, the same command goes on" >&2
      kill -KILL "$lost" 2>/dev/null || true
      seconds=0
    fi
  done
}

# run_saving PROGRAM...: runs it, forwards stop signals as SIGUSR1, returns its exit code. A launcher that receives a
# signal during startup dies of it (mpirun: 244); finished shards and checkpoints are on the disk at any time, so that
# counts as saved too.
run_saving() {
  local status before stopped=0 watcher
  if ((stop_wanted)); then return 2; fi
  "$@" &
  child=$!
  watch_launcher "$child" 9>&- & # 9 is the lock of a script: the watcher's sleep would hold it for a second more
  watcher=$!
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
  kill "$watcher" 2>/dev/null || true
  wait "$watcher" 2>/dev/null || true
  if ((stopped && status > 2)); then status=2; fi
  return "$status"
}
