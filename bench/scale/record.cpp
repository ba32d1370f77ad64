// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/record.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <utility>

#include "bench/error/frame.h"
#include "bench/scale/thread_time.h"
#include "worker/refine_tile.h"

namespace goldthread::bench {
namespace {

constexpr int kTile = 64;
constexpr int kBlocksAcross = kTile / kBlockPixels;

/// Passes rays on and counts them by blocks of one tile. Rays on the replicated column and row
/// belong to the last blocks.
class BlockCounter final : public SampleSource {
 public:
  BlockCounter(const SampleSource& source, PixelRect tile) : source_(source), tile_(tile) {}

  CastCounts cast(std::span<const PixelPosition> positions, std::span<Sample> samples,
                  std::span<std::uint32_t> surfaces) const override {
    for (const PixelPosition& position : positions) {
      const int column = block_of(position.x - float(tile_.x));
      const int row = block_of(position.y - float(tile_.y));
      ++rays_[std::size_t(row * kBlocksAcross + column)];
    }
    return source_.cast(positions, samples, surfaces);
  }
  bool has_surfaces() const override { return source_.has_surfaces(); }

  std::vector<std::uint32_t> take_rays() const {
    std::vector<std::uint32_t> rays(rays_.begin(), rays_.end());
    rays_.fill(0);
    return rays;
  }

 private:
  static int block_of(float offset) {
    return std::clamp(static_cast<int>(offset) / kBlockPixels, 0, kBlocksAcross - 1);
  }

  const SampleSource& source_;
  PixelRect tile_;
  mutable std::array<std::uint32_t, kBlocksAcross * kBlocksAcross> rays_{};
};

/// A tile on its way through the steps.
struct Tile {
  std::shared_ptr<BlockCounter> counter;
  CastView view;
  std::unique_ptr<TileRefinement> refinement;
};

CountedStep advance(Tile& tile, std::uint32_t id, Step to) {
  const Step from{static_cast<std::uint16_t>(to.value - 1)};
  std::optional<RefinedTile> refined;
  const double us = thread_us_of([&] {
    refined = refine_tile(tile.view, {{}, {id}, from, to}, std::move(tile.refinement),
                          [] { return false; });
  });
  tile.refinement = std::move(refined->tile);
  return {double(refined->counts.rays),
          double(refined->counts.samples),
          double(refined->samples.packed.size()),
          refined->quality.squared_error,
          us,
          tile.counter->take_rays()};
}

/// Field evaluations of a ray, block by block, in a ray through each pixel's centre.
std::vector<double> samples_per_ray(const SampleSource& source, ImageSize size, int threads) {
  const TileGrid blocks = TileGrid::squares(size, kBlockPixels);
  std::vector<double> result(blocks.count());
  in_parallel(threads, blocks.count(), [&](std::size_t i) {
    const PixelRect rect = blocks.rect({static_cast<std::uint32_t>(i)});
    std::vector<PixelPosition> positions;
    for (const SampleOffset place : grid_places({rect.width, rect.height}, 1))
      positions.push_back(position_of(rect, place));
    std::vector<Sample> samples(positions.size());
    result[i] = double(source.cast(positions, samples).samples) / double(positions.size());
  });
  return result;
}

bool is_last(const Casting& casting, const CountedView& view) {
  if (casting.update != Update::kAll) return true;
  TileQuality quality;
  std::uint64_t rays = 0;
  for (const CountedStep& tile : view.steps.back()) {
    quality.squared_error += tile.squared_error;
    rays += static_cast<std::uint64_t>(tile.rays);
  }
  const double pixels = double(view.grid.image.width) * view.grid.image.height;
  const Step step{static_cast<std::uint16_t>(view.steps.size())};
  return is_enough(casting.stop, step, quality, rays, pixels);
}

}  // namespace

CountedView count_view(const SampleSource& source, const ImageSettings& image,
                       const Casting& casting, int threads) {
  CountedView counted{
      TileGrid::squares(image.size, kTile), {}, samples_per_ray(source, image.size, threads)};
  std::vector<Tile> tiles(counted.grid.count());
  for (std::uint32_t id = 0; id < tiles.size(); ++id) {
    tiles[id].counter = std::make_shared<BlockCounter>(source, counted.grid.rect({id}));
    tiles[id].view = {{},
                      counted.grid,
                      refinement_of(casting.stop),
                      appearance_of(image.background, image.color_space),
                      tiles[id].counter,
                      casting.update,
                      0};
  }
  do {
    std::vector<CountedStep>& step = counted.steps.emplace_back(tiles.size());
    const Step to{static_cast<std::uint16_t>(counted.steps.size())};
    in_parallel(threads, tiles.size(), [&](std::size_t i) {
      step[i] = advance(tiles[i], static_cast<std::uint32_t>(i), to);
    });
  } while (!is_last(casting, counted));
  return counted;
}

std::vector<LinearFit> fit_steps(const CountedView& view) {
  std::vector<LinearFit> prices;
  for (const std::vector<CountedStep>& step : view.steps) {
    std::vector<TimedTerms> terms;
    terms.reserve(step.size());
    for (const CountedStep& tile : step)
      terms.push_back({{tile.rays, tile.samples}, tile.thread_us});
    LinearFit price = fit_linear(terms);
    // All tiles together cost what they did.
    double model = 0, measured = 0;
    for (const TimedTerms& each : terms) {
      model += price.at(each.x[0], each.x[1]);
      measured += each.time;
    }
    if (model > 0) {
      price.first *= measured / model;
      price.second *= measured / model;
    }
    prices.push_back(price);
  }
  return prices;
}

CostRecord cost_record(const CountedView& view, const std::vector<LinearFit>& prices) {
  CostRecord image;
  image.columns = view.grid.columns() * kBlocksAcross;
  image.rows = view.grid.rows() * kBlocksAcross;
  for (std::size_t s = 0; s < view.steps.size(); ++s) {
    std::vector<StepCost>& blocks = image.steps.emplace_back(view.samples_per_ray.size());
    for (std::uint32_t id = 0; id < view.steps[s].size(); ++id) {
      const CountedStep& tile = view.steps[s][id];
      const double us = prices[s].at(tile.rays, tile.samples);
      const auto place = [&](std::size_t i) {
        const int column = int(id) % view.grid.columns() * kBlocksAcross + int(i) % kBlocksAcross;
        const int row = int(id) / view.grid.columns() * kBlocksAcross + int(i) / kBlocksAcross;
        return std::size_t(row) * std::size_t(image.columns) + std::size_t(column);
      };
      // The tile's cost is shared by what its blocks' rays would cost one by one.
      std::vector<double> share(tile.block_rays.size());
      double all = 0;
      for (std::size_t i = 0; i < share.size(); ++i) {
        const double rays = tile.block_rays[i];
        share[i] = prices[s].at(rays, rays * view.samples_per_ray[place(i)]);
        all += share[i];
      }
      for (std::size_t i = 0; i < share.size(); ++i) {
        const double even = 1.0 / double(share.size());
        blocks[place(i)] = {
            all > 0 ? us * share[i] / all : us * even,
            tile.rays > 0 ? tile.bytes * tile.block_rays[i] / tile.rays : tile.bytes * even,
            tile.squared_error * even};
      }
    }
  }
  return image;
}

}  // namespace goldthread::bench
