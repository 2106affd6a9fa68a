#!/bin/sh
# install_test.sh BUILD [CATKIN_DIR]: installs the build in a temporary folder, then builds and runs a
# program that uses what was installed, from plain CMake and, if it is told where catkin is, from catkin.
set -eu
build=$1 catkin_dir=${2:-}
source=$(realpath "$(dirname "$0")")
# Not below the package: roslaunch would find each launch file twice.
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --install "$build" --prefix "$folder/prefix" > "$folder/install.log"
# Ahead of a workspace that is sourced, whose devel space would be found else.
prefixes="$folder/prefix${catkin_dir:+;$catkin_dir/../../..}"
for consumer in consumer ${catkin_dir:+catkin_consumer}; do
  cmake -S "$source/$consumer" -B "$folder/$consumer" -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_PREFIX_PATH=$prefixes"
  cmake --build "$folder/$consumer"
  program=$(find "$folder/$consumer" -name consumer -type f -perm -u+x)
  "$program"
done
