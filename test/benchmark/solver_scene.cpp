#include "solver_scene.h"

namespace camera_self_calibration {
namespace {

constexpr int kWindow = 10;  // Keyframes of a segment, active keyframes, conditioning keyframes.

SegmentOptions segmentOptions(int keyframes) {
  SegmentOptions options;
  Intrinsics parameters(5);
  parameters << 311.0, 310.0, 322.0, 238.0, 0.93;
  options.camera = Camera(CameraModel::kFov, 640, 480, parameters);
  options.origin = LandmarkOrigin::kMixed;
  options.keyframes = keyframes;
  options.tracks.max_features = 128;
  options.tracks.pixel_sigma = 0.1;
  return options;
}

// As the map does by default: the pixel of detection becomes a measurement like the others, and the
// landmark has three parameters.
void freeReferences(const Camera& camera, Segment* segment) {
  std::vector<Observation> grouped;
  std::size_t next = 0;
  for (int l = 0; l < static_cast<int>(segment->landmarks.size()); ++l) {
    Landmark& landmark = segment->landmarks[l];
    if (landmark.anchored) {
      landmark.anchored = false;
      landmark.bearing = *camera.unproject(landmark.reference_pixel);
      grouped.push_back({l, landmark.reference, landmark.reference_pixel, 0.1});
    }
    for (; next < segment->observations.size() && segment->observations[next].landmark == l;
         ++next) {
      grouped.push_back(segment->observations[next]);
    }
  }
  segment->observations = grouped;
}

}  // namespace

SolverScene::SolverScene(Kind kind, int keyframes) : kind_(kind) {
  const int length = kind == Kind::kBatch           ? keyframes
                     : kind == Kind::kSlidingWindow ? 2 * kWindow
                                                    : kWindow;
  const int segments = kind == Kind::kQueue ? 10 : 1;
  const SegmentOptions options = segmentOptions(length);
  Intrinsics start = options.camera.parameters();
  start.head<2>() *= 1.002;
  start_camera_ = options.camera;
  start_camera_.setParameters(start);
  if (!estimatesIntrinsics()) start_camera_ = options.camera;
  for (int s = 0; s < segments; ++s) {
    SimulatedSegment made = makeSegment(options, 40 + s);
    freeReferences(options.camera, &made.segment);
    Segment moved = perturbed(made.segment, {0.005, 0.002, 0.02, 0.001}, s);
    // The conditioning keyframes are known.
    for (int k = 0; !estimatesIntrinsics() && k < kWindow; ++k) {
      moved.keyframes[k] = made.segment.keyframes[k];
    }
    start_segments_.push_back(moved);
    fixed_landmarks_.push_back(
        estimatesIntrinsics() ? freeBlock(&moved, start_camera_).fixed_landmark : -1);
  }
  restart();
}

void SolverScene::restart() {
  camera_ = start_camera_;
  segments_ = start_segments_;
}

Problem SolverScene::problem() {
  Problem problem;
  problem.camera = &camera_;
  problem.estimate_intrinsics = estimatesIntrinsics();
  for (const BatchSegment& segment : batch()) {
    problem.blocks.push_back(
        {segment.segment, segment.fixed_keyframes, segment.fixed_landmark, 1.0});
  }
  return problem;
}

std::vector<BatchSegment> SolverScene::batch() {
  std::vector<BatchSegment> batch;
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    batch.push_back({&segments_[s], estimatesIntrinsics() ? 1 : kWindow, fixed_landmarks_[s], 1.0});
  }
  return batch;
}

int SolverScene::observations() const {
  std::size_t count = 0;
  for (const Segment& segment : segments_) count += segment.observations.size();
  return static_cast<int>(count);
}

}  // namespace camera_self_calibration
