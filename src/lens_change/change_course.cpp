#include "camera_self_calibration/lens_change/change_course.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace camera_self_calibration {
namespace {

constexpr std::size_t kMinRamp = 3;

double middle(const QuadraticLikelihood& segment) {
  return 0.5e-9 * static_cast<double>(segment.begin_ns + segment.end_ns);
}

// The most likely change of a given course: `parameters` times the weight of each segment.
struct Explanation {
  double explained = 0.0;  // of the segments' chi-square
  double last_weight = 1.0;
  Eigen::VectorXd parameters;
  Eigen::MatrixXd information;
};

Explanation explain(const std::vector<QuadraticLikelihood>& segments, std::size_t first,
                    bool gradual, const Intrinsics& point) {
  Explanation result;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(point.size());
  result.information = Eigen::MatrixXd::Zero(point.size(), point.size());
  // A ramp begins with the last segment before it, or, where there is none, as long before as the
  // second comes after the first.
  const std::size_t second = std::min<std::size_t>(1, segments.size() - 1);
  const double begin = first > 0 ? middle(segments[first - 1])
                                 : 2.0 * middle(segments[0]) - middle(segments[second]);
  for (std::size_t i = first; i < segments.size(); ++i) {
    result.last_weight = gradual ? middle(segments[i]) - begin : 1.0;
    gradient += result.last_weight * segments[i].gradientAt(point);
    result.information += result.last_weight * result.last_weight * segments[i].information;
  }
  result.parameters = result.information.ldlt().solve(gradient);
  result.explained = gradient.dot(result.parameters);
  return result;
}

}  // namespace

ChangeCourse courseOfChange(const std::vector<QuadraticLikelihood>& segments,
                            const Reference& reference) {
  ChangeCourse course;
  course.camera = reference.camera;
  const int count = reference.camera.estimatedCount();
  const Intrinsics point = reference.camera.parameters().head(count);
  double most = 0.0;
  for (std::size_t first = 0; first < segments.size(); ++first) {
    for (const bool gradual : {false, true}) {
      if (gradual && segments.size() - first < kMinRamp) continue;
      const Explanation trial = explain(segments, first, gradual, point);
      if (!(trial.explained > most)) continue;
      most = trial.explained;
      course.gradual = gradual;
      course.first = first;
      Intrinsics parameters = reference.camera.parameters();
      parameters.head(count) += trial.last_weight * trial.parameters;
      course.camera.setParameters(parameters);
      course.information = trial.information / (trial.last_weight * trial.last_weight);
    }
  }
  return course;
}

}  // namespace camera_self_calibration
