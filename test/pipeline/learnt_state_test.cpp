#include "camera_self_calibration/pipeline/learnt_state.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "camera_self_calibration/map/segment_edit.h"
#include "camera_self_calibration/pipeline/state_file.h"
#include "estimation/sample_segments.h"
#include "pipeline/checksum.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {
namespace {

std::shared_ptr<const LearntState> learntState() {
  static const std::shared_ptr<const LearntState> state = [] {
    const Camera truth = ordinaryCameras()[1];
    TrackRun run(truth, optionsFor(truth.model()), TrackRunOptions());
    EXPECT_TRUE(run.runUntilConverged(600));
    return run.calibrator().state();
  }();
  return state;
}

void expectSame(const Segment& a, const Segment& b) {
  EXPECT_EQ(a.sequence, b.sequence);
  ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
  ASSERT_EQ(a.landmarks.size(), b.landmarks.size());
  ASSERT_EQ(a.observations.size(), b.observations.size());
  for (std::size_t i = 0; i < a.keyframes.size(); ++i) {
    EXPECT_EQ(a.keyframes[i].id, b.keyframes[i].id);
    EXPECT_EQ(a.keyframes[i].stamp_ns, b.keyframes[i].stamp_ns);
    EXPECT_EQ(a.keyframes[i].world_from_camera.rotation.coeffs(),
              b.keyframes[i].world_from_camera.rotation.coeffs());
    EXPECT_EQ(a.keyframes[i].world_from_camera.translation,
              b.keyframes[i].world_from_camera.translation);
    EXPECT_EQ(a.keyframes[i].velocity, b.keyframes[i].velocity);
    EXPECT_EQ(a.keyframes[i].calibration_generation, b.keyframes[i].calibration_generation);
  }
  for (std::size_t i = 0; i < a.landmarks.size(); ++i) {
    EXPECT_EQ(a.landmarks[i].track_id, b.landmarks[i].track_id);
    EXPECT_EQ(a.landmarks[i].reference, b.landmarks[i].reference);
    EXPECT_EQ(a.landmarks[i].anchored, b.landmarks[i].anchored);
    EXPECT_EQ(a.landmarks[i].reference_pixel, b.landmarks[i].reference_pixel);
    EXPECT_EQ(a.landmarks[i].bearing, b.landmarks[i].bearing);
    EXPECT_EQ(a.landmarks[i].inverse_depth, b.landmarks[i].inverse_depth);
  }
  for (std::size_t i = 0; i < a.observations.size(); ++i) {
    EXPECT_EQ(a.observations[i].landmark, b.observations[i].landmark);
    EXPECT_EQ(a.observations[i].keyframe, b.observations[i].keyframe);
    EXPECT_EQ(a.observations[i].pixel, b.observations[i].pixel);
    EXPECT_EQ(a.observations[i].sigma, b.observations[i].sigma);
  }
}

TEST(LearntState, ReadsBackToTheLastBit) {
  ASSERT_TRUE(learntState());
  const LearntState& state = *learntState();
  ASSERT_GE(state.segments.size(), 2u);
  const std::string bytes = encode(state);
  std::cout << state.segments.size() << " segments take " << bytes.size() / 1024 << " KiB\n";
  const DecodedState decoded = decodeState(bytes);
  ASSERT_TRUE(decoded.state) << decoded.error;
  EXPECT_EQ(decoded.state->camera.parameters(), state.camera.parameters());
  EXPECT_EQ(decoded.state->camera.model(), state.camera.model());
  EXPECT_EQ(decoded.state->state, CalibrationState::kConverged);
  EXPECT_EQ(decoded.state->stamp_ns, state.stamp_ns);
  EXPECT_EQ(decoded.state->keyframes, state.keyframes);
  EXPECT_EQ(decoded.state->revision, state.revision);
  ASSERT_EQ(decoded.state->segments.size(), state.segments.size());
  for (std::size_t i = 0; i < state.segments.size(); ++i) {
    const Candidate& a = state.segments[i];
    const Candidate& b = decoded.state->segments[i];
    expectSame(a.segment, b.segment);
    EXPECT_EQ(a.camera.parameters(), b.camera.parameters());
    EXPECT_EQ(a.information, b.information);
    EXPECT_EQ(a.cost, b.cost);
    EXPECT_EQ(a.entropy, b.entropy);
    EXPECT_EQ(a.sigma_scale, b.sigma_scale);
  }
  EXPECT_EQ(encode(*decoded.state), bytes);
}

TEST(LearntState, KeepsThatK3IsEstimatedAndAnEarlierLens) {
  LearntState state = *learntState();
  Camera camera(CameraModel::kRadtan, 640, 480,
                (Intrinsics(9) << 400, 400, 320, 240, -0.3, 0.1, 0, 0, 0.01).finished());
  camera.setEstimateK3(true);
  state.camera = camera;
  for (Candidate& segment : state.segments) {
    setEarlierLens(ordinaryCameras()[1], 2, &segment.segment);
    segment.camera = camera;
    segment.information = IntrinsicsMatrix::Identity(9, 9);
  }
  const DecodedState decoded = decodeState(encode(state));
  ASSERT_TRUE(decoded.state) << decoded.error;
  EXPECT_EQ(decoded.state->camera.estimatedCount(), 9);
  const Segment& first = decoded.state->segments[0].segment;
  EXPECT_EQ(earlierKeyframes(first), 2);
  ASSERT_TRUE(first.isLensHeld(0));
  EXPECT_EQ(first.cameraOf(0, camera).parameters(), ordinaryCameras()[1].parameters());
}

TEST(LearntState, EveryDamageIsNoticed) {
  const std::string bytes = encode(*learntState());
  for (std::size_t i = 0; i < bytes.size(); i += 997) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    const DecodedState decoded = decodeState(damaged);
    EXPECT_FALSE(decoded.state) << "byte " << i;
    EXPECT_FALSE(decoded.error.empty());
  }
  for (std::size_t size = 0; size < bytes.size(); size += size < 100 ? 1 : 1009) {
    EXPECT_FALSE(decodeState(bytes.substr(0, size)).state) << size << " bytes";
  }
  EXPECT_FALSE(decodeState(bytes + "x").state);
}

