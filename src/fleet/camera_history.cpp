#include "camera_self_calibration/fleet/camera_history.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/fleet/state_solution.h"
#include "camera_self_calibration/pipeline/learnt_state.h"

namespace camera_self_calibration {
namespace {

// Image size, number of estimated intrinsics and model: what bags have to share to be compared.
using Kind = std::tuple<int, int, int, CameraModel>;

Kind kindOf(const Camera& lens) {
  return {lens.width(), lens.height(), lens.estimatedCount(), lens.model()};
}

using Size = std::pair<int, int>;

Size sizeOf(const Camera& lens) { return {lens.width(), lens.height()}; }

auto timeAndName(const BagRecord& record) {
  return std::tie(record.begin_ns, record.end_ns, record.bag, record.state_file);
}

// A lens of the commonest size, of the commonest kind among those; of the first such bag.
Camera commonLens(const std::vector<HistoricBag>& bags) {
  std::map<Size, std::size_t> of_size;
  std::map<Kind, std::size_t> of_kind;
  for (const HistoricBag& bag : bags) {
    ++of_size[sizeOf(bag.record.lens)];
    ++of_kind[kindOf(bag.record.lens)];
  }
  const auto rank = [&](const HistoricBag& bag) {
    const Kind kind = kindOf(bag.record.lens);
    return std::make_tuple(of_size[sizeOf(bag.record.lens)], of_kind[kind], kind);
  };
  const auto common = std::max_element(
      bags.begin(), bags.end(),
      [&](const HistoricBag& a, const HistoricBag& b) { return rank(a) < rank(b); });
  return common == bags.end() ? Camera() : common->record.lens;
}

std::vector<WantedSegment> segmentsOf(const BagRecord& record) {
  std::vector<WantedSegment> wanted;
  for (const SegmentMark& mark : record.segments) {
    wanted.push_back({mark, 0, record.bag, record.state_file});
  }
  return wanted;
}

// A bag that chose another model.
void convert(const Camera& lens, const SegmentStore& store, HistoricBag* bag) {
  const std::string model = toString(bag->record.lens.model());
  std::vector<std::size_t> lost;
  LearntState state;
  state.camera = lens;
  state.line_delay_s = bag->record.line_delay_s;
  state.line_delay_sigma_s = bag->record.line_delay_sigma_s;
  state.segments = store.load(bag->record.camera, segmentsOf(bag->record), &lost);
  const auto converted = withModel(state, lens);
  const auto anew = converted ? recordOf(*converted) : std::nullopt;
  if (!anew) {
    bag->problem = "it chose the model " + model + ", and " +
                   (lost.empty() ? "has no solution with " : "its segments are gone to try ") +
                   toString(lens.model());
    return;
  }
  bag->used.lens = anew->lens;
  bag->used.covariance = anew->covariance;
  bag->used.uncertainty_px = anew->uncertainty_px;
  bag->used.scatter = anew->scatter;
  bag->used.segments = anew->segments;
}

void useOneModel(const SegmentStore& store, CameraHistory* history) {
  history->lens = commonLens(history->bags);
  for (HistoricBag& bag : history->bags) {
    const Camera& lens = bag.record.lens;
    if (sizeOf(lens) != sizeOf(history->lens)) {
      bag.problem = "its images have " + sizeText(lens.width(), lens.height()) +
                    ", those of most bags " +
                    sizeText(history->lens.width(), history->lens.height());
    } else if (kindOf(lens) != kindOf(history->lens)) {
      convert(history->lens, store, &bag);
    }
  }
}

// Those that can be compared, and which of the bags they are.
std::pair<EstimateSeries, std::vector<std::size_t>> seriesOf(const CameraHistory& history) {
  std::pair<EstimateSeries, std::vector<std::size_t>> result;
  result.first.lens = history.lens;
  for (std::size_t i = 0; i < history.bags.size(); ++i) {
    if (!history.bags[i].problem.empty()) continue;
    result.first.estimates.push_back(estimateOf(history.bags[i].used));
    result.second.push_back(i);
  }
  return result;
}

void applySplit(EpochSplit split, const std::vector<std::size_t>& bags, CameraHistory* history) {
  for (std::size_t i = 0; i < bags.size(); ++i) history->bags[bags[i]].epoch = split.epoch[i];
  for (EpochBoundary& change : split.changes) change.first = bags[change.first];
  history->changes = std::move(split.changes);
}

// Times alone do not tell: all videos and folders of images begin at 0.
bool isSameBag(const BagRecord& a, const BagRecord& b) {
  return a.bag == b.bag && a.begin_ns == b.begin_ns && a.end_ns == b.end_ns;
}

std::vector<CameraHistory> byCamera(std::vector<BagRecord> records) {
  std::map<std::string, CameraHistory> cameras;
  std::sort(records.begin(), records.end(),
            [](const BagRecord& a, const BagRecord& b) { return timeAndName(a) < timeAndName(b); });
  for (BagRecord& record : records) {
    CameraHistory& history = cameras[record.camera];
    history.name = record.camera;
    const bool again = !history.bags.empty() && isSameBag(history.bags.back().record, record);
    if (!again) history.bags.push_back({record, record, "", -1});
  }
  std::vector<CameraHistory> result;
  result.reserve(cameras.size());
  for (auto& [name, history] : cameras) result.push_back(std::move(history));
  return result;
}

}  // namespace

Estimate estimateOf(const BagRecord& record) {
  Estimate estimate;
  estimate.value = record.lens.parameters().head(record.lens.estimatedCount());
  const double noise = pixelUncertainty(record.lens, record.covariance).rms;
  const double beyond =
      std::max(0.0, record.uncertainty_px * record.uncertainty_px - noise * noise);
  estimate.covariance = record.covariance + beyond * pixelUnit(record.lens);
  estimate.freedom = record.scatter.freedom;
  return estimate;
}

EstimateSum sumOf(const CameraHistory& history, int epoch) {
  EstimateSum sum(history.lens.parameters().head(history.lens.estimatedCount()),
                  pixelUnit(history.lens));
  for (const HistoricBag& bag : history.bags) {
    if (bag.epoch == epoch && bag.problem.empty()) sum.add(estimateOf(bag.used));
  }
  return sum;
}

std::vector<CameraHistory> historiesOf(std::vector<BagRecord> records, const SegmentStore& store,
                                       double level) {
  std::vector<CameraHistory> histories = byCamera(std::move(records));
  std::vector<EstimateSeries> series;
  std::vector<std::vector<std::size_t>> compared;
  for (CameraHistory& history : histories) {
    useOneModel(store, &history);
    auto [estimates, bags] = seriesOf(history);
    series.push_back(std::move(estimates));
    compared.push_back(std::move(bags));
  }
  std::vector<EpochSplit> splits = findEpochs(series, level);
  for (std::size_t i = 0; i < histories.size(); ++i) {
    applySplit(std::move(splits[i]), compared[i], &histories[i]);
  }
  return histories;
}

}  // namespace camera_self_calibration
