#!/usr/bin/env bash
# swingbank serve: the page answers its owner and nobody else, and survives hostile requests.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
# shellcheck source=tests/jobs/serve.bash
source "$(dirname "${BASH_SOURCE[0]}")/serve.bash"

record=$SWINGBANK_SOURCE/configs/records/record-example/avr_ev4.csv
serve "$record"
base=${url%/*/} # http://127.0.0.1:PORT
# answer ARGUMENT...: prints the status of a request; its content goes to ./content
answer() { curl -s --max-time 60 -o content -w '%{http_code}' "$@"; }
# expect STATUS ARGUMENT...
expect() {
  local expected=$1 status
  shift
  status=$(answer "$@") || status=none
  [[ $status == "$expected" ]] || fail "status $status, expected $expected: $* ($(head -c 200 content))"
}

expect 200 "$url"
grep -q 'main.js' content || fail "no page"
expect 200 "${url}page/main.js"
expect 200 "${url}page/uPlot.iife.min.js"
expect 200 "${url}page/curves.js"
expect 200 "${url}api/open" -d '{}'
session=$(python3 -c 'import json; print(json.load(open("content"))["session"])')
[[ $session =~ ^[0-9a-f]{32}$ ]] || fail "no session: $session"
api=${url}api

# the error of a changed model equals the error that compare reports
expect 200 "$api/change?s=$session" -d '{"step":0,"values":{"GENROU.H":4}}'
python3 -c 'import json; print(*("%.6g" % c["rms"] for c in json.load(open("content"))["chips"]))' >changed
sed 's/^H = 6.54 /H = 4.0 /' "$model" >changed.toml
"$swingbank" compare --model changed.toml --records "$record" --power-only --out compared --quiet >/dev/null || true
python3 -c 'import json
channels = json.load(open("compared/compare.json"))["events"][0]["channels"]
print(*("%.6g" % (c["whole"]["rms_pu"] * c["units_in_pu"]) for c in channels))' >expected
cmp changed expected || fail "the page says $(<changed), compare says $(<expected)"

# nobody else gets an answer: without the token, with another token, from another page or host
expect 403 "$base/"
expect 403 "$base/$(printf '0%.0s' {1..32})/"
expect 403 "$base/api/open" -d '{}'
expect 403 -H 'Origin: http://example.org' "$api/open" -d '{}'
expect 403 -H 'Origin: null' "$api/open" -d '{}'
expect 403 -H 'Host: example.org' "$url"
expect 200 -H "Origin: $base" "$api/open" -d '{}'
# a new session has no steps of the first one
other=$(python3 -c 'import json; print(json.load(open("content"))["session"])')
expect 400 "$api/step?s=$other&k=1"
expect 200 "$api/step?s=$session&k=1"
expect 400 "$api/step?s=none&k=0"

# only the page's own files are served
for path in '../../etc/passwd' '..%2f..%2fetc%2fpasswd' 'page/../../../etc/passwd' 'page/..%2f..%2fetc%2fpasswd' 'page//etc/passwd'; do
  status=$(answer --path-as-is "$url$path")
  [[ $status == 40[034] ]] || fail "status $status for $path"
  ! grep -q root: content || fail "$path leaves the page's folder"
done

# large, broken and absurd requests end with a message
head -c 10000000 /dev/zero >large
status=$(answer -H 'Expect:' --data-binary @large "$api/change?s=$session") || true
[[ $status == 413 || $status == 000 ]] || fail "status $status for a body of 10 MB"
for body in '' '{' '[]' 'null' '{"step":0}' '{"step":1e99,"values":{}}' '{"step":0,"values":{"GENROU.H":"x"}}' \
  '{"step":0,"values":{"GENROU.H":-1e300}}' '{"step":-5,"values":{}}' '{"step":0,"values":{"X":1}}'; do
  expect 400 "$api/change?s=$session" -d "$body"
done
expect 400 "$api/preview?s=$session" -d '{"seq":1,"step":0,"event":99,"values":{}}'
expect 400 "$api/curves?s=$session&k=0&e=99"
# a preview older than the newest request is not computed (status 204)
expect 200 "$api/preview?s=$session" -d '{"seq":7,"step":0,"event":0,"values":{"GENROU.H":5}}'
expect 204 "$api/preview?s=$session" -d '{"seq":6,"step":0,"event":0,"values":{"GENROU.H":5}}'

# 200 idle connections do not stop the page
port=${base##*:}
python3 - "$port" "${url#"$base"}" <<'PYTHON'
import http.client, socket, sys, time
port, path = int(sys.argv[1]), sys.argv[2]
idle = [socket.create_connection(("127.0.0.1", port)) for _ in range(200)]
start = time.monotonic()
page = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
page.request("GET", path)
assert page.getresponse().status == 200
print(f"answered beside {len(idle)} idle connections after {time.monotonic() - start:.2f} s")
PYTHON

# a fit that fails, and one whose process dies, leave the server alive
curl -sN --max-time 120 "$api/stream?s=$session" >stream &
listening=$!
expect 200 "$api/fit?s=$session" -d '{"kind":"add","step":0,"effect":"NOTHING"}'
for ((k = 0; k < 600; ++k)); do
  grep -q '"failed"' stream && break
  sleep 0.1
done
grep -q "there is no effect of that name" stream || fail "the failure is not reported: $(<stream)"
for ((k = 0; k < 100; ++k)); do # the fit's process ends just after its last message
  [[ $(answer "$api/fit?s=$session" -d '{"kind":"calibrate","step":0}') == 200 ]] && break
  sleep 0.1
done
((k < 100)) || fail "no second fit"
forks=$(pgrep -P "$server" | head -1)
for ((k = 0; k < 100; ++k)); do
  fit=$(pgrep -P "$forks" | head -1) && break
  sleep 0.05
done
kill -SEGV "$fit"
for ((k = 0; k < 300; ++k)); do
  grep -q 'ended without a result' stream && break
  sleep 0.1
done
grep -q 'ended without a result' stream || fail "the crash of a fit is not reported: $(tail -c 300 stream)"
expect 200 "$api/step?s=$session&k=0"

# nothing is written before saving; the saved model is that of the step
[[ ! -e saved ]] || fail "something was written before saving: $(ls saved)"
expect 200 "$api/save?s=$session" -d '{"step":1}'
grep -q 'H = 4' saved/model.toml || fail "the saved model is not the step"
[[ -s saved/model.dyr && -s saved/report.html ]] || fail "records or report are missing: $(ls saved)"
cmp <("$swingbank" export --model saved/model.toml --format dyd | grep -v '^#') <(grep -v '^#' saved/model.dyd) ||
  fail "the PSLF records are not those of export"

kill -TERM "$server"
status=0
wait "$server" || status=$?
((status == 0)) || fail "exit code $status after SIGTERM"
wait "$listening" || true
! pgrep -g "$$" -f swingbank-serve >/dev/null || fail "a process of the server is left"

refuses 'port in use' 'port [0-9]+' bash -c "python3 -c 'import socket, subprocess, sys
s = socket.socket(); s.bind((\"127.0.0.1\", 0)); s.listen()
sys.exit(subprocess.call(sys.argv[1:] + [\"--port\", str(s.getsockname()[1])]))' '$swingbank' serve --model '$model' --records '$record'"
