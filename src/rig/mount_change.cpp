#include "camera_self_calibration/rig/mount_change.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "camera_self_calibration/base/decompositions.h"
#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/queue/scatter.h"
#include "rig_chart.h"

namespace camera_self_calibration {
namespace {

// Probability, where nothing changed, from which on what is found is not believed yet.
constexpr double kDoubt = 1e-2;
// Probability with which a lens that changed, or a segment that is wrong, passes for a mount that
// changed: if one of these is the truth, by how much a mount explains the segments better is at
// most chi-square.
constexpr double kConfused = 1e-3;
// Share of a statistic by which likelihoods that are taken as quadratic may be wrong, as far from
// where they were taken as a change that is as plain as that: two explanations that differ by less
// explain as well. An explanation that leaves no more than the sigmas say needs no such allowance.
constexpr double kNotQuadratic = 0.05;
// Shares of a segment that lie after the change, where it came within a segment: what such a
// segment says lies between the two, by about this share.
constexpr double kShares[] = {0.0, 0.2, 0.4, 0.6, 0.8};
// Segments after one that is wrong, for it to be that and no change.
constexpr std::size_t kLater = 2;
// Of the largest eigenvalue: what is smaller is not told.
constexpr double kUntold = 1e-8;

// Since when: `first` is the first segment wholly after it, the one before it by this share.
struct Onset {
  std::size_t first = 0;
  double share = 0.0;
};

struct Quadratic {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
};

// x^T A^+ x, the pseudo-inverse and its rank.
struct Solved {
  double square = 0.0;
  int rank = 0;
  Eigen::MatrixXd inverse;
};

Solved solved(const Eigen::MatrixXd& a, const Eigen::VectorXd& x, double least) {
  const SymmetricEigen eigen = symmetricEigen(a);
  Solved result;
  result.inverse = Eigen::MatrixXd::Zero(a.rows(), a.cols());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const double value = eigen.values(i);
    if (!(value > least)) continue;
    const Eigen::VectorXd direction = eigen.vectors.col(i);
    const double along = direction.dot(x);
    result.square += along * along / value;
    result.inverse += direction * direction.transpose() / value;
    ++result.rank;
  }
  return result;
}

// A hypothesis against one rig throughout.
struct Explanation {
  double statistic = 0.0;
  int freedom = 0;
  Eigen::VectorXd amount;
  Eigen::MatrixXd covariance;
  Onset onset;
  int camera = 0;
};

// All segments together, with intrinsics and poses at their best.
class MountAccount {
 public:
  MountAccount(const std::vector<RigLikelihood>& segments, const Rig& reference);

  bool usable() const { return usable_; }
  MountVerdict conclude(double level) const;

 private:
  Explanation explain(const Quadratic& once, const Eigen::MatrixXd& twice,
                      const Eigen::MatrixXd& basis) const;
  Explanation since(const Onset& onset, const Eigen::MatrixXd& basis) const;
  Explanation likeliest(const std::vector<Eigen::MatrixXd>& bases) const;
  Explanation outlier() const;
  Scatter left(const Explanation& explanation) const;
  Scatter scatterAfter(const Explanation& explanation) const;
  bool explainsAll(const Explanation& mount) const;
  double varianceUnder(const Explanation& explanation) const;
  double pValue(const Explanation& explanation, double choices) const;
  MountChange describe(const Explanation& explanation) const;
  std::int64_t stampOf(const Onset& onset) const;

