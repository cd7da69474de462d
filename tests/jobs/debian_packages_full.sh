#!/usr/bin/env bash
# cpack -G DEB: the packages of this build pass lintian, swingbank depends on neither MPI nor LibTorch, and its commands
# run from the unpacked package.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/debian_packages.bash"
make_packages "$work/packages"
cd "$work/packages"

wanted=(libswingbank-dev swingbank swingbank-train)
if [[ -d $SWINGBANK_BIN/../python/swingbank ]]; then wanted+=(python3-swingbank); fi
for level in "$SWINGBANK_BIN"/x86-64-v?; do
  if [[ -d $level ]]; then wanted+=("swingbank-${level##*/}"); fi
done
cmp <(for one in *.deb; do dpkg-deb -f "$one" Package; done | sort) <(printf '%s\n' "${wanted[@]}" | sort) || fail "packages: $(ls)"
# lintian takes as long for the static libraries as for all other packages, so they are checked nightly only.
for package in "${wanted[@]:1}"; do check "$package"_*.deb; done

# depends PACKAGE: the names of the packages that it depends on
depends() { dpkg-deb -f "$1"_*.deb Depends | tr ',|' '\n\n' | sed 's/^ *//; s/ .*//' | sort -u; }
foreign='openmpi|libtorch|libc10|libhdf5-openmpi'
depends swingbank | grep -qx 'libhdf5-103-1' || fail "swingbank depends on no serial HDF5: $(depends swingbank | xargs)"
! depends swingbank | grep -qE "$foreign" || fail "swingbank depends on $(depends swingbank | grep -E "$foreign" | xargs)"
for library in libopenmpi3 libhdf5-openmpi-103-1 swingbank; do
  depends swingbank-train | grep -qx -e "$library" ||
    fail "swingbank-train depends on no $library: $(depends swingbank-train | xargs)"
done
if [[ -e $SWINGBANK_BIN/swingbank_learning ]]; then
  depends swingbank-train | grep -qx 'libtorch1.13' || fail "swingbank-train depends on no LibTorch"
fi
for package in "${wanted[@]}"; do
  packed=$(stat -c %s "$package"_*.deb)
  echo "$package: $(dpkg-deb -f "$package"_*.deb Installed-Size) KiB installed, $((packed / 1024)) KiB packed"
done
(($(dpkg-deb -f swingbank_*.deb Installed-Size) <= 40000000 / 1024)) || fail "swingbank takes more than 40 MB"

dpkg-deb -x swingbank_*.deb "$work/root"
usr=$work/root/usr
share=$usr/share
for file in man/man1/swingbank.1.gz man/man1/swingbank-compare.1.gz doc/swingbank/changelog.Debian.gz \
  bash-completion/completions/swingbank; do
  [[ -s $share/$file ]] || fail "no $file"
done
listed=$(zcat "$share/man/man1/swingbank.1.gz" | sed 's/\\//g' | sed -nE 's/^\.BR (swingbank-[a-z-]+) \(1\)$/\1/p' | sort)
cmp <(echo "$listed") <(cd "$share/man/man1" && printf '%s\n' swingbank-*.1.gz | sed 's/\.1\.gz$//') || fail "swingbank(1) refers to $listed"
! zcat "$share/man/man1/swingbank.1.gz" | holds -qxE 'train|generate|databank' || fail "swingbank(1) lists commands of swingbank-train"
for words in 'BSD-3-Clause' 'Copyright: 2022 Leon Sorokin'; do
  grep -qF "$words" "$share/doc/swingbank/copyright" || fail "copyright lacks $words"
done
export PATH=$usr/bin:$PATH
mkdir "$work/empty"
cd "$work/empty"
first_comparison || fail "compare: $(tail -n 5 "$work/compare")"
refuses "dataset without swingbank-train" 'install swingbank-train' swingbank generate

dpkg-deb -x "$work"/packages/swingbank-train_*.deb "$work/root"
dataset=$(swingbank configs)/datasets/ieee14_genrou_bus3.toml
swingbank generate "$dataset" --draws 12 --out data >"$work/log" 2>&1 || fail "generate: $(tail -n 3 "$work/log")"
readelf -d "$usr"/libexec/swingbank/swingbank* | holds -q 'NEEDED.*libmpi' || fail "readelf finds no library"
! readelf -d "$usr"/libexec/swingbank/swingbank* | holds -E 'RPATH|RUNPATH' || fail "folders of the build machine are searched"
