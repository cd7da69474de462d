#!/usr/bin/env bash
# The watchdog ends a launcher that hangs after its processes have died, and does not end a launcher with living
# processes.
# shellcheck disable=SC2154,SC2034 # set by lib.bash; read by run_saving.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$SWINGBANK_SOURCE/jobs/run_saving.bash"
launcher_patience=2
# launcher A B: starts a process that ends after A seconds. The launcher does not notice it and ends after B seconds.
launcher=(/usr/bin/python3 -c 'import os, sys, time
if os.fork() == 0:
    time.sleep(float(sys.argv[1]))
    os._exit(0)
time.sleep(float(sys.argv[2]))')
code=0
run_saving "${launcher[@]}" 0 60 2>"$work/log" || code=$?
((code == 137)) || fail "exit code $code of a launcher that hung: $(cat "$work/log")"
grep -q 'a process killed at' "$work/log" || fail "the ended launcher is not reported: $(cat "$work/log")"
run_saving "${launcher[@]}" 6 4 2>"$work/log" || fail "a launcher was ended whose process lived: $(cat "$work/log")"
[[ ! -s $work/log ]] || fail "a message about a sound launcher: $(cat "$work/log")"
"${launcher[@]}" 60 60 & # a process that is stopped
stopped=$!
sleep 0.3
kill -STOP "$(pgrep -P "$stopped")"
is_lost "$stopped" || fail "a stopped process was not noticed"
[[ $lost == "$(pgrep -P "$stopped")" ]] || fail "not the stopped process is to be killed, but $lost"
kill -KILL "$(pgrep -P "$stopped")" "$stopped"
wait "$stopped" 2>/dev/null || true
run_saving true || fail "a program without processes of its own"
echo "ok: a hanging launcher is ended"
