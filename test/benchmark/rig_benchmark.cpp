// How true a rig's estimate is, and what it says of itself, over simulated rigs of two to four
// cameras with random lenses, half of them with views that overlap. Each camera starts from
// intrinsics as it finds them alone: 0.3 % and a pixel off. One row a rig and camera, then a
// summary, with what an audit says of the true rig, and of one whose camera is turned by 0.5
// degrees.
//
//   rig_benchmark [--rigs 20] [--first-seed 1]
//
// With --change what a session makes of a camera that is turned by 0.5 degrees (bump), of one that
// zooms by 1 % without saying so (zoom) or of neither (none), about half way through a hundred
// keyframes: one row a rig, then a table of what was found.
//
//   rig_benchmark --change bump|zoom|none [--degrees 0.5] [--rigs 20] [--first-seed 1]
#include <Eigen/LU>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "benchmark/program_arguments.h"
#include "benchmark/random_lens.h"
#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/rig/rig_audit.h"
#include "camera_self_calibration/rig/rig_calibrator.h"
#include "camera_self_calibration/simulation/random.h"
#include "rig/played_rig.h"

namespace camera_self_calibration {
namespace {

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
  int rotations = 0;  // cameras
  int rotations_inside = 0;
  int positions = 0;
  int positions_inside = 0;
  int converged = 0;
  int falsely = 0;       // converged beyond the limits they are held to
  int turns_inside = 0;  // of rotations once lenses and poses are taken together
  std::map<AuditVerdict, int> true_ones;
  std::map<AuditVerdict, int> turned_ones;
  std::vector<double> rotation_deg;
  std::vector<double> turn_deg;
  std::vector<double> direction_deg;
};

constexpr double kTurned = 0.5 * kDegree;

// What an audit says of where a camera sits.
void judgeAudits(const RigEstimate& estimate, const Rig& truth, int c, Tally* tally) {
  const PlaceVector difference =
      placeDifference(estimate.rig, truth, c, estimate.evidence->features);
  const Eigen::Vector3d turn = difference.head<3>();
  const Eigen::Matrix3d covariance = estimate.places[c].difference_covariance.topLeftCorner<3, 3>();
  const double p = chiSquareExceedance(turn.dot(covariance.inverse() * turn), 3.0);
  tally->turns_inside += p > kBeyondThreeSigma;
  tally->turn_deg.push_back(turn.norm() / kDegree);
  Rig turned = truth;
  Random random(mixSeed(static_cast<std::uint64_t>(estimate.observations), 80));
  Eigen::Quaterniond& rotation = turned.rig_from_camera[c].rotation;
  rotation = expSo3(kTurned * random.normal3().normalized()) * rotation;
  const PlaceAudit right = auditPlace(estimate, truth, c, {});
  const PlaceAudit wrong = auditPlace(estimate, turned, c, {});
  ++tally->true_ones[right.verdict];
  ++tally->turned_ones[wrong.verdict];
  std::printf("    with the lens: %.4f deg (p %.4f); audit of the true one %s, turned %s\n",
              turn.norm() / kDegree, p, toString(right.verdict).c_str(),
              toString(wrong.verdict).c_str());
}

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
  judgeAudits(estimate, truth, c, tally);
  return right;
}

void run(std::uint64_t seed, Tally* tally) {
  const SimulatedRigOptions options = randomRig(seed);
  const SimulatedRig rig = simulateRig(options);
  RigCalibrator calibrator({}, rig.truth.size(), rig.across);
  for (const RigFrame& frame : rig.frames) calibrator.add(frame);
  const RigEstimate estimate = calibrator.estimate(asFoundAlone(rig.truth, seed));
  ++tally->rigs;
  std::printf("rig %llu, %d cameras%s: %s\n", static_cast<unsigned long long>(seed),
              rig.truth.size(), seed % 2 == 0 ? ", overlap" : "",
              !estimate.usable     ? estimate.sentence.c_str()
              : estimate.converged ? "CONVERGED"
                                   : "not converged");
  if (!estimate.usable) return;
  tally->converged += estimate.converged;
  bool right = true;
  for (int c = 1; c < rig.truth.size(); ++c) right = judge(estimate, rig.truth, c, tally) && right;
  tally->falsely += estimate.converged && !right;
  std::fflush(stdout);
}

