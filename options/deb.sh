#!/usr/bin/env bash
# Makes a Debian package of a folder's root/, which make install has filled:  options/deb.sh output/deb
# The libraries that it needs are those that dpkg-shlibdeps finds (package dpkg-dev).
set -eu
here=$(dirname "$(readlink -f "$0")")
cd "$1"
version=$(root/usr/bin/isph -version | sed 's/isph \([^,]*\),.*/\1/')
architecture=$(dpkg --print-architecture)

binaries() { find root/usr/bin root/usr/lib -type f -exec sh -c 'head -c 4 "$1" | grep -q ELF && echo "$1"' sh {} \; ; }
binaries | xargs strip --strip-unneeded
mkdir -p debian root/DEBIAN root/usr/share/doc/isph
gzip -9nf root/usr/share/man/man1/isph.1
cp "$here/../LICENSE" root/usr/share/doc/isph/copyright
gzip -9nc "$here/../CHANGELOG.md" >root/usr/share/doc/isph/changelog.gz
cp "$here/../README.md" "$here/CITATION.cff" root/usr/share/doc/isph/
printf 'Source: isph\n\nPackage: isph\nArchitecture: any\n' >debian/control
needs=$(binaries | xargs dpkg-shlibdeps -O -lroot/usr/lib/isph 2>/dev/null | sed -n 's/^shlibs:Depends=//p')
cat >root/DEBIAN/control <<END
Package: isph
Version: $version
Architecture: $architecture
Maintainer: the isph authors <isph@localhost>
Section: science
Priority: optional
Depends: $needs, openmpi-bin, python3, python3-numpy, python3-h5py
Recommends: python3-matplotlib, python3-vtk9, libjs-three, xvfb
Suggests: ffmpeg, python3-pandas, python3-mpi4py
Installed-Size: $(du -sk root/usr | cut -f 1)
Description: incompressible smoothed particle hydrodynamics on PETSc
 Drops, splashes and other free-surface flows of liquids with surface tension
 and contact angles, by particles: program, library with header, Python
 module, scenes, pictures, manual page.
END
(cd root && find usr -type f -print0 | sort -z | xargs -0 md5sum >DEBIAN/md5sums)
dpkg-deb --root-owner-group --build root "isph_${version}_$architecture.deb"