  const std::vector<RigLikelihood>& segments_;
  const Rig& reference_;
  RigChart chart_;
  bool usable_ = false;
  std::vector<Quadratic> quadratics_;
  Quadratic all_;
  Eigen::VectorXd scale_;  // of the unknowns, to a unit diagonal
  Eigen::LDLT<Eigen::MatrixXd> factor_;
  Scatter scatter_;  // of one rig throughout
  std::vector<Onset> onsets_;
};

MountAccount::MountAccount(const std::vector<RigLikelihood>& segments, const Rig& reference)
    : segments_(segments), reference_(reference), chart_(reference) {
  const int n = chart_.size();
  all_ = {Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  for (const RigLikelihood& segment : segments) {
    const auto [information, gradient] = chart_.of(segment);
    quadratics_.push_back({information, gradient});
    all_.information += information;
    all_.gradient += gradient;
    const Solved own = solved(information, gradient, kUntold * information.diagonal().maxCoeff());
    scatter_.chi_square += own.square;
    scatter_.freedom += own.rank;
  }
  for (std::size_t first = 1; first < segments.size(); ++first) {
    for (const double share : kShares) {
      if (share == 0.0 || first > 1) onsets_.push_back({first, share});
    }
  }
  const Solved together =
      solved(all_.information, all_.gradient, kUntold * all_.information.diagonal().maxCoeff());
  scatter_.chi_square = std::max(0.0, scatter_.chi_square - together.square);
  scatter_.freedom -= together.rank;
  scale_ = all_.information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale_.asDiagonal() * all_.information * scale_.asDiagonal();
  scaled.diagonal().array() += kUntold;  // for what no segment tells
  factor_.compute(scaled);
  usable_ = scatter_.freedom > 0 && factor_.info() == Eigen::Success;
}

// The likelihood ratio of deviations `basis * d` that segments have by their weights: `once` is
// the sum of their likelihoods by the weights, `twice` that of their information by the squares.
Explanation MountAccount::explain(const Quadratic& once, const Eigen::MatrixXd& twice,
                                  const Eigen::MatrixXd& basis) const {
  const Eigen::MatrixXd cross = once.information * basis;
  const Eigen::MatrixXd leverage = scale_.asDiagonal() * factor_.solve(scale_.asDiagonal() * cross);
  const Eigen::MatrixXd own = basis.transpose() * twice * basis;
  const Eigen::VectorXd gradient =
      basis.transpose() * once.gradient - leverage.transpose() * all_.gradient;
  const Eigen::MatrixXd information = own - cross.transpose() * leverage;
  Solved result = solved(information, gradient, kUntold * own.diagonal().maxCoeff());
  Explanation explanation;
  explanation.statistic = result.square;
  explanation.freedom = result.rank;
  explanation.amount = result.inverse * gradient;
  explanation.covariance = std::move(result.inverse);
  return explanation;
}

Explanation MountAccount::since(const Onset& onset, const Eigen::MatrixXd& basis) const {
  Quadratic once = all_;
  for (std::size_t i = 0; i < onset.first; ++i) {
    const double missing = i + 1 == onset.first ? 1.0 - onset.share : 1.0;
    once.information -= missing * quadratics_[i].information;
    once.gradient -= missing * quadratics_[i].gradient;
  }
  const double mixed = onset.share * (1.0 - onset.share);
  Explanation explanation =
      explain(once, once.information - mixed * quadratics_[onset.first - 1].information, basis);
  explanation.onset = onset;
  return explanation;
}

// Over all onsets; of the bases its `camera` is the number.
Explanation MountAccount::likeliest(const std::vector<Eigen::MatrixXd>& bases) const {
  Explanation best;
  for (const Onset& onset : onsets_) {
    for (std::size_t b = 0; b < bases.size(); ++b) {
      Explanation one = since(onset, bases[b]);
      if (!(one.statistic > best.statistic)) continue;
      best = std::move(one);
      best.camera = static_cast<int>(b);
    }
  }
  return best;
}

// One segment that says something else of any camera; its number is `onset.first`.
Explanation MountAccount::outlier() const {
  Explanation best;
  const Eigen::MatrixXd basis = chart_.allPoses();
  for (std::size_t i = 0; i < quadratics_.size(); ++i) {
    Explanation one = explain(quadratics_[i], quadratics_[i].information, basis);
    if (!(one.statistic > best.statistic)) continue;
    best = std::move(one);
    best.onset.first = i;
  }
  return best;
}

Scatter MountAccount::left(const Explanation& explanation) const {
  return {std::max(0.0, scatter_.chi_square - explanation.statistic),
          std::max(0, scatter_.freedom - explanation.freedom)};
}

// What is left, moderated by the sigmas themselves.
Scatter MountAccount::scatterAfter(const Explanation& explanation) const {
  return left(explanation).moderated();
}

// Whether what a change of mount leaves is no more than the sigmas say, but for chance. No rig
// explains a segment within which it may have happened, the last one before; and some move explains
// any single segment after it.
bool MountAccount::explainsAll(const Explanation& mount) const {
  const std::size_t within = mount.onset.first - 1;
  if (within == 0 || segments_.size() < mount.onset.first + 2) return false;
  std::vector<RigLikelihood> others = segments_;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(within));
  const MountAccount account(others, reference_);
  if (!account.usable()) return false;
  const Scatter rest =
      account.left(account.since({within, 0.0}, chart_.mountBases()[mount.camera]));
  return rest.freedom > 0 && chiSquareExceedance(rest.chi_square, rest.freedom) > kConfused;
}

// By which the sigmas are too small.
double MountAccount::varianceUnder(const Explanation& explanation) const {
  const double ratio = scatterAfter(explanation).birgeRatio();
  return ratio * ratio;
}

double MountAccount::pValue(const Explanation& explanation, double choices) const {
  if (explanation.freedom == 0) return 1.0;
  const double f = explanation.statistic / explanation.freedom / varianceUnder(explanation);
  return std::min(1.0,
                  choices * fExceedance(f, explanation.freedom, scatterAfter(explanation).freedom));
}

std::int64_t MountAccount::stampOf(const Onset& onset) const {
  if (onset.share == 0.0) return segments_[onset.first].begin_ns;
  const RigLikelihood& mixed = segments_[onset.first - 1];
  const double length = static_cast<double>(mixed.end_ns - mixed.begin_ns);
  return mixed.end_ns - static_cast<std::int64_t>(onset.share * length);
}

MountChange MountAccount::describe(const Explanation& explanation) const {
  MountChange change;
  change.camera = reference_.size() == 2 ? 1 : explanation.camera;
  change.onset_ns = stampOf(explanation.onset);
  change.found_ns = segments_.back().end_ns;
  const double variance = varianceUnder(explanation);
  // The basis of the first camera moves all others.
  const double sign = change.camera == 0 ? -1.0 : 1.0;
  change.rotation = sign * explanation.amount.head<3>();
  change.rotation_covariance = variance * explanation.covariance.topLeftCorner<3, 3>();
  change.shift = sign * explanation.amount.tail<3>();
  change.shift_covariance = variance * explanation.covariance.bottomRightCorner<3, 3>();
  change.shift_known = explanation.freedom > 3;
  return change;
}

MountVerdict MountAccount::conclude(double level) const {
  MountVerdict verdict;
  const std::vector<Eigen::MatrixXd> bases = chart_.mountBases();
  const Explanation mount = likeliest(bases);
  const double p_value = pValue(mount, static_cast<double>(onsets_.size() * bases.size()));
  if (!(p_value < kDoubt)) return verdict;
  verdict.kind = MountVerdict::Kind::kDoubt;
  verdict.change = describe(mount);
  verdict.change.p_value = p_value;
  verdict.certain = p_value < level;
  const double chance = varianceUnder(mount) * chiSquareQuantile(mount.freedom, kConfused);
  const double margin =
      explainsAll(mount) ? chance : std::max(chance, kNotQuadratic * mount.statistic);
  const Explanation lens = likeliest(chart_.lensBases());
  if (mount.statistic - lens.statistic <= margin) verdict.lens = lens.camera;
  const Explanation bad = outlier();
  if (mount.statistic - bad.statistic <= margin) {
    const auto segments = static_cast<double>(quadratics_.size());
    if (bad.onset.first + kLater < quadratics_.size() && pValue(bad, segments) < level) {
      verdict.kind = MountVerdict::Kind::kOutlier;
      verdict.index = bad.onset.first;
    }
  } else if (verdict.certain && !verdict.lens) {
    verdict.kind = MountVerdict::Kind::kChange;
    verdict.index = mount.onset.first;
  }
  return verdict;
}

double sigmaAlong(const Eigen::Vector3d& vector, const Eigen::Matrix3d& covariance) {
  if (!(vector.norm() > 0.0)) return std::sqrt(covariance.trace());
  const Eigen::Vector3d along = vector.normalized();
  return std::sqrt(std::max(0.0, along.dot(covariance * along)));
}

double chanceOf(const Eigen::Vector3d& vector, const Eigen::Matrix3d& covariance) {
  const LeastNormSolution solution = leastNormSolution(covariance, vector);
  const double square = vector.dot(solution.x.col(0));
  return solution.rank > 0 ? chiSquareExceedance(std::max(0.0, square), solution.rank) : 1.0;
}

}  // namespace