constexpr double kZoom = 1.01;
constexpr double kOnsetTolerance = 3.0;  // [s] what a segment of keyframes takes, and a half

struct MountTally {
  int rigs = 0;
  int known = 0;    // CONVERGED before the change
  int found = 0;    // the right camera, near the right time
  int amount = 0;   // of these, turned as it was within 3 sigma
  int others = 0;   // changes found that did not happen so
  int again = 0;    // CONVERGED in the end on what is true then
  int falsely = 0;  // CONVERGED at any time beyond three times the limits from what is true
  std::vector<double> error_deg;
  std::vector<double> late_s;   // from the change to the alarm
  std::vector<double> dated_s;  // of the onset
};

SimulatedRigOptions rigThatChanges(const std::string& kind, double degrees, std::uint64_t seed) {
  SimulatedRigOptions options = randomRig(seed);
  Random random(mixSeed(seed, 79));
  options.frames = 100;
  options.change_at_s = random.uniform(9.0, 11.0);
  options.changed = random.integer(0, options.rig.size() - 1);
  if (kind == "bump") {
    options.bump.rotation = expSo3(degrees * kDegree * random.normal3().normalized());
  }
  if (kind == "zoom") options.zoom = kZoom;
  return options;
}

bool near(const RigEstimate& estimate, const Rig& truth) {
  for (int c = 1; c < truth.size(); ++c) {
    const RigLimits limits = rigLimits(truth.cameras[c]);
    const Rigid3& found = estimate.rig.rig_from_camera[c];
    const Rigid3& pose = truth.rig_from_camera[c];
    if (angleBetween(pose.rotation, found.rotation) > 3.0 * limits.rotation ||
        angleBetween(pose.translation, found.translation) > 3.0 * limits.direction) {
      return false;
    }
  }
  return true;
}

// A rotation of one camera in its own frame, as the session says it: in the rig's frame, and of two
// cameras always of the second.
Eigen::Vector3d trueTurn(const SimulatedRigOptions& options) {
  const Rigid3 turned(options.bump.rotation, Eigen::Vector3d::Zero());
  const Eigen::Quaterniond& rig = options.rig.rig_from_camera[options.changed].rotation;
  const Eigen::Vector3d turn = rig * logSo3(turned.rotation);
  return options.rig.size() == 2 && options.changed == 0 ? Eigen::Vector3d(-turn) : turn;
}

bool judgeChange(const MountChange& change, const SimulatedRigOptions& options, MountTally* tally) {
  const double dated = toSeconds(change.onset_ns) - options.change_at_s;
  const int camera = options.rig.size() == 2 ? 1 : options.changed;
  if (change.camera != camera || std::abs(dated) > kOnsetTolerance) return false;
  const Eigen::Vector3d error = change.rotation - trueTurn(options);
  const double p =
      chiSquareExceedance(error.dot(change.rotation_covariance.inverse() * error), 3.0);
  tally->amount += p > kBeyondThreeSigma;
  tally->error_deg.push_back(error.norm() / kDegree);
  tally->late_s.push_back(toSeconds(change.found_ns) - options.change_at_s);
  tally->dated_s.push_back(std::abs(dated));
  return true;
}

