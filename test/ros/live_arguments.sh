#!/bin/sh
# live_arguments.sh FILE.launch: every argument of live.launch arrives as the node's parameter.
set -eu
parameters() { roslaunch "$1" --dump-params initial_intrinsics:='[400, 401, 320, 240, 0.9]' \
  mask_url:=file:///m.png camera_info_input:=compare world_frame:=here child_frame:=eye \
  publish_tf:=false camera_info_url:=file:///c.yaml state_file:=s model:=fov name:=front "manager:=$2"; }
for manager in "" /manager; do
  found=$(parameters "$1" "$manager")
  for line in 'initial_intrinsics:' 'mask_url: file:///m.png' \
    'camera_info_input: compare' 'world_frame: here' 'child_frame: eye' 'publish_tf: false' \
    'camera_info_url: file:///c.yaml' 'state_file: s' 'alpha: 0.95'; do
    echo "$found" | grep -q "^/front/$line\$" || { echo "not there: $line"; echo "$found"; exit 1; }
  done
  echo "$found" | tr '\n' ' ' | grep -q 'initial_intrinsics: - 400 - 401 - 320 - 240 - 0.9 '
done
