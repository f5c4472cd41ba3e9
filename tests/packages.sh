#!/usr/bin/env bash
# The Debian packages the program needs:  tests/packages.sh [build] [pictures] [browser] [hosts] [film] [gallery]
# [reference]
# Without a word: build, pictures. As root, installs what is missing; otherwise prints the line to type and exits 1.
# Silent if nothing is missing.
set -u
build="gcc libc6-dev make pkg-config libopenmpi-dev petsc-dev slepc-dev libhdf5-mpi-dev libmetis-dev"
pictures="python3-h5py python3-matplotlib python3-vtk9 libjs-three xvfb"
browser="chromium"
hosts="iproute2"
film="ffmpeg"
gallery="python3-markdown"
reference="gerris libgfs-dev python3-numpy python3-scipy"

wanted=
for set in "${@:-both}"; do
  case $set in
    build)    wanted="$wanted $build" ;;
    pictures) wanted="$wanted $pictures" ;;
    browser)  wanted="$wanted $browser" ;;
    hosts)    wanted="$wanted $hosts" ;;
    film)     wanted="$wanted $film" ;;
    gallery)  wanted="$wanted $gallery" ;;
    reference) wanted="$wanted $reference" ;;
    both)     wanted="$wanted $build $pictures" ;;
    *)        echo "packages.sh: $set is no set: build pictures browser hosts film gallery reference" >&2; exit 1 ;;
  esac
done
if ! command -v dpkg-query >/dev/null; then
  echo "packages.sh: not a Debian system; not checked:$wanted" >&2
  exit 0
fi

missing=
for package in $wanted; do
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
  echo "packages.sh: installs$missing"
  export DEBIAN_FRONTEND=noninteractive
  # A fresh machine has no lists of packages yet: fetch them only if needed.
  # shellcheck disable=SC2086
  install() { apt-get install -y -qq --no-install-recommends $missing >/dev/null; }
  install 2>/dev/null || { apt-get update -qq && install; } && exit 0
  echo "packages.sh: apt-get could not install$missing" >&2
  exit 1
fi
echo "packages are missing; as root type:"
echo "apt-get install --no-install-recommends$missing"
exit 1
