#!/usr/bin/env bash
# Builds the OCI image of Swingbank with buildah from the Debian packages of `cpack -G DEB`.
#   bash packaging/oci/build.sh PACKAGES [--train] [--name NAME] [--base IMAGE | --bootstrap]
# PACKAGES is the folder of the .deb files. The packages of swingbank for wider instruction sets are installed if they
# exist. --train also installs swingbank-train (MPI, LibTorch). --base names another base image. --bootstrap creates the
# base image with mmdebstrap from this machine's Debian mirror, without a registry; it needs root. On a machine that
# cannot start containers, set BUILDAH_ISOLATION=chroot.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
usage="bash packaging/oci/build.sh PACKAGES [--train] [--name NAME] [--base IMAGE | --bootstrap]"
stop() {
  echo "$*" >&2
  exit 1
}
folder='' name='' base='' packages=swingbank bootstrap=''
while (($#)); do
  case $1 in
    --train) packages="swingbank swingbank-train" ;;
    --bootstrap) bootstrap=yes ;;
    --name | --base)
      [[ -n ${2:-} ]] || stop "no value at $1 (an image is expected): $usage"
      if [[ $1 == --name ]]; then name=$2; else base=$2; fi
      shift
      ;;
    -*) stop "unknown option at $1 (this script has no such option): $usage" ;;
    *)
      [[ -z $folder ]] || stop "a second folder at $1 (all packages are in one): $usage"
      folder=$1
      ;;
  esac
  shift
done
[[ -n $folder ]] || stop "no folder at PACKAGES (the image is made of .deb files): $usage"
[[ -z $base || -z $bootstrap ]] || stop "two bases at --bootstrap (--base names one too): $usage"
for level in v3 v4; do
  if compgen -G "$folder/swingbank-x86-64-${level}_*.deb" >/dev/null; then packages+=" swingbank-x86-64-$level"; fi
done
for package in $packages; do
  mapfile -t found < <(compgen -G "$folder/${package}_*.deb" || true)
  ((${#found[@]} == 1)) || stop "${#found[@]} files ${package}_*.deb at $folder (one is needed):" \
    "make the packages with cpack -G DEB in an empty folder (packaging/README.md)"
done
command -v buildah >/dev/null || stop "no buildah at $0 (it builds the image): apt-get install buildah"
if [[ -n $bootstrap ]]; then
  command -v mmdebstrap >/dev/null ||
    stop "no mmdebstrap at --bootstrap (it makes the base): apt-get install mmdebstrap"
  base=localhost/debian:12
  root=$(mktemp)
  trap 'rm -f "$root"' EXIT
  mmdebstrap --quiet --variant=minbase --format=tar bookworm - >"$root"
  scratch=$(buildah from scratch)
  buildah add "$scratch" "$root" / >/dev/null
  buildah commit --quiet --rm "$scratch" "$base" >/dev/null
fi
version=$(dpkg-deb -f "$folder"/swingbank_*.deb Version)
name=${name:-localhost/swingbank:${version%-*}}
buildah build --layers=false --network=host ${base:+--build-arg "BASE=$base"} --build-arg "PACKAGES=$packages" \
  --label "org.opencontainers.image.version=${version%-*}" --tag "$name" --file "$here/Containerfile" "$folder"
echo "image: $name"
