#!/bin/sh
# Installs a build into a folder, then moves that elsewhere: what is found later must not depend on where it was put.
#
#   install.sh BUILD PREFIX
# CMAKE names the program to use.
set -eu
build=$1 prefix=$2
rm -rf "$prefix" "$prefix.first"
"$CMAKE" --install "$build" --prefix "$prefix.first"
mv "$prefix.first" "$prefix"
