# To be sourced after lib.bash: the parts that two equivalent trainings have in common.
# shellcheck disable=SC2154 # set by lib.bash

# A network's header contains the training's times; the weights follow, and last the checksum of the file.
cat >"$work/network.py" <<'PYTHON'
import hashlib, json, struct, sys
data = open(sys.argv[1], "rb").read()
at = data.index(b"\n") + 1
end = at + 8 + struct.unpack("<Q", data[at : at + 8])[0]
header = json.loads(data[at + 8 : end])
for time in ("seconds", "processor_seconds"):
    del header["training"][time]
print(hashlib.sha256(json.dumps(header).encode() + data[end:-8]).hexdigest())
PYTHON
# essence FOLDER: a line per file, without times
essence() {
  (cd "$1" && find . -type f ! -name '*.lock' ! -name .lock | sort | while IFS= read -r file; do
    case $file in
      *.json) printf '%s ' "$file"; grep -vE '"(processor_seconds|seconds|seconds_per_epoch)"' "$file" | sha256sum ;;
      *.network) printf '%s ' "$file"; /usr/bin/python3 "$work/network.py" "$file" ;;
      *) sha256sum "$file" ;;
    esac
  done)
}
