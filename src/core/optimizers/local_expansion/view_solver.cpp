// SPDX-FileCopyrightText: 2026 The fdp_stereo authors
// SPDX-License-Identifier: BSD-3-Clause
#include "optimizers/local_expansion/view_solver.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "optimizers/local_expansion/random.hpp"
#include "parallel.hpp"

namespace fdp_stereo::local_expansion {
namespace {

constexpr float kInitialMaxAngle = 1.04719755F;  // 60 degrees

int cellPx(double percent, int width) { return std::max(1, static_cast<int>(percent / 100.0 * width)); }

std::vector<Layer> makeLayers(const LocalExpansionParams& params, cv::Size size) {
  std::vector<Layer> layers;
  for (const double percent : {params.fine_cell, params.middle_cell, params.coarse_cell}) {
    layers.emplace_back(size, cellPx(percent, size.width));
  }
  return layers;
}

// Disparities of a map within a rectangle.
void collectPoints(const cv::Mat& disparity, const cv::Rect& area, std::vector<SurfacePoint>& points) {
  points.clear();
  for (int y = area.y; y < area.y + area.height; ++y) {
    const float* row = disparity.ptr<float>(y);
    for (int x = area.x; x < area.x + area.width; ++x) {
      if (std::isfinite(row[x])) points.push_back({static_cast<float>(x), static_cast<float>(y), row[x]});
    }
  }
}

}  // namespace

StopCondition::StopCondition(const std::atomic<bool>* cancel, double max_time_ms)
    : cancel_(cancel),
      limited_(max_time_ms > 0.0),
      end_(std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                  std::chrono::duration<double, std::milli>(max_time_ms))) {}

bool StopCondition::reached() const {
  if (cancel_ != nullptr && cancel_->load(std::memory_order_relaxed)) return true;
  return limited_ && std::chrono::steady_clock::now() >= end_;
}

struct ViewSolver::Worker {
  PlaneCostBuffers costs;
  ExpansionMove move;
  std::vector<SurfacePoint> points;
};

ViewSolver::ViewSolver(const View& view, const LocalExpansionParams& params)
    : view_(view),
      params_(params),
      guide_(makeFilterGuide(view.image, params.filter_radius_px, params.filter_epsilon)),
      cost_(*view.volume, view.range, view.steps, guide_, {params.data_scale, params.data_threshold, params.margin_px}),
      smoothness_(view.image, {params.lambda, params.tau_smooth_px, params.gamma, params.epsilon}),
      seeds_(params.seed_proposals ? SeedPlanes(view.seeds, view.image.size()) : SeedPlanes()),
      layers_(makeLayers(params, view.image.size())),
      proposals_{params.fine, params.middle, params.coarse},
      workers_(omp_get_max_threads()) {}

ViewSolver::~ViewSolver() = default;

Labels ViewSolver::solve(const StopCondition& stop, const Report& report) {
  Labels labels;
  labels.create(view_.image.size());
  initialize(labels);
  double energy = energyOf(labels, smoothness_);
  report(0, energy);
  const int rounds = params_.unary_iterations + params_.iterations;
  for (int i = 0; i < rounds; ++i) {
    const bool unary_only = i < params_.unary_iterations;
    if (!round(i, unary_only, stop, labels)) break;
    const double before = energy;
    energy = energyOf(labels, smoothness_);
    report(i + 1, energy);
    if (!unary_only && before - energy < params_.stop_gain / 100.0 * before) break;
  }
  return labels;
}

void ViewSolver::initialize(Labels& labels) {
  const std::vector<Cell>& cells = layers_.front().cells();
  const int count = static_cast<int>(cells.size());
  parallelFor(count, [&](int i) {
    Worker& worker = workers_[omp_get_thread_num()];
    const Cell& cell = cells[i];
    Random random({static_cast<std::uint64_t>(params_.seed), view_.number, 0, static_cast<std::uint64_t>(i)});
    choose(initialPlanes(cell, worker, random), cell, worker, labels);
  });
}

// Hands on every plane with its costs over the area; they are computed for some planes at a time.
template <typename Use>
void ViewSolver::evaluate(const Candidates& planes, const cv::Rect& area, PlaneCostBuffers& buffers,
                          const Use& use) const {
  for (std::size_t first = 0; first < planes.size(); first += kPlaneBatch) {
    const int count = static_cast<int>(std::min<std::size_t>(kPlaneBatch, planes.size() - first));
    PlaneBatch batch;
    for (int k = 0; k < kPlaneBatch; ++k) batch[k] = planes[first + std::min(k, count - 1)];
    cost_.evaluate(batch, area, buffers);
    for (int k = 0; k < count; ++k) use(batch[k], buffers.costs(k));
  }
}

