#include "camera_self_calibration/fleet/epochs.h"

#include <algorithm>
#include <utility>

namespace camera_self_calibration {
namespace {

using Members = std::vector<std::size_t>;  // of a series, in the order of time

// The likeliest to be false of what may have happened in a period that is taken for one lens.
struct Finding {
  bool stray = false;
  std::size_t position = 0;  // in the period: the first after a change, or the stray one
  Difference difference;

  bool operator<(const Finding& other) const {
    return std::make_pair(difference.p_value, -difference.statistic) <
           std::make_pair(other.difference.p_value, -other.difference.statistic);
  }
};

struct Period {
  std::size_t series;
  Members members;
  Finding finding;
};

struct Split {
  std::vector<bool> stray;
  std::vector<EpochBoundary> changes;
};

std::vector<Estimate> estimatesOf(const EstimateSeries& series, const Members& members) {
  std::vector<Estimate> estimates;
  for (const std::size_t i : members) estimates.push_back(series.estimates[i]);
  return estimates;
}

Finding worstOf(const EstimateSeries& series, const Members& members) {
  Finding worst;
  if (members.size() < 2) return worst;
  const Intrinsics origin = series.estimates[members.front()].value;
  const IntrinsicsMatrix unit = pixelUnit(series.lens);
  const EstimateSum none(origin, unit);
  // A change elsewhere in the period is no scatter that could hide this one.
  const double most_tau_squared = successiveScatter(estimatesOf(series, members), unit);
  EstimateSum all = none;
  for (const std::size_t i : members) all.add(series.estimates[i]);
  EstimateSum before = none;
  for (std::size_t k = 0; k < members.size(); ++k) {
    const auto consider = [&](bool stray, const EstimateSum& some) {
      EstimateSum others = all;
      others -= some;
      const Finding finding{stray, k, difference(some, others, most_tau_squared)};
      if (finding < worst) worst = finding;
    };
    if (k > 0) consider(false, before);
    EstimateSum own = none;
    own.add(series.estimates[members[k]]);
    if (k > 0 && k + 1 < members.size()) consider(true, own);
    before += own;
  }
  return worst;
}

std::size_t hypotheses(const EstimateSeries& series) {
  const std::size_t count = series.estimates.size();
  return count < 2 ? 0 : 2 * count - 3;
}

// Replaces the period by what is left of it.
void apply(const std::vector<EstimateSeries>& cameras, std::size_t index,
           std::vector<Period>* periods, std::vector<Split>* splits) {
  Period period = std::move((*periods)[index]);
  periods->erase(periods->begin() + static_cast<std::ptrdiff_t>(index));
  const EstimateSeries& series = cameras[period.series];
  const auto middle = period.members.begin() + static_cast<std::ptrdiff_t>(period.finding.position);
  Split& split = (*splits)[period.series];
  std::vector<Members> parts;
  if (period.finding.stray) {
    split.stray[*middle] = true;
    period.members.erase(middle);
    parts = {period.members};
  } else {
    split.changes.push_back({*middle, period.finding.difference.p_value});
    parts = {Members(period.members.begin(), middle), Members(middle, period.members.end())};
  }
  for (Members& members : parts) {
    const Finding finding = worstOf(series, members);
    periods->push_back({period.series, std::move(members), finding});
  }
}

EpochSplit numbered(Split split) {
  std::sort(split.changes.begin(), split.changes.end(),
            [](const EpochBoundary& a, const EpochBoundary& b) { return a.first < b.first; });
  EpochSplit result;
  std::size_t next = 0;
  for (std::size_t i = 0; i < split.stray.size(); ++i) {
    while (next < split.changes.size() && split.changes[next].first <= i) ++next;
    result.epoch.push_back(split.stray[i] ? -1 : static_cast<int>(next));
  }
  result.changes = std::move(split.changes);
  return result;
}

}  // namespace

std::vector<EpochSplit> findEpochs(const std::vector<EstimateSeries>& cameras, double level) {
  std::vector<Period> periods;
  std::vector<Split> splits;
  std::size_t left = 0;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const std::size_t count = cameras[c].estimates.size();
    splits.push_back({std::vector<bool>(count, false), {}});
    left += hypotheses(cameras[c]);
    Members members(count);
    for (std::size_t i = 0; i < count; ++i) members[i] = i;
    const Finding finding = worstOf(cameras[c], members);
    periods.push_back({c, std::move(members), finding});
  }
  for (; left > 0; --left) {
    const auto worst =
        std::min_element(periods.begin(), periods.end(),
                         [](const Period& a, const Period& b) { return a.finding < b.finding; });
    if (!(worst->finding.difference.p_value * static_cast<double>(left) < level)) break;
    apply(cameras, static_cast<std::size_t>(worst - periods.begin()), &periods, &splits);
  }
  std::vector<EpochSplit> result;
  result.reserve(splits.size());
  for (Split& split : splits) result.push_back(numbered(std::move(split)));
  return result;
}

}  // namespace camera_self_calibration
