#!/bin/sh
# run_rostest.sh FILE.test: runs it and, if it fails, shows what the test programs printed. (With
# its option --text rostest would show that too, but then return 0 whatever happened.)
set -u
rm -rf "$ROS_HOME"
rostest "$1"
code=$?
if [ $code -ne 0 ]; then
  find "$ROS_HOME" -name '*.log' ! -name 'master*' ! -name 'roslaunch*' ! -name 'rostest*' \
    -exec sh -c 'echo "--- $1"; tail -n 100 "$1"' sh {} \;
  find "$ROS_HOME" -name '*.xml' -exec grep -h -A 3 '<failure' {} +
fi
exit $code
