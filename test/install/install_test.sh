#!/bin/sh
# install_test.sh BUILD: installs the build in a temporary folder, then builds and runs a program
# that uses what was installed, from plain CMake.
set -eu
build=$1
source=$(dirname "$0")/consumer
# Not below the package: roslaunch would find each launch file twice.
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --install "$build" --prefix "$folder/prefix" > "$folder/install.log"
cmake -S "$source" -B "$folder/consumer" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH="$folder/prefix"
cmake --build "$folder/consumer"
"$folder/consumer/consumer"
