// SPDX-License-Identifier: Apache-2.0
#pragma once
// One picture by adaptive refinement alone, without ranks and messages: all tiles are taken from
// step to step until the picture is good enough, then what no ray was cast for is filled in, as a
// compositor does. Threads and memory stay from picture to picture.

#include <functional>
#include <memory>
#include <vector>

#include "bench/error/crew.h"
#include "bench/error/statistics.h"
#include "common/scene/scene.h"
#include "common/tile/tile_grid.h"
#include "worker/refinement/tile_refinement.h"
#include "worker/sample_source.h"

namespace goldthread::bench {

/// What a picture came to.
struct Refined {
  Step step = kNoStep;
  TileQuality quality;
  std::uint64_t rays = 0;
};

class AdaptiveCaster {
 public:
  /// Whether no further step is needed.
  using Enough = std::function<bool(const Refined& so_far)>;

  AdaptiveCaster(ImageSize size, int threads, int tile_px);

  /// From nothing to float pixels, which are kept until the next call.
  Refined cast(const SampleSource& source, const ImageSettings& image, const Refinement& how,
               const Enough& enough);
  /// What the last cast shows at pixels (x, y) with x and y multiples of `stride`, row by row.
  std::vector<Color> shown(const ImageSettings& image, int stride) const;
  ImageSize size() const { return grid_.image; }
  Crew& crew() { return crew_; }

 private:
  /// A tile as its worker refines it, and as its compositor holds it.
  struct Tile {
    PixelRect rect;
    std::unique_ptr<TileRefinement> refinement;
    std::uint64_t rays = 0;
    std::uint64_t last_rays = 0;  ///< of the last step
    int stride = 0;
    std::vector<Sample> samples;
    std::vector<std::uint8_t> known;
  };

  void restart(Tile& tile, const TileTask& task);
  void advance(Tile& tile, const SampleSource& source);
  void reconstruct(Tile& tile, const Sample& behind);
  Refined sum(Step step) const;
  /// Those that took most rays first: what is begun last should be short.
  void sort_by_rays();

  TileGrid grid_;
  std::vector<Tile> tiles_;
  std::vector<std::size_t> order_;
  std::vector<Sample> pixels_;  ///< over the background
  Crew crew_;
};

}  // namespace goldthread::bench