void runChange(const std::string& kind, double degrees, std::uint64_t seed, MountTally* tally) {
  const SimulatedRigOptions options = rigThatChanges(kind, degrees, seed);
  const SimulatedRig rig = simulateRig(options);
  const Rig after = afterBump(options);
  RigSession session({}, rig.truth.size(), rig.across);
  bool known = false, falsely = false;
  play(rig, asFoundAlone(rig.truth, seed), &session, [&](const RigReport& report) {
    if (report.state != CalibrationState::kConverged) return;
    const double time_s = toSeconds(report.estimate.poses.back().stamp_ns);
    known = known || time_s < options.change_at_s;
    falsely = falsely || !(near(report.estimate, rig.truth) || near(report.estimate, after));
  });
  const RigReport last = session.report();
  bool found = false;
  int others = 0;
  for (const MountChange& change : last.mount_changes) {
    const bool right = kind == "bump" && judgeChange(change, options, tally);
    others += !right || found;
    found = found || right;
  }
  const bool again = last.state == CalibrationState::kConverged && near(last.estimate, after);
  ++tally->rigs;
  tally->known += known;
  tally->found += found;
  tally->others += others;
  tally->again += again;
  tally->falsely += falsely;
  std::printf("rig %llu, %d cameras%s, camera %d at %.1f s: %s%s%s%s%s\n",
              static_cast<unsigned long long>(seed), rig.truth.size(),
              seed % 2 == 0 ? ", overlap" : "", options.changed, options.change_at_s,
              known ? "known, " : "not known, ", found ? "found, " : "",
              others > 0 ? "something else found, " : "", again ? "CONVERGED in the end" : "",
              falsely ? ", FALSELY CONVERGED" : "");
  for (const MountChange& change : last.mount_changes) {
    std::printf("  %s (p = %.1e)\n", change.sentence.c_str(), change.p_value);
  }
  std::fflush(stdout);
}

int runChanges(const std::string& kind, double degrees, int rigs, std::uint64_t first_seed) {
  MountTally tally;
  for (int i = 0; i < rigs; ++i) {
    runChange(kind, degrees, first_seed + static_cast<std::uint64_t>(i), &tally);
  }
  const std::string found =
      kind == "bump" ? std::to_string(tally.found) + " of " + std::to_string(tally.rigs) : "-";
  std::printf(
      "\n| change | rigs | CONVERGED before | found, and the right one | something else found "
      "| inside 3 sigma, median error [degrees] | told after [s], dated to [s] (medians) "
      "| CONVERGED on the truth in the end | CONVERGED wrongly |\n"
      "|---|---|---|---|---|---|---|---|---|\n"
      "| %s | %d | %d | %s | %d | %d, %.4f | %.1f, %.2f | %d | %d |\n",
      kind.c_str(), tally.rigs, tally.known, found.c_str(), tally.others, tally.amount,
      median(tally.error_deg, NAN), median(tally.late_s, NAN), median(tally.dated_s, NAN),
      tally.again, tally.falsely);
  return 0;
}

void printAudits(const char* which, const std::map<AuditVerdict, int>& verdicts) {
  std::printf("| audit of %s |", which);
  for (const AuditVerdict verdict :
       {AuditVerdict::kGood, AuditVerdict::kWrong, AuditVerdict::kCannotTell}) {
    const auto found = verdicts.find(verdict);
    std::printf(" %s %d", toString(verdict).c_str(), found == verdicts.end() ? 0 : found->second);
  }
  std::printf(" |\n");
}

int run(int rigs, std::uint64_t first_seed) {
  Tally tally;
  for (int i = 0; i < rigs; ++i) run(first_seed + static_cast<std::uint64_t>(i), &tally);
  const auto row = [](const char* what, int inside, int of, double error) {
    std::printf("| %s inside 3 sigma, median error | %d of %d, %.4f degrees |\n", what, inside, of,
                error);
  };
  std::printf("\n| | %d rigs, %d poses |\n|---|---|\n", tally.rigs, tally.rotations);
  std::printf("| CONVERGED | %d rigs, %d of them beyond three times the limits |\n",
              tally.converged, tally.falsely);
  row("rotations", tally.rotations_inside, tally.rotations, median(tally.rotation_deg, NAN));
  row("the same, taken together with the lenses,", tally.turns_inside, tally.rotations,
      median(tally.turn_deg, NAN));
  row("directions", tally.positions_inside, tally.positions, median(tally.direction_deg, NAN));
  printAudits("the true rig", tally.true_ones);
  printAudits("a rig with a camera turned by 0.5 degrees", tally.turned_ones);
  return 0;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  const auto values = readArguments(
      argc, argv,
      {{"--rigs", "20"}, {"--first-seed", "1"}, {"--change", ""}, {"--degrees", "0.5"}});
  if (!values) return 1;
  const std::string change = values->at("--change");
  if (!change.empty()) {
    return runChanges(change, std::stod(values->at("--degrees")), std::stoi(values->at("--rigs")),
                      std::stoull(values->at("--first-seed")));
  }
  return run(std::stoi(values->at("--rigs")), std::stoull(values->at("--first-seed")));
}
