#include "benchmark/random_sequence.h"

#include <algorithm>
#include <array>

#include "benchmark/random_lens.h"
#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/room.h"
#include "camera_self_calibration/simulation/tum_file.h"

namespace camera_self_calibration {
namespace {

constexpr std::uint64_t kStream = 77;

struct Recording {
  const char* name;
  bool euroc;  // which rig, see below
};
constexpr std::array<Recording, 3> kRecordings = {
    {{"euroc_V1_01", true}, {"tumvi_room4", false}, {"euroc_MH_01", true}}};

// From the calibration files of the two data sets: how the first camera sits in the body.
Eigen::Quaterniond bodyFromCamera(bool euroc) {
  Eigen::Matrix3d rotation;
  if (euroc) {
    rotation << 0.01487, -0.99988, 0.00414, 0.99956, 0.01497, 0.02571, -0.02577, 0.00376, 0.99966;
  } else {
    rotation << -0.99953, 0.00750, -0.02989, 0.02962, -0.03440, -0.99897, -0.00852, -0.99938,
        0.03416;
  }
  return Eigen::Quaterniond(rotation).normalized();
}

Trajectory recordedMotion(const Recording& recording, const std::string& folder, double duration_s,
                          const Eigen::AlignedBox3d& box, Random* random) {
  const std::vector<StampedPose> poses = readTum(folder + "/" + recording.name + ".tum");
  const double length = poses.back().time_s - poses.front().time_s;
  RealMotionOptions options;
  options.body_from_camera = bodyFromCamera(recording.euroc);
  const double last_start = length - duration_s - 1.0;
  options.start_s = random->uniform(0.05 * length, std::max(0.06 * length, last_start));
  options.duration_s = duration_s + 0.5;
  options.fit_into = box;
  return realMotion(poses, options);
}

}  // namespace

RandomSequence randomSequence(CameraModel model, double duration_s, std::uint64_t seed,
                              const std::string& trajectories) {
  Random random(mixSeed(kStream, seed));
  RandomSequence result;
  SequenceOptions& options = result.options;
  options.room.seed = seed + 1;
  options.room.size = {random.uniform(5.0, 8.0), random.uniform(5.0, 8.0),
                       random.uniform(2.8, 3.5)};
  options.lens = Lens{randomLens(model, 640, 480, seed + 1).camera, std::nullopt, 1.0};
  options.renderer.sensor.noise_sigma = random.uniform(1.0, 3.0);
  options.noise_seed = seed;
  options.duration_s = duration_s;
  options.motion.seed = seed + 7;
  options.motion.speed = random.uniform(0.4, 1.0);
  result.motion = "hand-held x" + std::to_string(options.motion.speed).substr(0, 4);
  if (!trajectories.empty() && seed % 3 == 2) {
    const Recording& recording = kRecordings[seed / 3 % kRecordings.size()];
    const Eigen::AlignedBox3d box = makeRoom(options.room).free_space;
    options.trajectory = recordedMotion(recording, trajectories, duration_s, box, &random);
    result.motion = recording.name;
  }
  return result;
}

}  // namespace camera_self_calibration
