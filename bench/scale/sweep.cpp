// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/sweep.h"

#include <algorithm>
#include <bit>

#include "bench/error/frame.h"

namespace goldthread::bench {
namespace {

constexpr int kTile = 64;
constexpr int kWorkersPerCompositor = 8;
constexpr int kChunksPerMaster = 16;
constexpr std::uint32_t kMostTiles = 1U << 16;  ///< more are too many for any master

/// Of 1, 4, 16 … megapixels.
TileGrid grid_of(int megapixels, int tile_px) {
  const int edge = 1024 << (std::bit_width(unsigned(megapixels)) - 1) / 2;
  return TileGrid::squares({edge, edge}, tile_px);
}

/// As many compositors as keep up with the workers, at most one for each row of tiles.
ClusterShape shape_of(int workers, int masters, const TileGrid& grid) {
  ClusterShape shape;
  shape.workers = workers;
  shape.compositors = std::clamp(workers / kWorkersPerCompositor, 1, grid.rows());
  shape.masters = masters;
  shape.tiles_per_chunk =
      masters == 1 ? 1 : std::max(1, int(grid.count()) / (masters * kChunksPerMaster));
  return shape;
}

SweepPoint point_of(int view, int megapixels, int tile_px, int workers, int masters) {
  const TileGrid grid = grid_of(megapixels, tile_px);
  SweepPoint point;
  point.view = view;
  point.megapixels = megapixels;
  point.tile_px = tile_px;
  point.tiles = grid.count();
  point.shape = shape_of(workers, masters, grid);
  return point;
}

/// Simulates all of them, the longest first.
void run(std::vector<SweepPoint>& points, const std::vector<RecordedView>& views,
         const ClusterModel& model, const SweepSettings& settings) {
  std::vector<SweepPoint*> order;
  order.reserve(points.size());
  for (SweepPoint& point : points) order.push_back(&point);
  std::stable_sort(order.begin(), order.end(),
                   [](const SweepPoint* a, const SweepPoint* b) { return a->tiles > b->tiles; });
  in_parallel(
      settings.threads, order.size(),
      [&](std::size_t i) {
        SweepPoint& point = *order[i];
        const RecordedView& view = views[std::size_t(point.view)];
        const TileGrid grid = grid_of(point.megapixels, point.tile_px);
        const FrameWork now = work_of(view.now, grid);
        point.tile_us = now.us() / (double(point.tiles) * double(now.steps.size()));
        point.frame = simulate(now, work_of(view.before, grid), model, point.shape);
      },
      settings.progress);
}

}  // namespace

std::string limit_of(const SweepPoint& point) {
  constexpr double kBusy = 0.7;
  const SimulatedFrame& frame = point.frame;
  const double masters = std::max(frame.master_busy, frame.top_busy);
  if (std::max(masters, frame.compositor_busy) >= kBusy)
    return masters >= frame.compositor_busy ? "master" : "compositors";
  // Dear tiles go first, so cheap ones come in a crowd: a queue may be long that is short on
  // average.
  if (frame.compositors_late_us > frame.us / 4) return "compositors";
  if (frame.master_wait_us > point.tile_us / 2) return "master";
  if (point.tiles < unsigned(2 * point.shape.workers * point.shape.threads)) return "too few tiles";
  return "ends of steps";
}

std::vector<SweepPoint> sweep_one_level(const std::vector<RecordedView>& views,
                                        const ClusterModel& model, const SweepSettings& settings) {
  std::vector<SweepPoint> points;
  for (int view = 0; view < int(views.size()); ++view)
    for (const int megapixels : settings.megapixels)
      for (const int workers : settings.workers)
        points.push_back(point_of(view, megapixels, kTile, workers, 1));
  run(points, views, model, settings);
  return points;
}

std::vector<SweepPoint> sweep_two_levels(const std::vector<RecordedView>& views,
                                         const ClusterModel& model, const SweepSettings& settings) {
  std::vector<SweepPoint> points;
  for (int view = 0; view < int(views.size()); ++view)
    for (const int megapixels : settings.megapixels)
      for (const int tile_px : {16, 32, 64})
        for (int masters = 1; masters <= 256; masters *= 2) {
          const SweepPoint point = point_of(view, megapixels, tile_px, kMostWorkers, masters);
          if (point.tiles <= kMostTiles) points.push_back(point);
        }
  run(points, views, model, settings);
  return points;
}

const SweepPoint* second_level(const std::vector<SweepPoint>& points, int view, int megapixels,
                               double goal) {
  const SweepPoint* fewest = nullptr;
  const SweepPoint* best = nullptr;
  for (const SweepPoint& point : points) {
    if (point.view != view || point.megapixels != megapixels || point.shape.masters == 1) continue;
    const double efficiency = point.frame.efficiency;
    if (best == nullptr || efficiency > best->frame.efficiency) best = &point;
    if (efficiency < goal) continue;
    const auto is_less = [&](const SweepPoint& than) {
      return point.shape.masters != than.shape.masters ? point.shape.masters < than.shape.masters
                                                       : efficiency > than.frame.efficiency;
    };
    if (fewest == nullptr || is_less(*fewest)) fewest = &point;
  }
  return fewest != nullptr ? fewest : best;
}

std::vector<SweepPoint> sweep_like(const SweepPoint& plan, const std::vector<RecordedView>& views,
                                   const ClusterModel& model, const SweepSettings& settings) {
  const int each = plan.shape.workers / plan.shape.masters;
  std::vector<SweepPoint> points;
  for (const int workers : settings.workers)
    points.push_back(
        point_of(plan.view, plan.megapixels, plan.tile_px, workers, std::max(1, workers / each)));
  run(points, views, model, settings);
  return points;
}

}  // namespace goldthread::bench
