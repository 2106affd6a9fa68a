# For find_package(camera_self_calibration), where the library was built without ROS.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
include("${CMAKE_CURRENT_LIST_DIR}/camera_self_calibrationTargets.cmake")