// Gives every pixel of a cell the candidate that is cheapest there.
void ViewSolver::choose(const Candidates& planes, const Cell& cell, Worker& worker, Labels& labels) const {
  bool first = true;
  evaluate(planes, cell.core, worker.costs, [&](const Plane& plane, const float* cost) {
    for (int y = cell.core.y; y < cell.core.y + cell.core.height; ++y) {
      for (int x = cell.core.x; x < cell.core.x + cell.core.width; ++x, ++cost) {
        const std::size_t p = labels.index(x, y);
        if (!first && *cost >= labels.cost[p]) continue;
        labels.planes.set(p, plane);
        labels.cost[p] = *cost;
      }
    }
    first = false;
  });
}

ViewSolver::Candidates ViewSolver::initialPlanes(const Cell& cell, Worker& worker, Random& random) const {
  const float x = static_cast<float>(cell.core.x + random.below(cell.core.width));
  const float y = static_cast<float>(cell.core.y + random.below(cell.core.height));
  const float d = random.uniform(static_cast<float>(view_.range.min), static_cast<float>(view_.range.max()));
  Candidates planes;
  if (!view_.initial.empty()) {
    const RansacParams ransac{params_.ransac_threshold_px, params_.ransac_samples};
    for (const cv::Rect& area : {cell.core, cell.region}) {
      collectPoints(view_.initial, area, worker.points);
      if (worker.points.empty()) continue;
      const Plane plane = fitPlane(worker.points, ransac, random);
      const float centre_x = static_cast<float>(cell.core.x) + 0.5F * static_cast<float>(cell.core.width - 1);
      const float centre_y = static_cast<float>(cell.core.y) + 0.5F * static_cast<float>(cell.core.height - 1);
      const float centre_d = std::clamp(plane.at(centre_x, centre_y), static_cast<float>(view_.range.min),
                                        static_cast<float>(view_.range.max()));
      planes.push_back(plane);
      planes.push_back({0.0F, 0.0F, centre_d});
    }
  }
  Plane triangle;
  if (seeds_.planeAt(static_cast<int>(x), static_cast<int>(y), triangle)) planes.push_back(triangle);
  if (planes.empty()) planes.push_back(randomPlane(x, y, d, kInitialMaxAngle, random));
  return planes;
}

bool ViewSolver::round(int number, bool unary_only, const StopCondition& stop, Labels& labels) {
  for (int layer = 0; layer < static_cast<int>(layers_.size()); ++layer) {
    if (!visitLayer(layer, number, unary_only, stop, labels)) return false;
  }
  return true;
}

bool ViewSolver::visitLayer(int layer, int round, bool unary_only, const StopCondition& stop, Labels& labels) {
  for (int g = 0; g < Layer::kGroups; ++g) {
    if (stop.reached()) return false;
    const std::vector<int>& group = layers_[layer].group(g);
    const int count = static_cast<int>(group.size());
    const auto visit = [&](int i) {
      visitCell(layer, layers_[layer].cells()[group[i]], round, unary_only, workers_[omp_get_thread_num()], labels);
    };
    parallelFor(count, visit, 1);
  }
  return true;
}

void ViewSolver::visitCell(int layer, const Cell& cell, int round, bool unary_only, Worker& worker,
                           Labels& labels) const {
  const Candidates planes = propose(layer, cell, round, worker, labels);
  worker.move.begin(smoothness_, cell.region, labels);
  evaluate(planes, cell.region, worker.costs, [&](const Plane& plane, const float* costs) {
    if (unary_only) {
      worker.move.offerUnary(plane, costs);
    } else {
      worker.move.offer(plane, costs);
    }
  });
}

ViewSolver::Candidates ViewSolver::propose(int layer, const Cell& cell, int round, Worker& worker,
                                           const Labels& labels) const {
  Random random({static_cast<std::uint64_t>(params_.seed), view_.number, static_cast<std::uint64_t>(round) + 1,
                 static_cast<std::uint64_t>(layer), static_cast<std::uint64_t>(cell.index)});
  const PlaneProposals& wanted = proposals_[layer];
  Candidates planes;
  for (int i = 0; i < wanted.expansions; ++i) planes.push_back(proposeExpansion(labels, cell.core, random));
  const RansacParams ransac{params_.ransac_threshold_px, params_.ransac_samples};
  for (int i = 0; i < wanted.ransac; ++i) {
    planes.push_back(proposeRansac(labels, cell.core, ransac, random, worker.points));
  }
  for (int i = 0; i < wanted.random; ++i) {
    const int step = params_.random_first_step + round + i;
    const float tilt = std::ldexp(1.0F, -step);
    const float reach = 0.5F * tilt * static_cast<float>(view_.range.count - 1);
    planes.push_back(proposeRandom(labels, cell.core, view_.range, reach, tilt, random));
  }
  if (round > params_.unary_iterations) return planes;  // what is known beforehand pays in the first moves only
  Plane triangle;
  const int x = cell.core.x + random.below(cell.core.width);
  const int y = cell.core.y + random.below(cell.core.height);
  if (seeds_.planeAt(x, y, triangle)) planes.push_back(triangle);
  return planes;
}

}  // namespace fdp_stereo::local_expansion
