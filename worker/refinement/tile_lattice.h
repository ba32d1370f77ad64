// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a worker knows of a tile while it refines it: a place for each pixel and for the replicated
// column and row at or beyond the right and lower edges. A place is known by a ray, or filled from
// those around it as the compositor will fill it: a midpoint of an edge is the mean of its ends, a
// centre the mean of the four midpoints. Made anew for each view, from the same memory.

#include <array>
#include <bit>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "common/base/types.h"
#include "common/scene/scene.h"
#include "common/tile/sample.h"
#include "common/tile/tile_grid.h"
#include "worker/refinement/shown.h"

namespace goldthread {

/// How samples become what is displayed.
struct Appearance {
  Shown behind;  ///< the background, in the scene's colour space
  ColorSpace color_space = ColorSpace::kDisplay;
};
Appearance appearance_of(const glm::dvec3& background, ColorSpace color_space);
Shown shown(const Sample& sample, const Appearance& appearance);

class TileLattice {
 public:
  /// Nothing is known. The coarsest spacing is 16 pixels: that grid must be before anything is
  /// filled.
  void restart(ImageSize tile, const Appearance& appearance, bool with_surfaces);

  ImageSize tile() const { return tile_; }
  std::size_t bytes() const {
    return state_.size() * (sizeof(Sample) + sizeof(Shown) + 1) + 4 * surfaces_.size();
  }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  bool is_pixel(int x, int y) const { return x < tile_.width && y < tile_.height; }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < columns_ && y < rows_; }

  bool known(int x, int y) const { return state_[index(x, y)] >= kKnown; }
  /// By more than one ray.
  bool sampled_further(int x, int y) const { return state_[index(x, y)] == kSampledFurther; }
  bool filled(int x, int y) const { return state_[index(x, y)] == current_; }
  bool wanted(int x, int y) const { return state_[index(x, y)] == kWanted; }
  /// From now until put() the place is wanted. False if it was already, or is known.
  bool mark_wanted(int x, int y) {
    std::uint8_t& state = state_[index(x, y)];
    if (state >= kWanted) return false;
    state = kWanted;
    return true;
  }
  void put(int x, int y, const Sample& sample, std::uint32_t surfaces);
  /// The mean of several; the surfaces are those of the first.
  void put_mean(int x, int y, const Sample& mean, std::uint32_t surfaces);
  const Sample& sample(int x, int y) const { return samples_[index(x, y)]; }

  /// Known or filled.
  ShownLanes at(int x, int y) {
    const std::size_t i = index(x, y);
    return state_[i] >= current_ ? shown_[i].lanes() : fill(x, y);
  }
  /// What a place without a ray is filled with, also while it is wanted.
  ShownLanes filled_at(int x, int y);
  /// The surfaces that the ray met, or would have met by those around it.
  std::uint32_t surfaces_at(int x, int y);
  bool with_surfaces() const { return !surfaces_.empty(); }

  /// Pixels of the tile in the block of kCoarsestSpacing² with its corner at (x, y).
  int pixels_of_block(int x, int y) const;

  /// What was filled before may have changed since: it is filled anew when it is asked for.
  void forget_filled();

 private:
  /// Places lie together by the spacing of the coarsest grid they belong to, coarse ones first: a
  /// tile of which little is known touches little memory.
  std::size_t index(int x, int y) const {
    const int level = std::countr_zero(static_cast<unsigned>(x | y | kCoarsestSpacing));
    const Level& grid = levels_[static_cast<std::size_t>(level)];
    return grid.first + static_cast<std::size_t>(y >> level) * grid.columns +
           static_cast<std::size_t>(x >> level);
  }

  static constexpr std::uint8_t kSampledFurther = 255;
  static constexpr std::uint8_t kKnown = 254;
  static constexpr std::uint8_t kWanted = 253;
  ShownLanes fill(int x, int y) {
    const std::size_t i = index(x, y);
    shown_[i] = Shown::of(filled_at(x, y));
    state_[i] = current_;
    return shown_[i].lanes();
  }

  struct Level {
    std::size_t first = 0;
    std::size_t columns = 0;
  };

  ImageSize tile_;
  std::array<Level, 5> levels_;  ///< by the binary logarithm of the spacing
  int columns_ = 0;
  int rows_ = 0;
  Appearance appearance_;
  // Left as they are until they are known or filled: most of a tile never is.
  std::size_t room_ = 0;
  std::unique_ptr<Sample[]> samples_;
  std::unique_ptr<Shown[]> shown_;
  std::vector<std::uint32_t> surfaces_;
  /// One of the above, or in which round the place was filled last; 0: never.
  std::vector<std::uint8_t> state_;
  std::uint8_t current_ = 1;
};

}  // namespace goldthread
