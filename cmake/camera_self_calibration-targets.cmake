# The target camera_self_calibration::camera_self_calibration of an installed tree, also for those who
# do not use catkin. There is none in a devel space.
if(EXISTS "${CMAKE_CURRENT_LIST_DIR}/camera_self_calibrationTargets.cmake")
  include(CMakeFindDependencyMacro)
  find_dependency(Threads)
  include("${CMAKE_CURRENT_LIST_DIR}/camera_self_calibrationTargets.cmake")
endif()
