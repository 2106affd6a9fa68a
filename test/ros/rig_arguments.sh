#!/bin/sh
# rig_arguments.sh FILE.launch: every argument of rig.launch arrives as the node's parameter.
set -eu
for manager in "" /manager; do
  found=$(roslaunch "$1" --dump-params image_topics:='[/a/image_raw, /b/image_raw]' \
    camera_names:='[a, b]' camera_frames:='[fa, fb]' baseline:=0.1 model:=fov name:=front \
    transport:=raw publish_tf:=true camera_info_urls:='["file:///a.yaml", "file:///b.yaml"]' \
    camchain_file:=c.yaml state_folder:=kept "manager:=$manager")
  for line in 'baseline: 0.1' 'model: fov' 'image_transport: raw' 'publish_tf: true' \
    'camchain_file: c.yaml' 'state_folder: kept' 'rig_keyframes: 240'; do
    echo "$found" | grep -q "^/front/$line\$" || { echo "not there: $line"; echo "$found"; exit 1; }
  done
  for list in 'image_topics: - /a/image_raw - /b/image_raw ' 'camera_names: - a - b ' \
    'camera_frames: - fa - fb ' 'camera_info_urls: - file:///a.yaml - file:///b.yaml '; do
    echo "$found" | tr '\n' ' ' | grep -q -- "/front/$list" ||
      { echo "not there: $list"; echo "$found"; exit 1; }
  done
done
