#!/bin/sh
# programs_as_printed.sh README BUILD: every program that README.md tells to start is where it says,
# and starts, from the build as printed and from an installed tree.
set -e
printed=$(grep -o '^build/devel/lib/camera_self_calibration/[a-z_]*' "$1" | sort -u)
[ "$(echo "$printed" | wc -l)" -ge 3 ] || { echo "README.md prints too few programs: $printed"; exit 1; }
installed=$(mktemp -d)
trap 'rm -rf "$installed"' EXIT
cmake --install "$2" --prefix "$installed" > "$installed/log" || { cat "$installed/log"; exit 1; }
for path in $printed; do
  program=${path##*/}
  "$2/devel/lib/camera_self_calibration/$program" --help > /dev/null
  env -u LD_LIBRARY_PATH "$installed/lib/camera_self_calibration/$program" --help > /dev/null
done
# Debian's rosrun leaves out what lies in a folder build of the package.
if grep '^rosrun' "$1" | grep -v '# in a workspace'; then
  echo "README.md prints rosrun without saying that it needs a workspace"
  exit 1
fi
