#include "camera_self_calibration/tools/calibrate.h"

#include <iostream>
#include <stdexcept>

#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/tools/progress.h"

namespace camera_self_calibration {
namespace {

std::string sizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

/// Lets through what the pipeline can take, and counts and explains the rest.
class InputCheck {
 public:
  /// Nothing if the image can be used, else why not.
  std::string problem(const SourceImage& image) {
    if (!image.view) return image.error;
    const ImageView& view = *image.view;
    if (used_ == 0) {
      width_ = view.width;
      height_ = view.height;
    } else if (view.width != width_ || view.height != height_) {
      return "an image has the size " + sizeText(view.width, view.height) + ", the first one " +
             sizeText(width_, height_);
    } else if (view.stamp_ns <= last_stamp_ns_) {
      return "an image is not later than the one before it";
    }
    last_stamp_ns_ = view.stamp_ns;
    ++used_;
    return {};
  }

  /// Says the first few problems only.
  void leaveOut(const std::string& problem) {
    constexpr int kMessages = 5;
    if (left_out_ == 0) first_problem_ = problem;
    if (++left_out_ <= kMessages) std::cerr << "warning: image left out: " << problem << '\n';
    if (left_out_ == kMessages) std::cerr << "warning: no further images will be named\n";
  }

  void conclude() const {
    if (used_ == 0 && left_out_ > 0) {
      throw std::runtime_error("none of the " + std::to_string(left_out_) +
                               " images can be used: " + first_problem_);
    }
    if (left_out_ > 0) std::cerr << "warning: " << left_out_ << " images left out\n";
  }

 private:
  std::int64_t used_ = 0;
  std::int64_t left_out_ = 0;
  std::int64_t last_stamp_ns_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::string first_problem_;
};

Callbacks recordInto(Recording* recording) {
  Callbacks callbacks;
  callbacks.frame = [recording](const FrameResult& result) {
    ++recording->frames;
    if (result.is_keyframe) ++recording->keyframes;
    if (result.state != TrackingState::kTracking) return;
    recording->poses.push_back(
        {result.stamp_ns, result.map_id, result.is_keyframe, result.world_from_camera});
  };
  callbacks.calibration = [recording](const CalibrationReport& report) {
    recording->reports.push_back(report);
  };
  callbacks.event = [recording](const Event& event) { recording->events.push_back(event); };
  return callbacks;
}

void checkInitialSize(const Options& options, const ImageView& first) {
  if (!options.initial_camera) return;
  const Camera& initial = *options.initial_camera;
  if (initial.width() == first.width && initial.height() == first.height) return;
  throw std::runtime_error("the start values are for images of " +
                           sizeText(initial.width(), initial.height()) + ", these have " +
                           sizeText(first.width, first.height));
}

}  // namespace

Recording calibrate(ImageSource* source, const Options& options) {
  Recording recording;
  SelfCalibrator calibrator(options, SelfCalibrator::Mode::kInline, recordInto(&recording));
  Progress progress(source->count);
  InputCheck check;
  while (const std::optional<SourceImage> image = source->next()) {
    progress.advance();
    const std::string problem = check.problem(*image);
    if (!problem.empty()) {
      check.leaveOut(problem);
      continue;
    }
    if (recording.frames == 0) checkInitialSize(options, *image->view);
    calibrator.process(*image->view);
    if (!recording.reports.empty()) progress.show(recording.reports.back());
  }
  calibrator.flush();
  check.conclude();
  recording.processing_seconds = progress.elapsedSeconds();
  recording.final_report = calibrator.calibration();
  if (recording.frames > 0) progress.show(recording.final_report, true);
  progress.finish();
  return recording;
}

}  // namespace camera_self_calibration
