// State files behind their checksum, as malice would write them: a sound state that reads back, or
// a reason.

#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/state_file.h"
#include "fuzz_bytes.h"
#include "pipeline/byte_stream.h"
#include "pipeline/checksum.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace camera_self_calibration;
  const std::string body(reinterpret_cast<const char*>(bytes), size);
  decodeState(body);
  ByteWriter sum;
  sum.integer(checksum(body.data(), body.size()));
  const DecodedState decoded = decodeState(body + sum.bytes());
  require((decoded.state != nullptr) == decoded.error.empty(), "a refusal has a reason");
  countInput(decoded.state != nullptr);
  if (!decoded.state) return 0;
  require(decoded.state->problems().empty(), "what is read is sound");
  const std::string again = encode(*decoded.state);
  const DecodedState read = decodeState(again);
  require(read.state && encode(*read.state) == again, "what is written reads back");
  return 0;
}
