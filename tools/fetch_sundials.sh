#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
#
# Puts KINSOL of SUNDIALS (BSD-3-Clause) into a folder: headers and static archives, 1 MB to fetch.
#   tools/fetch_sundials.sh FOLDER
# Taken out of Debian's package libsundials-dev and not installed: that would bring 150 packages (MPI, PETSc, Trilinos)
# of which KINSOL with its dense solver needs none. apt checks the package's signature.
set -eu
folder=$1
package=libsundials-dev

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"
cd "$work"
apt-get download "$package" || { apt-get update && apt-get download "$package"; }
dpkg-deb -x "$package"_*.deb tree

cd - >/dev/null
# Filled beside its place and then renamed: an interrupted run leaves nothing that looks whole.
fresh=$folder.new
rm -rf "$fresh"
mkdir -p "$fresh/include" "$fresh/lib"
for part in kinsol nvector sundials sunlinsol sunmatrix; do cp -r "$work/tree/usr/include/$part" "$fresh/include/"; done
for part in kinsol nvecserial sunlinsoldense sunmatrixdense; do
  cp "$work"/tree/usr/lib/*/libsundials_$part.a "$fresh/lib/"
done
rm -rf "$folder"
mv "$fresh" "$folder"
