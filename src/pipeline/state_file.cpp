#include "camera_self_calibration/pipeline/state_file.h"

#include "byte_stream.h"
#include "camera_self_calibration/map/segment_edit.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/pipeline/learnt_state.h"
#include "checksum.h"

namespace camera_self_calibration {
namespace {

const std::string kMagic = "camera_self_calibration state\n";
constexpr std::uint64_t kVersion = 3;
// Versions before, still read.
constexpr std::uint64_t kWithoutBags = 2;
constexpr std::uint64_t kWithoutShutter = 1;
constexpr std::size_t kChecksumBytes = 8;
constexpr int kModels = 4;
constexpr int kStates = 5;

void write(const Camera& camera, ByteWriter* out) {
  out->integer(static_cast<std::uint64_t>(camera.model()));
  out->integer(static_cast<std::uint64_t>(camera.width()));
  out->integer(static_cast<std::uint64_t>(camera.height()));
  out->matrix(camera.parameters());
  out->integer(static_cast<std::uint64_t>(camera.estimatedCount()));
}

void write(const Keyframe& keyframe, ByteWriter* out) {
  out->integer(static_cast<std::uint64_t>(keyframe.id));
  out->integer(static_cast<std::uint64_t>(keyframe.stamp_ns));
  for (int i = 0; i < 4; ++i) out->real(keyframe.world_from_camera.rotation.coeffs()(i));
  for (int i = 0; i < 3; ++i) out->real(keyframe.world_from_camera.translation(i));
  for (int i = 0; i < 6; ++i) out->real(keyframe.velocity(i));
  out->real(keyframe.line_delay_s);
  out->integer(keyframe.calibration_generation);
}

void write(const RowShift& shift, ByteWriter* out) {
  for (const Eigen::Vector2d& v : {shift.shift, shift.motion.velocity, shift.motion.acceleration}) {
    for (int i = 0; i < 2; ++i) out->real(v(i));
  }
}

void write(const Landmark& landmark, ByteWriter* out) {
  out->integer(static_cast<std::uint64_t>(landmark.track_id));
  out->integer(static_cast<std::uint64_t>(landmark.reference));
  out->integer(landmark.anchored ? 1 : 0);
  for (int i = 0; i < 2; ++i) out->real(landmark.reference_pixel(i));
  write(landmark.reference_shift, out);
  for (int i = 0; i < 3; ++i) out->real(landmark.bearing(i));
  out->real(landmark.inverse_depth);
}

void write(const Observation& observation, ByteWriter* out) {
  out->integer(static_cast<std::uint64_t>(observation.landmark));
  out->integer(static_cast<std::uint64_t>(observation.keyframe));
  for (int i = 0; i < 2; ++i) out->real(observation.pixel(i));
  out->real(observation.sigma);
  write(observation.shift, out);
}

void write(const Candidate& candidate, ByteWriter* out);
void write(const SegmentMark& mark, ByteWriter* out);
void write(const BagRecord& record, ByteWriter* out);

template <typename Item>
void writeList(const std::vector<Item>& items, ByteWriter* out) {
  out->integer(items.size());
  for (const Item& item : items) write(item, out);
}

void write(const Candidate& candidate, ByteWriter* out) {
  out->integer(static_cast<std::uint64_t>(candidate.segment.sequence));
  writeList(candidate.segment.keyframes, out);
  writeList(candidate.segment.landmarks, out);
  writeList(candidate.segment.observations, out);
  const int earlier = earlierKeyframes(candidate.segment);
  out->integer(static_cast<std::uint64_t>(earlier));
  if (earlier > 0) write(candidate.segment.held_lenses.front(), out);
  write(candidate.camera, out);
  out->matrix(candidate.information);
  for (const double value :
       {candidate.sigma_scale, candidate.cost, candidate.entropy, candidate.uncertainty.rms,
        candidate.uncertainty.max, candidate.residual_scale}) {
    out->real(value);
  }
}

void write(const SegmentMark& mark, ByteWriter* out) {
  out->integer(static_cast<std::uint64_t>(mark.begin_ns));
  out->integer(static_cast<std::uint64_t>(mark.end_ns));
  out->real(mark.entropy);
}

void write(const BagRecord& record, ByteWriter* out) {
  for (const std::string* text :
       {&record.bag, &record.camera, &record.version, &record.state_file}) {
    out->text(*text);
  }
  for (const std::int64_t value : {record.begin_ns, record.end_ns, record.images}) {
    out->integer(static_cast<std::uint64_t>(value));
  }
  out->integer(static_cast<std::uint64_t>(record.state));
  out->integer(record.lens_changes);
  write(record.lens, out);
  out->matrix(record.covariance);
  out->integer(static_cast<std::uint64_t>(record.scatter.freedom));
  for (const double value : {record.scatter.chi_square, record.uncertainty_px, record.misfit_px,
                             record.line_delay_s, record.line_delay_sigma_s}) {
    out->real(value);
  }
  writeList(record.segments, out);
}

struct StateReader : ByteReader {
  using ByteReader::ByteReader;
  std::uint64_t version = kVersion;
};

Camera readCamera(ByteReader* in) {
  const std::uint64_t model = in->integer();
  const auto width = static_cast<int>(in->integer());
  const auto height = static_cast<int>(in->integer());
  const Eigen::MatrixXd parameters = in->matrix(kMaxIntrinsics, 1);
  const std::uint64_t estimated = in->integer();
  if (!in->ok() || model >= kModels) return Camera();
  const auto type = static_cast<CameraModel>(model);
  const int needed = Camera::parameterCount(type);
  const bool with_k3 = type == CameraModel::kRadtan && parameters.size() == needed + 1;
  if (parameters.cols() != 1 || (parameters.size() != needed && !with_k3)) return Camera();
  Camera camera(type, width, height, parameters.col(0));
  if (with_k3 && estimated == static_cast<std::uint64_t>(needed) + 1) camera.setEstimateK3(true);
  return camera;
}

void read(StateReader* in, Keyframe* keyframe) {
  keyframe->id = static_cast<std::int64_t>(in->integer());
  keyframe->stamp_ns = static_cast<std::int64_t>(in->integer());
  for (int i = 0; i < 4; ++i) keyframe->world_from_camera.rotation.coeffs()(i) = in->real();
  for (int i = 0; i < 3; ++i) keyframe->world_from_camera.translation(i) = in->real();
  for (int i = 0; i < 6; ++i) keyframe->velocity(i) = in->real();
  keyframe->line_delay_s = in->real();
  keyframe->calibration_generation = in->integer();
}

void read(StateReader* in, RowShift* shift) {
  if (in->version == kWithoutShutter) return;
  for (Eigen::Vector2d* v : {&shift->shift, &shift->motion.velocity, &shift->motion.acceleration}) {
    for (int i = 0; i < 2; ++i) (*v)(i) = in->real();
  }
}

void read(StateReader* in, Landmark* landmark) {
  landmark->track_id = static_cast<std::int64_t>(in->integer());
  landmark->reference = static_cast<int>(in->integer());
  landmark->anchored = in->integer() != 0;
  for (int i = 0; i < 2; ++i) landmark->reference_pixel(i) = in->real();
  read(in, &landmark->reference_shift);
  for (int i = 0; i < 3; ++i) landmark->bearing(i) = in->real();
  landmark->inverse_depth = in->real();
}

void read(StateReader* in, Observation* observation) {
  observation->landmark = static_cast<int>(in->integer());
  observation->keyframe = static_cast<int>(in->integer());
  for (int i = 0; i < 2; ++i) observation->pixel(i) = in->real();
  observation->sigma = in->real();
  read(in, &observation->shift);
}

void read(StateReader* in, Candidate* candidate);
void read(StateReader* in, SegmentMark* mark);
void read(StateReader* in, BagRecord* record);

// Each item has at least three numbers of eight bytes.
constexpr std::size_t kLeastItemBytes = 24;

template <typename Item>
void readList(StateReader* in, std::vector<Item>* items) {
  items->resize(in->count(kLeastItemBytes));
  for (Item& item : *items) read(in, &item);
}

void read(StateReader* in, Candidate* candidate) {
  candidate->segment.sequence = static_cast<std::int64_t>(in->integer());
  readList(in, &candidate->segment.keyframes);
  readList(in, &candidate->segment.landmarks);
  readList(in, &candidate->segment.observations);
  const auto earlier = static_cast<int>(in->upTo(candidate->segment.keyframes.size()));
  if (earlier > 0) setEarlierLens(readCamera(in), earlier, &candidate->segment);
  candidate->camera = readCamera(in);
  candidate->information = in->matrix(kMaxIntrinsics, kMaxIntrinsics);
  for (double* value :
       {&candidate->sigma_scale, &candidate->cost, &candidate->entropy, &candidate->uncertainty.rms,
        &candidate->uncertainty.max, &candidate->residual_scale}) {
    *value = in->real();
  }
  candidate->well_posed = true;  // as all in the queue
}

void read(StateReader* in, SegmentMark* mark) {
  mark->begin_ns = static_cast<std::int64_t>(in->integer());
  mark->end_ns = static_cast<std::int64_t>(in->integer());
  mark->entropy = in->real();
}

void read(StateReader* in, BagRecord* record) {
  for (std::string* text : {&record->bag, &record->camera, &record->version, &record->state_file}) {
    *text = in->text();
  }
  for (std::int64_t* value : {&record->begin_ns, &record->end_ns, &record->images}) {
    *value = static_cast<std::int64_t>(in->integer());
  }
  record->state = static_cast<CalibrationState>(in->integer() % kStates);
  record->lens_changes = in->integer();
  record->lens = readCamera(in);
  record->covariance = in->matrix(kMaxIntrinsics, kMaxIntrinsics);
  record->scatter.freedom = static_cast<int>(in->integer());
  for (double* value : {&record->scatter.chi_square, &record->uncertainty_px, &record->misfit_px,
                        &record->line_delay_s, &record->line_delay_sigma_s}) {
    *value = in->real();
  }
  readList(in, &record->segments);
}

}  // namespace

std::string encode(const LearntState& state) {
  ByteWriter out;
  out.integer(kVersion);
  write(state.camera, &out);
  out.integer(static_cast<std::uint64_t>(state.state));
  out.integer(static_cast<std::uint64_t>(state.stamp_ns));
  out.integer(static_cast<std::uint64_t>(state.keyframes));
  out.integer(state.revision);
  out.integer(state.epoch);
  out.real(state.line_delay_s);
  out.real(state.line_delay_sigma_s);
  writeList(state.segments, &out);
  writeList(state.bags, &out);
  const std::string text = kMagic + out.bytes();
  ByteWriter sum;
  sum.integer(checksum(text.data(), text.size()));
  return text + sum.bytes();
}

bool beginsAsState(const std::string& bytes) {
  return bytes.compare(0, kMagic.size(), kMagic) == 0;
}

DecodedState decodeState(const std::string& bytes) {
  if (!beginsAsState(bytes)) {
    return {nullptr, "it is not a state file of this program"};
  }
  if (bytes.size() < kMagic.size() + kChecksumBytes + 8) return {nullptr, "it is cut off"};
  const std::size_t body = bytes.size() - kChecksumBytes;
  StateReader in(bytes.data() + kMagic.size(), body - kMagic.size());
  in.version = in.integer();
  if (in.version < kWithoutShutter || in.version > kVersion) {
    return {nullptr, "it has the format " + std::to_string(in.version) + ", this program reads " +
                         std::to_string(kVersion)};
  }
  ByteReader sum(bytes.data() + body, kChecksumBytes);
  if (sum.integer() != checksum(bytes.data(), body)) {
    return {nullptr, "it is damaged or cut off (wrong checksum)"};
  }
  auto state = std::make_shared<LearntState>();
  state->camera = readCamera(&in);
  const std::uint64_t calibration_state = in.integer();
  state->stamp_ns = static_cast<std::int64_t>(in.integer());
  state->keyframes = static_cast<std::int64_t>(in.integer());
  state->revision = in.integer();
  state->epoch = in.integer();
  if (in.version > kWithoutShutter) {
    state->line_delay_s = in.real();
    state->line_delay_sigma_s = in.real();
  }
  readList(&in, &state->segments);
  if (in.version > kWithoutBags) readList(&in, &state->bags);
  if (!in.atEnd() || calibration_state >= kStates) return {nullptr, "its contents do not add up"};
  state->state = static_cast<CalibrationState>(calibration_state);
  const std::vector<std::string> problems = state->problems();
  if (!problems.empty()) return {nullptr, problems.front()};
  return {state, ""};
}

DecodedState readStateFile(const std::string& path) {
  const FileContents contents = readFile(path);
  if (!contents.exists) return {nullptr, "there is no such file"};
  if (!contents.error.empty()) return {nullptr, contents.error};
  return decodeState(contents.bytes);
}

}  // namespace camera_self_calibration
