#!/usr/bin/env bash
# packaging/oci: buildah builds the image from the packages of this build on a base of mmdebstrap, and README's first
# example gives the same result in a container as here. Then the Apptainer definition's %post and %test run on the same
# base, because Apptainer is not part of Debian. Needs a Debian mirror and root.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/debian_packages.bash"
source "$(dirname "${BASH_SOURCE[0]}")/apptainer.bash"
for program in buildah podman mmdebstrap; do
  command -v "$program" >/dev/null && continue
  echo "SKIPPED: oci_image: no $program"
  exit 0
done
build() { bash "$SWINGBANK_SOURCE/packaging/oci/build.sh" "$@"; }

mkdir "$work/none"
refuses "no folder" 'no folder at PACKAGES' build
refuses "a folder without packages" "0 files swingbank_\\*.deb at $work/none" build "$work/none"
refuses "two bases" 'two bases at --bootstrap' build "$work/none" --bootstrap --base debian:12
refuses "unknown option" 'unknown option at --colour' build "$work/none" --colour

# Images of this test only. The driver vfs needs no mounts, chroot no new namespaces.
export CONTAINERS_STORAGE_CONF=$work/storage.conf BUILDAH_ISOLATION=chroot
printf '[storage]\ndriver = "vfs"\ngraphroot = "%s"\nrunroot = "%s"\n' "$work/storage" "$work/run" \
  >"$CONTAINERS_STORAGE_CONF"
make_packages "$work/packages"
image=localhost/swingbank:test
build "$work/packages" --bootstrap --name "$image" >"$work/built" 2>&1 || fail "build: $(tail -n 20 "$work/built")"
grep -qx "image: $image" "$work/built" || fail "build: $(tail -n 3 "$work/built")"
echo "image: $(($(podman image inspect --format '{{.Size}}' "$image") / 1000000)) MB"

# contained ARGUMENT...: swingbank in a container, with $work/first as /data. Where Podman cannot start one with its own
# settings, runc with lower limits is tried, and a chroot of buildah.
container=$(buildah from "$image")
started() { "$1" swingbank --version >"$work/log" 2>&1; }
# figures FOLDER: compare.json without its provenance, which has the date
figures() {
  python3 - "$1/compare.json" <<'PYTHON'
import json, sys
result = json.load(open(sys.argv[1]))
result.pop("provenance")
print(json.dumps(result, indent=1))
PYTHON
}
by_podman() { podman run --rm --network none --volume "$work/first:/data" "$image" "${@:2}"; }
by_runc() {
  podman --runtime runc run --rm --network none --ulimit nofile=1024:1024 --ulimit nproc=1024:1024 \
    --volume "$work/first:/data" "$image" "${@:2}"
}
by_chroot() { buildah run --volume "$work/first:/data" "$container" -- "$@"; }
mkdir "$work/first"
contained=
for way in by_podman by_runc by_chroot; do
  if started "$way"; then contained=$way && break; fi
  echo "not started $way: $(tail -n 1 "$work/log")"
done
[[ -n $contained ]] || fail "no container starts"
echo "ok: containers start $contained: $(cat "$work/log")"
buildah run "$container" -- sh -c "dpkg-query --show --showformat '\${Package}\n'" >"$work/installed"
! grep -E '^(libopenmpi3|libtorch)' "$work/installed" || fail "MPI or LibTorch is in the image"

cd "$work/first"
export PATH=$SWINGBANK_BIN:$PATH
first_comparison || fail "compare here: $(tail -n 5 "$work/compare")"
mv "$work/compare" "$work/here"
mv comparison "$work/comparison"
read -r -a example < \
  <(sed -n 's/^swingbank \(compare --model .* --out comparison\)$/\1/p' "$SWINGBANK_SOURCE/README.md")
status=0
# shellcheck disable=SC2068 # the pattern expands to the files, whose paths are the same in the container
"$contained" swingbank ${example[@]} >"$work/compare" 2>&1 || status=$?
((status == 3)) || fail "exit code $status in the container, expected 3: $(tail -n 5 "$work/compare")"
diff "$work/here" "$work/compare" || fail "the container's comparison differs"
cmp <(figures "$work/comparison") <(figures comparison) || fail "the container's compare.json differs"
[[ -s comparison/report.html ]] || fail "no report"
echo "ok: the README's first comparison: exit code 3, $(tail -n 1 "$work/compare")"
refuses "dataset in the small image" 'install swingbank-train' "$contained" swingbank generate

# The Apptainer definition, with the packages of this build in place of build/portable.
apptainer=$(buildah from localhost/debian:12)
while read -r file target; do
  # shellcheck disable=SC2086 # the name of a file is a pattern
  buildah add "$apptainer" "$work"/packages/${file##*/} "$target" >"$work/log" 2>&1 || fail "%files: $(cat "$work/log")"
done < <(section_of files)
for section in post test; do
  { section_of environment; section_of "$section"; } >"$work/$section.sh"
  buildah run --volume "$work/$section.sh:/section.sh" "$apptainer" -- sh -e /section.sh >"$work/log" 2>&1 ||
    fail "%$section: $(tail -n 20 "$work/log")"
done
echo "ok: Apptainer's %post and %test: $(tail -n 1 "$work/log")"
