#!/usr/bin/env bash
# The Debian packages on a fresh Debian 12: apt installs swingbank, and the README's first example runs; then apt
# installs the others. Prints the time from the start of apt to the end of the example. lintian checks the library's
# package. Needs a Debian mirror.
# shellcheck disable=SC2154,SC2016 # set by lib.bash; the hooks expand their variables
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/debian_packages.bash"
make_packages "$work/packages"
check "$work"/packages/libswingbank-dev_*.deb

line=$(sed -n 's/^swingbank compare --model .* --out comparison$/&/p' "$SWINGBANK_SOURCE/README.md")
[[ -n $line ]] || fail "the README's example is not found"
cat >"$work/first.sh" <<TEXT
set -e
export DEBIAN_FRONTEND=noninteractive
cd /packages
begin=\$(date +%s%N)
apt-get install -y ./swingbank_*.deb >/packages/log 2>&1 || { tail -n 20 /packages/log; exit 1; }
installed=\$(date +%s%N)
mkdir /first
cd /first
cp -r "\$(swingbank configs)" .
status=0
$line >/packages/log 2>&1 || status=\$?
[ \$status = 3 ] && [ -s comparison/report.html ] || { echo "compare: exit code \$status"; cat /packages/log; exit 1; }
compared=\$(date +%s%N)
echo "apt install took \$(((installed - begin) / 1000000)) ms"
echo "the first comparison is there after \$(((compared - begin) / 1000000)) ms"
if dpkg -l | grep -E '^ii +(libopenmpi3|libtorch)'; then echo "MPI or LibTorch is installed"; exit 1; fi
apt-get install -y /packages/*.deb >/packages/log 2>&1 || { tail -n 20 /packages/log; exit 1; }
dataset=\$(swingbank configs)/datasets/ieee14_genrou_bus3.toml
swingbank generate "\$dataset" --draws 12 --out data >/packages/log 2>&1 || { cat /packages/log; exit 1; }
if [ -e /packages/python ]; then
  python3 -c 'import swingbank
swingbank.Plant("configs/plants/ieee14_bus2.toml").play("configs/records/record-example/avr_ev1.csv")
print("import swingbank: ok")'
fi
apt-get purge -y swingbank >/packages/log 2>&1 || { tail -n 20 /packages/log; exit 1; }
if [ -e /usr/libexec/swingbank ]; then echo "left behind:"; find /usr/libexec/swingbank; exit 1; fi
TEXT
if compgen -G "$work/packages/python3-*.deb" >/dev/null; then touch "$work/packages/python"; fi
mmdebstrap --variant=minbase --format=null --customize-hook="cp -r '$work/packages' '$work/first.sh' \"\$1\"" \
  --customize-hook='chroot "$1" sh /first.sh' bookworm >"$work/said" 2>&1 || fail "$(tail -n 30 "$work/said")"
grep -e '^apt install took' -e '^the first comparison is there' -e '^import swingbank: ok' "$work/said" ||
  fail "the first comparison did not run: $(tail -n 30 "$work/said")"
