#!/bin/sh
# links_no_ros.sh LIBRARY: fails unless the library needs nothing but OpenCV and the system's own
# libraries (and those of the sanitizers).
set -eu
needed=$(readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')
[ -n "$needed" ] || { echo "$1 lists no libraries"; exit 1; }
foreign=$(echo "$needed" | grep -Ev \
  '^(libopencv_(core|imgproc|video|features2d|calib3d|flann|dnn)|libstdc\+\+|libm|libgcc_s|libc|libpthread|ld-linux.*|libasan|libubsan|libtsan)\.so' \
  || true)
echo "$1 needs:" $needed
[ -z "$foreign" ] || { echo "not allowed:" $foreign; exit 1; }
