// How true a rig's estimate is, and what it says of itself, over simulated rigs of two to four
// cameras with random lenses, half of them with views that overlap. Each camera starts from
// intrinsics as it finds them alone: 0.3 % and a pixel off. One row a rig and camera, then a
// summary.
//
//   rig_benchmark [RIGS [FIRST SEED]]
#include <Eigen/LU>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "benchmark/random_lens.h"
#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/rig/rig_calibrator.h"
#include "camera_self_calibration/simulation/random.h"
#include "rig/simulated_rig.h"

namespace camera_self_calibration {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kBeyondThreeSigma = 0.0027;

Rigid3 placeOf(bool overlap, Random* random) {
  const Eigen::Vector3d tilt = 3.0 * kDegree * random->normal3();
  if (overlap) {
    return {expSo3(tilt),
            {random->uniform(0.05, 0.25), 0.02 * random->normal(), 0.02 * random->normal()}};
  }
  const Eigen::Vector3d yaw(0.0, random->uniform(90.0, 270.0) * kDegree, 0.0);
  return {expSo3(tilt) * expSo3(yaw), 0.2 * random->normal3()};
}

SimulatedRigOptions randomRig(std::uint64_t seed) {
  Random random(mixSeed(seed, 77));
  SimulatedRigOptions options;
  options.seed = seed;
  const int cameras = random.integer(2, 4);
  const bool overlap = seed % 2 == 0;
  for (int c = 0; c < cameras; ++c) {
    const std::uint64_t lens = mixSeed(seed, 100 + static_cast<std::uint64_t>(c));
    options.rig.cameras.push_back(randomLens(modelOf(lens), 640, 480, lens).camera);
    options.rig.rig_from_camera.push_back(c == 0 ? Rigid3() : placeOf(overlap, &random));
  }
  options.pixel_sigma = random.uniform(0.1, 0.3);
  options.outlier_share = random.uniform(0.0, 0.02);
  options.frames = 50;
  return options;
}

std::vector<Camera> asFoundAlone(const Rig& rig, std::uint64_t seed) {
  Random random(mixSeed(seed, 78));
  std::vector<Camera> cameras = rig.cameras;
  for (Camera& camera : cameras) {
    Intrinsics p = camera.parameters();
    p.head<2>() *= 1.0 + 0.003 * random.normal();
    p.segment<2>(2) += random.normal2();
    camera.setParameters(p);
  }
  return cameras;
}

struct Tally {
  int rigs = 0;
  int told = 0;       // rigs with an estimate
  int rotations = 0;  // cameras
  int rotations_inside = 0;
  int positions = 0;
  int positions_inside = 0;
  int converged = 0;
  int falsely = 0;  // converged beyond the limits they are held to
  std::vector<double> rotation_deg;
  std::vector<double> direction_deg;
};

double rotationProbability(const PlaceInRig& place, const Eigen::Vector3d& error) {
  return chiSquareExceedance(error.dot(place.rotation_covariance.inverse() * error), 3.0);
}

// Of the direction alone: two dimensions.
double directionProbability(const PlaceInRig& place, const Eigen::Vector3d& position,
                            const Eigen::Vector3d& truth) {
  const Eigen::Vector3d n = position.normalized();
  const Matrix32d across = tangentBasis(n);
  const Eigen::Vector2d error = across.transpose() * truth.normalized();
  const Eigen::Matrix2d covariance =
      across.transpose() * place.position_covariance * across / position.squaredNorm();
  return chiSquareExceedance(error.dot(covariance.inverse() * error), 2.0);
}

bool judge(const RigEstimate& estimate, const Rig& truth, int c, Tally* tally) {
  const PlaceInRig& place = estimate.places[c];
  const Rigid3& found = estimate.rig.rig_from_camera[c];
  const Eigen::Vector3d turn =
      logSo3(truth.rig_from_camera[c].rotation * found.rotation.conjugate());
  const double p = rotationProbability(place, turn);
  ++tally->rotations;
  tally->rotations_inside += p > kBeyondThreeSigma;
  tally->rotation_deg.push_back(turn.norm() / kDegree);
  std::printf("  camera %d: rotation %.4f deg (sigma %.4f, p %.4f)", c, turn.norm() / kDegree,
              place.rotationSigma() / kDegree, p);
  bool right = turn.norm() <= 3.0 * rigLimits(truth.cameras[c]).rotation;
  if (place.position_known) {
    const double angle = angleBetween(found.translation, truth.rig_from_camera[c].translation);
    const double q =
        directionProbability(place, found.translation, truth.rig_from_camera[c].translation);
    ++tally->positions;
    tally->positions_inside += q > kBeyondThreeSigma;
    tally->direction_deg.push_back(angle / kDegree);
    right = right && angle <= 3.0 * rigLimits(truth.cameras[c]).direction;
    std::printf(", direction %.3f deg (sigma %.3f, p %.4f)", angle / kDegree,
                place.directionSigma(found.translation) / kDegree, q);
  }
  std::printf(", %d shared\n", place.shared_landmarks);
  return right;
}

void run(std::uint64_t seed, Tally* tally) {
  const SimulatedRigOptions options = randomRig(seed);
  const SimulatedRig rig = simulateRig(options);
  RigCalibrator calibrator({}, asFoundAlone(rig.truth, seed), rig.across);
  for (const RigFrame& frame : rig.frames) calibrator.add(frame);
  const RigEstimate estimate = calibrator.estimate();
  ++tally->rigs;
  std::printf("rig %llu, %d cameras%s: %s\n", static_cast<unsigned long long>(seed),
              rig.truth.size(), seed % 2 == 0 ? ", overlap" : "",
              !estimate.usable     ? estimate.sentence.c_str()
              : estimate.converged ? "CONVERGED"
                                   : "not converged");
  if (!estimate.usable) return;
  ++tally->told;
  tally->converged += estimate.converged;
  bool right = true;
  for (int c = 1; c < rig.truth.size(); ++c) right = judge(estimate, rig.truth, c, tally) && right;
  tally->falsely += estimate.converged && !right;
  std::fflush(stdout);
}

double middle(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  const int rigs = argc > 1 ? std::atoi(argv[1]) : 20;
  const int first = argc > 2 ? std::atoi(argv[2]) : 1;
  Tally tally;
  for (int i = 0; i < rigs; ++i) run(static_cast<std::uint64_t>(first + i), &tally);
  std::printf(
      "%d rigs, %d told, %d CONVERGED (%d of them beyond three times the limits)\n"
      "rotation inside 3 sigma: %d of %d, median error %.4f deg\n"
      "direction inside 3 sigma: %d of %d, median error %.3f deg\n",
      tally.rigs, tally.told, tally.converged, tally.falsely, tally.rotations_inside,
      tally.rotations, middle(tally.rotation_deg), tally.positions_inside, tally.positions,
      middle(tally.direction_deg));
  return 0;
}
