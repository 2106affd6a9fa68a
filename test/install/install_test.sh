#!/bin/sh
# install_test.sh BUILD [catkin]: installs the build in a temporary folder, then builds and runs a
# program that uses what was installed, from plain CMake and, where that is told, from catkin.
set -eu
build=$1 catkin=${2:-}
source=$(realpath "$(dirname "$0")")
# Not below the package: roslaunch would find each launch file twice.
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --install "$build" --prefix "$folder/prefix" > "$folder/install.log"
# Without the devel space of a workspace that is sourced, which would be found first.
prefixes="$folder/prefix;/opt/ros/${ROS_DISTRO:-none};/usr"
for consumer in consumer ${catkin:+catkin_consumer}; do
  cmake -S "$source/$consumer" -B "$folder/$consumer" -DCMAKE_BUILD_TYPE=Debug "-DCMAKE_PREFIX_PATH=$prefixes"
  cmake --build "$folder/$consumer"
  program=$(find "$folder/$consumer" -name consumer -type f -perm -u+x)
  "$program"
done