TEST(LearntState, ForeignFilesAndOtherVersionsAreNamed) {
  EXPECT_NE(decodeState("image_width: 640\n").error.find("not a state file"), std::string::npos);
  EXPECT_NE(decodeState("").error.find("not a state file"), std::string::npos);
  std::string newer = encode(*learntState());
  const std::size_t version = newer.find('\n') + 1;
  newer[version] = 9;
  EXPECT_NE(decodeState(newer).error.find("format 9"), std::string::npos);
}

// A file as the second version of the format was written. The lens changed within its second
// segment.
TEST(LearntState, FilesOfFormatTwoAreRead) {
  std::ifstream file(SELFCAL_STATE_OF_FORMAT_TWO, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const DecodedState decoded = decodeState(bytes);
  ASSERT_TRUE(decoded.state) << decoded.error;
  const LearntState& state = *decoded.state;
  EXPECT_EQ(state.camera.model(), CameraModel::kFov);
  EXPECT_NEAR(state.camera.parameters()(0), 299.967, 5e-4);
  EXPECT_EQ(state.stamp_ns, 5733333333);
  EXPECT_EQ(state.keyframes, 20);
  ASSERT_EQ(state.segments.size(), 2u);
  const Segment& first = state.segments[0].segment;
  const Segment& second = state.segments[1].segment;
  EXPECT_EQ(first.keyframes.size(), 10u);
  EXPECT_EQ(first.observations.size(), 15u);
  EXPECT_EQ(earlierKeyframes(first), 0);
  EXPECT_EQ(earlierKeyframes(second), 3);
  EXPECT_EQ(second.cameraOf(2, state.camera).parameters(), ordinaryCameras()[1].parameters());
  EXPECT_EQ(&second.cameraOf(3, state.camera), &state.camera);
  EXPECT_EQ(second.observations[0].pixel, Eigen::Vector2d(353.547312331142, 431.96051699384765));
}

// A file as the first version of the format was written, in words of eight bytes: a camera, and a
// segment with one keyframe, one landmark and one observation, none of which knows of a shutter.
const std::uint64_t kFormatOne[] = {1,
                                    0,
                                    0x280,
                                    0x1e0,
                                    4,
                                    1,
                                    0x4079080000000000,
                                    0x4079140000000000,
                                    0x4074000000000000,
                                    0x406e000000000000,
                                    4,
                                    3,
                                    0x2cb417800,
                                    0x2a,
                                    7,
                                    3,
                                    1,
                                    0x29,
                                    1,
                                    0x29,
                                    0x2ad741300,
                                    0,
                                    0,
                                    0,
                                    0x3ff0000000000000,
                                    0x3ff0000000000000,
                                    0x4000000000000000,
                                    0x4008000000000000,
                                    0,
                                    0,
                                    0,
                                    0,
                                    0,
                                    0,
                                    0,
                                    6,
                                    1,
                                    0x63,
                                    0,
                                    1,
                                    0x4059200000000000,
                                    0x4069080000000000,
                                    0,
                                    0x3fe3333333333333,
                                    0x3fe999999999999a,
                                    0x3fe8000000000000,
                                    1,
                                    0,
                                    0,
                                    0x4059600000000000,
                                    0x4069280000000000,
                                    0x3fc0000000000000,
                                    0,
                                    0,
                                    0x280,
                                    0x1e0,
                                    4,
                                    1,
                                    0x4079080000000000,
                                    0x4079140000000000,
                                    0x4074000000000000,
                                    0x406e000000000000,
                                    4,
                                    4,
                                    4,
                                    0x4030000000000000,
                                    0,
                                    0,
                                    0,
                                    0,
                                    0x4030000000000000,
                                    0,
                                    0,
                                    0,
                                    0,
                                    0x4030000000000000,
                                    0,
                                    0,
                                    0,
                                    0,
                                    0x4030000000000000,
                                    0x3ff8000000000000,
                                    0x4024800000000000,
                                    0xc00c000000000000,
                                    0x3fd0000000000000,
                                    0x3fe0000000000000,
                                    0x3ff4000000000000,
                                    0x698262e68d2c8dd8};

TEST(LearntState, TheFormatBeforeTheShutterIsStillRead) {
  std::string bytes = "camera_self_calibration state\n";
  for (const std::uint64_t word : kFormatOne) {
    for (int shift = 0; shift < 64; shift += 8) bytes += static_cast<char>((word >> shift) & 0xff);
  }
  const DecodedState decoded = decodeState(bytes);
  ASSERT_TRUE(decoded.state) << decoded.error;
  const LearntState& state = *decoded.state;
  EXPECT_EQ(state.camera.model(), CameraModel::kPinhole);
  EXPECT_EQ(state.camera.parameters(), (Intrinsics(4) << 400.5, 401.25, 320, 240).finished());
  EXPECT_EQ(state.state, CalibrationState::kConverged);
  EXPECT_EQ(state.stamp_ns, 12000000000);
  EXPECT_EQ(state.keyframes, 42);
  EXPECT_EQ(state.revision, 7u);
  EXPECT_EQ(state.epoch, 3u);
  EXPECT_EQ(state.line_delay_s, 0.0);
  EXPECT_EQ(state.line_delay_sigma_s, 0.0) << "no estimate";
  ASSERT_EQ(state.segments.size(), 1u);
  const Candidate& candidate = state.segments[0];
  EXPECT_EQ(candidate.segment.sequence, 41);
  EXPECT_EQ(candidate.segment.keyframes.at(0).world_from_camera.translation.z(), 3.0);
  EXPECT_EQ(candidate.segment.landmarks.at(0).bearing.y(), 0.6);
  EXPECT_EQ(candidate.segment.landmarks.at(0).inverse_depth, 0.75);
  EXPECT_EQ(candidate.segment.observations.at(0).pixel, Eigen::Vector2d(101.5, 201.25));
  EXPECT_EQ(candidate.segment.observations.at(0).sigma, 0.125);
  EXPECT_TRUE(candidate.segment.observations.at(0).shift.shift.isZero());
  EXPECT_EQ(candidate.information, 16.0 * IntrinsicsMatrix::Identity(4, 4));
  EXPECT_EQ(candidate.residual_scale, 1.25);
  // Written again, it has the present format.
  EXPECT_TRUE(decodeState(encode(state)).state);
}

// Without the list of bags at the end, a count of none, that the format had before.
TEST(LearntState, TheFormatBeforeTheBagsIsStillRead) {
  std::string bytes = encode(*learntState());
  bytes.resize(bytes.size() - 16);
  bytes[bytes.find('\n') + 1] = 2;
  std::uint64_t sum = 14695981039346656037ULL;
  for (const char c : bytes) sum = (sum ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  for (int shift = 0; shift < 64; shift += 8) bytes += static_cast<char>((sum >> shift) & 0xff);
  const DecodedState decoded = decodeState(bytes);
  ASSERT_TRUE(decoded.state) << decoded.error;
  EXPECT_TRUE(decoded.state->bags.empty());
  EXPECT_EQ(encode(*decoded.state), encode(*learntState()));
}

BagRecord recordWith(const Camera& lens) {
  BagRecord record;
  record.bag = "day one.bag";
  record.camera = "robot7/front";
  record.version = "0.1.0";
  record.state_file = "/states/1.state";
  record.begin_ns = -5;
  record.end_ns = 1700000000000000001;
  record.images = 300;
  record.state = CalibrationState::kConverging;
  record.lens_changes = 2;
  record.lens = lens;
  record.covariance =
      0.25 * IntrinsicsMatrix::Identity(lens.estimatedCount(), lens.estimatedCount());
  record.uncertainty_px = 0.5;
  record.misfit_px = 0.125;
  record.scatter = {12.5, 8};
  record.line_delay_s = 1e-5;
  record.line_delay_sigma_s = 1e-6;
  record.segments = {{1, 2, -3.5}, {4, 5, -2.5}};
  return record;
}

TEST(LearntState, KeepsTheRecordsOfItsBags) {
  LearntState state = *learntState();
  const BagRecord record = recordWith(state.camera);
  state.bags = {record, record};
  const DecodedState decoded = decodeState(encode(state));
  ASSERT_TRUE(decoded.state) << decoded.error;
  ASSERT_EQ(decoded.state->bags.size(), 2u);
  const BagRecord& read = decoded.state->bags[1];
  EXPECT_EQ(read.bag, record.bag);
  EXPECT_EQ(read.camera, record.camera);
  EXPECT_EQ(read.version, record.version);
  EXPECT_EQ(read.state_file, record.state_file);
  EXPECT_EQ(read.begin_ns, -5);
  EXPECT_EQ(read.end_ns, record.end_ns);
  EXPECT_EQ(read.images, 300);
  EXPECT_EQ(read.state, CalibrationState::kConverging);
  EXPECT_EQ(read.lens_changes, 2u);
  EXPECT_EQ(read.lens.parameters(), record.lens.parameters());
  EXPECT_EQ(read.covariance, record.covariance);
  EXPECT_EQ(read.uncertainty_px, 0.5);
  EXPECT_EQ(read.misfit_px, 0.125);
  EXPECT_EQ(read.scatter.chi_square, 12.5);
  EXPECT_EQ(read.scatter.freedom, 8);
  EXPECT_EQ(read.line_delay_s, 1e-5);
  EXPECT_EQ(read.line_delay_sigma_s, 1e-6);
  ASSERT_EQ(read.segments.size(), 2u);
  EXPECT_EQ(read.segments[0].begin_ns, 1);
  EXPECT_EQ(read.segments[1].entropy, -2.5);
}

TEST(LearntState, UnsoundRecordsOfBagsAreRefused) {
  const auto refused = [](const std::function<void(BagRecord*)>& spoil) {
    LearntState state = *learntState();
    state.bags = {recordWith(state.camera)};
    spoil(&state.bags[0]);
    return !decodeState(encode(state)).state;
  };
  EXPECT_FALSE(refused([](BagRecord*) {}));
  EXPECT_TRUE(refused([](BagRecord* r) { r->covariance.setZero(); })) << "without any error";
  EXPECT_TRUE(refused([](BagRecord* r) { r->misfit_px = INFINITY; }));
  EXPECT_TRUE(refused([](BagRecord* r) { r->segments[1].entropy = NAN; }));
  EXPECT_TRUE(refused(
      [](BagRecord* r) { r->lens = Camera(r->lens.model(), 1 << 30, 480, r->lens.parameters()); }));
}

// Even where the checksum is right, contents that make no sense are not taken.
TEST(LearntState, UnsoundContentsAreRefused) {
  const auto refused = [](const std::function<void(LearntState*)>& spoil) {
    LearntState state = *learntState();
    spoil(&state);
    return !decodeState(encode(state)).state;
  };
  EXPECT_FALSE(refused([](LearntState*) {}));
  EXPECT_TRUE(refused([](LearntState* s) { s->segments.clear(); }));
  EXPECT_TRUE(refused([](LearntState* s) { s->camera = Camera(); }));
  EXPECT_TRUE(refused([](LearntState* s) { s->segments[0].segment.observations[3].sigma = 0.0; }));
  EXPECT_TRUE(refused([](LearntState* s) { s->segments[0].segment.landmarks[2].reference = 99; }));
  EXPECT_TRUE(refused([](LearntState* s) {
    s->segments[0].segment.keyframes[1].world_from_camera.translation(0) = NAN;
  }));
  EXPECT_TRUE(refused([](LearntState* s) { s->segments[0].information.resize(2, 2); }));
  EXPECT_TRUE(
      refused([](LearntState* s) { setEarlierLens(Camera(), 2, &s->segments[0].segment); }));
}

TEST(LearntState, MoreKeyframesOfAnEarlierLensThanThereAreAreRefused) {
  LearntState state = *learntState();
  Segment& segment = state.segments[0].segment;
  const auto encodedWith = [&](int earlier) {
    setEarlierLens(ordinaryCameras()[1], earlier, &segment);
    const std::string bytes = encode(state);
    return bytes.substr(0, bytes.size() - 8);  // without the checksum
  };
  std::string body = encodedWith(1);
  const std::string other = encodedWith(2);
  const auto count = std::mismatch(body.begin(), body.end(), other.begin()).first;
  const auto decoded = [&](std::size_t earlier) {
    *count = static_cast<char>(earlier);
    const std::uint64_t sum = checksum(body.data(), body.size());
    std::string bytes = body;
    for (int shift = 0; shift < 64; shift += 8) bytes += static_cast<char>((sum >> shift) & 0xff);
    return decodeState(bytes);
  };
  const std::size_t keyframes = segment.keyframes.size();
  const DecodedState all = decoded(keyframes);
  ASSERT_TRUE(all.state) << all.error;
  EXPECT_EQ(earlierKeyframes(all.state->segments[0].segment), static_cast<int>(keyframes));
  EXPECT_FALSE(decoded(keyframes + 1).state);
}

}  // namespace
}  // namespace camera_self_calibration
