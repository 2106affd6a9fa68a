#include "camera_self_calibration/ros/report_yaml.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <string>

namespace camera_self_calibration {
namespace {

TEST(ReportYaml, SaysWhatTheMessageSaysOfTheLensModel) {
  CalibrationReport report;
  EXPECT_FALSE(YAML::Load(toYaml(report, 0))["misfit_rms_px"]) << "not compared yet";
  report.lens_fit = {true, "pinhole", true, "radtan", {5.0, 12.0}, {4.0, 9.0}, 0.0};
  report.observed.unseen_corners = "no feature reached the upper left corner";
  const YAML::Node yaml = YAML::Load(toYaml(report, 0));
  EXPECT_EQ(yaml["lens_fit"].as<std::string>(), report.lens_fit.sentence());
  EXPECT_EQ(yaml["better_model"].as<std::string>(), "radtan");
  EXPECT_EQ(yaml["misfit_rms_px"].as<double>(), 5.0);
  EXPECT_EQ(yaml["misfit_max_px"].as<double>(), 12.0);
  EXPECT_EQ(yaml["unseen_corners"].as<std::string>(), report.observed.unseen_corners);
}

}  // namespace
}  // namespace camera_self_calibration
