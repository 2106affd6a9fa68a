#pragma once

namespace camera_self_calibration {

/// Processor time of this thread [s].
double threadCpuSeconds();

/// Memory in use of the whole process [bytes].
double heapBytes();

}  // namespace camera_self_calibration
