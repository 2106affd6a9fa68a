// What was learnt of a rig, as malice would write it: a sound state that reads back, or a reason.

#include <cmath>

#include "camera_self_calibration/tools/rig_state.h"
#include "fuzz_bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace camera_self_calibration;
  const DecodedRigState decoded =
      decodeRigState(std::string(reinterpret_cast<const char*>(bytes), size));
  require(decoded.state.has_value() == decoded.error.empty(), "a refusal has a reason");
  countInput(decoded.state.has_value());
  if (!decoded.state) return 0;
  const RigEstimate& estimate = decoded.state->estimate;
  require(estimate.rig.size() >= 2 && estimate.usable, "a rig has two cameras");
  for (int c = 0; c < estimate.rig.size(); ++c) {
    require(estimate.rig.cameras[c].valid(), "its cameras are valid");
    require(std::isfinite(estimate.places[c].rotation_covariance.sum()), "and where they sit");
  }
  const std::string again = encode(*decoded.state);
  const DecodedRigState read = decodeRigState(again);
  require(read.state && encode(*read.state) == again, "what is written reads back");
  return 0;
}
