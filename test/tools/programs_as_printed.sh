#!/bin/sh
# programs_as_printed.sh BUILD SOURCE: every program that README.md or a page of doc/ tells to start is
# where it says, and starts, from the build as printed and from an installed tree.
set -e
build=$1
pages="$2/README.md $2/doc/*.md"
# shellcheck disable=SC2086
printed=$(grep -oh '^build/devel/lib/camera_self_calibration/[a-z_]*' $pages | sort -u)
[ "$(echo "$printed" | wc -l)" -ge 3 ] || { echo "the pages print too few programs: $printed"; exit 1; }
installed=$(mktemp -d)
trap 'rm -rf "$installed"' EXIT
cmake --install "$build" --prefix "$installed" > "$installed/log" || { cat "$installed/log"; exit 1; }
for path in $printed; do
  program=${path##*/}
  "$build/devel/lib/camera_self_calibration/$program" --help > /dev/null
  env -u LD_LIBRARY_PATH "$installed/lib/camera_self_calibration/$program" --help > /dev/null
done
# Debian's rosrun leaves out what lies in a folder build of the package.
# shellcheck disable=SC2086
if grep -h '^rosrun' $pages | grep -v '# in a workspace'; then
  echo "a page prints rosrun without saying that it needs a workspace"
  exit 1
fi