double MountChange::angleSigma() const { return sigmaAlong(rotation, rotation_covariance); }

double MountChange::shiftSigma() const { return sigmaAlong(shift, shift_covariance); }

double MountChange::rotationPValue() const { return chanceOf(rotation, rotation_covariance); }

double MountChange::shiftPValue() const {
  return shift_known ? chanceOf(shift, shift_covariance) : 1.0;
}

Rig moved(const Rig& rig, const MountChange& change) {
  Rig result = rig;
  const Rigid3 motion(expSo3(change.rotation), change.shift);
  for (int c = 1; c < rig.size(); ++c) {
    Rigid3& pose = result.rig_from_camera[c];
    if (change.camera == 0) pose = motion.inverse() * pose;
    if (change.camera != c) continue;
    pose.rotation = (motion.rotation * pose.rotation).normalized();
    pose.translation += motion.translation;
  }
  return result;
}

MountVerdict judgeMounts(const std::vector<RigLikelihood>& segments, const Rig& reference,
                         double level) {
  if (segments.size() < 3) return {};
  const MountAccount account(segments, reference);
  if (!account.usable()) return {};
  MountVerdict verdict = account.conclude(level);
  verdict.begin_ns = segments[verdict.index].begin_ns;
  verdict.end_ns = segments[verdict.index].end_ns;
  return verdict;
}

}  // namespace camera_self_calibration
