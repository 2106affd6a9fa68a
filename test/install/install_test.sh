#!/bin/sh
# install_test.sh BUILD FOLDER: installs the build below FOLDER, then builds and runs a program that
# uses what was installed, from plain CMake.
set -eu
build=$1
folder=$2
source=$(dirname "$0")/consumer
rm -rf "$folder"
mkdir -p "$folder"
cmake --install "$build" --prefix "$folder/prefix" > "$folder/install.log"
cmake -S "$source" -B "$folder/consumer" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH="$folder/prefix"
cmake --build "$folder/consumer"
"$folder/consumer/consumer"
