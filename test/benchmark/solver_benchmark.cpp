// The solver against Ceres with analytic costs: the same problems from the same starts, the same
// number of iterations. scripts/bench divides the times of pairs.

#include <benchmark/benchmark.h>

#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/solver.h"
#include "solver_scene.h"

namespace camera_self_calibration {
namespace {

using Kind = SolverScene::Kind;

constexpr double kHuber = 2.0;
constexpr int kIterations = 4;

void solveOurs(SolverScene* scene, int threads) {
  SolverOptions options;
  options.threads = threads;
  options.max_iterations = kIterations;
  options.precision = 0.0;
  benchmark::DoNotOptimize(solve(scene->problem(), options));
}

// A dense Schur complement is the faster for one segment, a sparse one for ten.
void solveCeres(SolverScene* scene, int threads, bool sparse = false) {
  BatchOptions options;
  options.huber = kHuber;
  options.threads = threads;
  options.max_iterations = kIterations;
  options.estimate_intrinsics = scene->estimatesIntrinsics();
  options.small = !sparse;
  benchmark::DoNotOptimize(solveBatch(scene->batch(), &scene->camera(), options));
}

void marginalOurs(SolverScene* scene, int threads) {
  benchmark::DoNotOptimize(marginalize(scene->problem(), kHuber, threads));
}

void marginalCeres(SolverScene* scene, int threads) {
  BatchOptions options;
  options.huber = kHuber;
  options.threads = threads;
  benchmark::DoNotOptimize(batchCovariance(scene->batch(), scene->camera(), options));
}

template <typename Work>
void time(benchmark::State& state, SolverScene* scene, const Work& work) {
  for (auto _ : state) {
    state.PauseTiming();
    scene->restart();
    state.ResumeTiming();
    work(scene);
  }
  state.counters["observations"] = scene->observations();
}

void slidingWindow(benchmark::State& state, bool ours) {
  SolverScene scene(Kind::kSlidingWindow);
  time(state, &scene, [ours](SolverScene* s) { ours ? solveOurs(s, 1) : solveCeres(s, 1); });
}

void candidate(benchmark::State& state, bool ours) {
  SolverScene scene(Kind::kCandidate);
  time(state, &scene, [ours](SolverScene* s) {
    ours ? solveOurs(s, 1) : solveCeres(s, 1);
    ours ? marginalOurs(s, 1) : marginalCeres(s, 1);
  });
}

void marginal(benchmark::State& state, bool ours) {
  SolverScene scene(Kind::kCandidate);
  time(state, &scene, [ours](SolverScene* s) { ours ? marginalOurs(s, 1) : marginalCeres(s, 1); });
}

// What honest sigmas cost: as at every keyframe, and the information as it is.
void information(benchmark::State& state, InverseDepthNoise noise) {
  SolverScene scene(Kind::kCandidate);
  time(state, &scene, [noise](SolverScene* s) {
    benchmark::DoNotOptimize(marginalize(s->problem(), kHuber, 1, noise));
  });
}

void queue(benchmark::State& state, bool ours) {
  SolverScene scene(Kind::kQueue);
  const int threads = static_cast<int>(state.range(0));
  time(state, &scene,
       [=](SolverScene* s) { ours ? solveOurs(s, threads) : solveCeres(s, threads, true); });
}

// The whole trajectory as one batch, as the paper compares with.
void batch(benchmark::State& state, bool with_covariance) {
  SolverScene scene(Kind::kBatch, static_cast<int>(state.range(0)));
  BatchOptions options;
  options.huber = kHuber;
  options.max_iterations = kIterations;
  time(state, &scene, [&](SolverScene* s) {
    benchmark::DoNotOptimize(solveBatch(s->batch(), &s->camera(), options));
    if (with_covariance) marginalCeres(s, 1);
  });
}

constexpr auto kMs = benchmark::kMillisecond;

BENCHMARK_CAPTURE(slidingWindow, ours, true)->Unit(kMs);
BENCHMARK_CAPTURE(slidingWindow, ceres, false)->Unit(kMs);
BENCHMARK_CAPTURE(candidate, ours, true)->Unit(kMs);
BENCHMARK_CAPTURE(candidate, ceres, false)->Unit(kMs);
BENCHMARK_CAPTURE(marginal, ours, true)->Unit(kMs);
BENCHMARK_CAPTURE(marginal, ceres, false)->Unit(kMs);
BENCHMARK_CAPTURE(information, plain, InverseDepthNoise::kCounts)->Unit(kMs);
BENCHMARK_CAPTURE(information, honest, InverseDepthNoise::kDiscounted)->Unit(kMs);
BENCHMARK_CAPTURE(queue, ours, true)->Arg(1)->Arg(2)->Unit(kMs)->UseRealTime();
BENCHMARK_CAPTURE(queue, ceres, false)->Arg(1)->Arg(2)->Unit(kMs)->UseRealTime();
BENCHMARK_CAPTURE(batch, ceres, false)->Arg(100)->Arg(300)->Arg(600)->Arg(1200)->Unit(kMs);
BENCHMARK_CAPTURE(batch, ceres_with_covariance, true)->Arg(100)->Arg(300)->Unit(kMs);

}  // namespace
}  // namespace camera_self_calibration

BENCHMARK_MAIN();
