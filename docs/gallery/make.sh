#!/usr/bin/env bash
# Runs the commands of README.md, which write the reports of the gallery, and takes pictures of the reports.
#   bash docs/gallery/make.sh FOLDER [--pictures]    reports, commands and outcome.txt go into FOLDER
# --pictures also renews the PNG files beside this script (needs chromium-driver and python3-selenium).
# SWINGBANK_BIN: folder of the commands; default: build/release/bin.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
source=$(cd "$here/../.." && pwd)
PATH=${SWINGBANK_BIN:-$source/build/release/bin}:$PATH
[[ -n ${1:-} ]] || {
  sed -n '2,5s/^# //p' "$0" >&2
  exit 1
}
mkdir -p "$1"
cd "$1"
cp -rL "$source/configs" .
chmod -R u+w configs

# records FOLDER DYR-RECORD: adds this record to the case, and simulates four events at bus 2 with the noise of a PMU
records() {
  local folder=$1 case=configs/networks/ieee14_genrou k=0 event
  mkdir -p "$folder"
  { cat "$case.dyr" && echo "$2"; } >"$folder/plant.dyr"
  for event in "${events[@]}"; do
    k=$((k + 1))
    # shellcheck disable=SC2086 # option and value
    swingbank simulate --raw "$case.raw" --dyr "$folder/plant.dyr" $event --t-end 15 --rate 60 --plants 2 \
      --channels P,Q --buses 2 --measure NOISE:relative=0.0002,angle=0.0002,I=0.001 --measure-seed $k \
      --out "$folder/event$k.csv" >>log 2>&1
  done
}
# submitted FOLDER DYR: writes the plant file that the owner submits
submitted() {
  swingbank plant --raw configs/networks/ieee14_genrou.raw --dyr "$2" --bus 2 --out "$1/model.toml" >>log 2>&1
}
events=("--load-step 4:40:10:2:10" "--load-step 9:-20:-5:2:6" "--fault 5:2:2.1" "--load-step 13:25:10:2:9")
records governor "2 'TGOV1' '1' 0.05 0.4 1 0 2.1 7 0 /"
submitted governor configs/networks/ieee14_genrou.dyr
events=("--fault 5:2:2.1" "--fault 4:2:2.08" "--fault 9:2:2.2" "--fault 1:2:2.15:0.05:0.1")
records values "2 'SEXS' '1' 0.1 10 100 0.05 -4 5 /"
sed "/^2 'GENROU'/{s/ 6.54 / 5.03 /; s/ 0.4 0.6 / 0.52 0.6 /}; s/ 100 0.05 / 130 0.05 /" \
  values/plant.dyr >values/submitted.dyr
submitted values values/submitted.dyr

# Exit codes 3 to 5 are verdicts, not failures.
grep '^swingbank' "$here/README.md" >commands
while read -r line; do
  echo "$line"
  eval "$line" >>log 2>&1 </dev/null || (($? >= 3 && $? <= 5)) || {
    tail -n 5 log >&2
    exit 1
  }
done <commands
python3 "$here/outcome.py" >outcome.txt
cat outcome.txt
[[ ${2:-} != --pictures ]] || /usr/bin/python3 "$here/pictures.py" "$here"
