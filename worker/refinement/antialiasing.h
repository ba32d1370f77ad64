// SPDX-License-Identifier: Apache-2.0
#pragma once
// Below the pixel: which pixels get samples of their own beyond the one in their centre, and how
// large the error of all pixels with rays still is. A pixel whose centre bends away from its
// neighbours has an edge in it, or may have; one whose variance says that it is still worth it gets
// twice as many samples. How much of its second difference a centre sample is off by is learned
// from the pixels that have been sampled further.

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "worker/refinement/pixel_sums.h"
#include "worker/refinement/step_plan.h"
#include "worker/refinement/subdivision.h"

namespace goldthread {

/// More samples for a pixel: those with the numbers [first, last).
struct PixelOrder {
  SampleOffset place;
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

/// A pixel beyond the left or upper edge of a tile: x = −1 or y = −1, not both.
struct ApronPixel {
  int x = 0;
  int y = 0;
};

/// The pixels just beyond the left and upper edge: second differences at the tile's edge need them.
class Apron {
 public:
  void restart(ImageSize tile) {
    tile_ = tile;
    left_.assign(static_cast<std::size_t>(tile.height), {});
    above_.assign(static_cast<std::size_t>(tile.width), {});
  }
  ImageSize tile() const { return tile_; }
  std::optional<Shown>& at(ApronPixel pixel) {
    return pixel.x < 0 ? left_[static_cast<std::size_t>(pixel.y)]
                       : above_[static_cast<std::size_t>(pixel.x)];
  }

 private:
  ImageSize tile_;
  std::vector<std::optional<Shown>> left_;
  std::vector<std::optional<Shown>> above_;
};

class Antialiasing {
 public:
  /// For a tile of which nothing is known.
  void restart(ImageSize tile);

  /// The pixels next to `squares` (of spacing 2) that lie in the apron and are not known yet.
  std::vector<ApronPixel> wanted_apron(std::span<const Square> squares);
  void put_apron(ApronPixel pixel, const Shown& shown) { apron_.at(pixel) = shown; }

  /// What the pixels of `squares` (of spacing 2), and those with samples of their own, are to get.
  /// Centres that are wanted too are part of the order.
  std::vector<PixelOrder> choose(TileLattice& lattice, std::span<const Square> squares,
                                 const StepPlan& plan, std::uint32_t most);
  /// All pixels get `count` samples; those of `squares` are all.
  std::vector<PixelOrder> choose_all(TileLattice& lattice, std::span<const Square> squares,
                                     std::uint32_t count);
  /// The samples of one order, in the order of their numbers, and the surfaces of the first.
  void add(TileLattice& lattice, const PixelOrder& order, std::span<const Sample> samples,
           std::uint32_t surfaces, const Appearance& appearance);

  /// The sum over the pixels with several samples, and those of the squares last chosen from with
  /// one.
  double squared_error() const;

  const PixelSum* find(SampleOffset place) const;
  std::size_t bytes() const {
    return sums_.size() * sizeof(PixelSum) + number_of_.size() * sizeof(std::uint32_t);
  }

 private:
  std::size_t index(SampleOffset place) const {
    return std::size_t(place.y) * std::size_t(apron_.tile().width) + place.x;
  }
  double squared_bend(TileLattice& lattice, int x, int y);
  void learn(const PixelSum& sum);
  /// The squared share of its bend that a centre is off by, as learned so far.
  double squared_share() const { return std::max(0.0, learned_) / learned_from_; }

  Apron apron_;
  std::vector<PixelSum> sums_;
  /// Of each pixel, row by row: the number of its sum, from 1, or 0. Empty while there are none.
  std::vector<std::uint32_t> number_of_;
  double squared_bends_ = 0;  ///< of the pixels with one sample, when they were last looked at
  double learned_ = 0;        ///< squared shares, of so many pixels
  double learned_from_ = 1;
};

}  // namespace goldthread
