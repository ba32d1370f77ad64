// SPDX-License-Identifier: Apache-2.0
#pragma once
// What a worker knows of a tile while it refines it: a place for each pixel and for the replicated
// column and row at or beyond the right and lower edges. A place is known by a ray, or filled from
// those around it as the compositor will fill it: a midpoint of an edge is the mean of its ends, a
// centre the mean of the four midpoints. Colours here are as displayed, over the background, in
// 0 … 1, for differences and errors are judged as users see them.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "common/base/types.h"
#include "common/scene/scene.h"
#include "common/tile/sample.h"
#include "common/tile/tile_grid.h"

namespace goldthread {

/// Red, green and blue as displayed; the fourth number is 0, so that it fits a register.
struct alignas(16) Shown {
  std::array<float, 4> value{};
};

inline Shown midpoint(const Shown& a, const Shown& b) {
  Shown m;
  for (std::size_t c = 0; c < 4; ++c) m.value[c] = 0.5F * (a.value[c] + b.value[c]);
  return m;
}

/// The largest difference of a channel.
inline float distance(const Shown& a, const Shown& b) {
  float most = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const float d = a.value[c] - b.value[c];
    most = d > most ? d : -d > most ? -d : most;
  }
  return most;
}

/// Mean over the channels of the squared difference.
inline double squared_distance(const Shown& a, const Shown& b) {
  float sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const float d = a.value[c] - b.value[c];
    sum += d * d;
  }
  return double(sum) / 3;
}

/// How samples become what is displayed.
struct Appearance {
  glm::dvec3 background{0};
  ColorSpace color_space = ColorSpace::kDisplay;
};
Shown shown(const Sample& sample, const Appearance& appearance);

class TilePlane {
 public:
  /// The coarsest spacing is 16 pixels: that grid must be known before anything is filled.
  TilePlane(ImageSize tile, const Appearance& appearance, bool with_surfaces);

  ImageSize tile() const { return tile_; }
  std::size_t bytes() const {
    return state_.size() * (sizeof(Sample) + sizeof(Shown) + 1) + 4 * surfaces_.size();
  }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(x);
  }
  bool is_pixel(int x, int y) const { return x < tile_.width && y < tile_.height; }
  bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < columns_ && y < rows_; }

  bool known(int x, int y) const { return state_[index(x, y)] == kKnown; }
  bool wanted(int x, int y) const { return state_[index(x, y)] == kWanted; }
  /// From now until put() the place is wanted. False if it was already, or is known.
  bool mark_wanted(int x, int y) {
    std::uint8_t& state = state_[index(x, y)];
    if (state >= kWanted) return false;
    state = kWanted;
    return true;
  }
  void put(int x, int y, const Sample& sample, std::uint32_t surfaces);
  const Sample& sample(int x, int y) const { return samples_[index(x, y)]; }

  /// Known or filled.
  const Shown& at(int x, int y) {
    const std::size_t i = index(x, y);
    return state_[i] >= current_ ? shown_[i] : fill(x, y);
  }
  /// What a place without a ray is filled with, also while it is wanted.
  Shown filled_at(int x, int y);
  /// The surfaces that the ray met, or would have met by those around it.
  std::uint32_t surfaces_at(int x, int y);
  bool with_surfaces() const { return !surfaces_.empty(); }

  /// Pixels of the tile in the block of kCoarsestSpacing² with its corner at (x, y).
  int pixels_of_block(int x, int y) const;

  /// What was filled before may have changed since: it is filled anew when it is asked for.
  void forget_filled();

 private:
  static constexpr std::uint8_t kKnown = 255;
  static constexpr std::uint8_t kWanted = 254;
  const Shown& fill(int x, int y) {
    const std::size_t i = index(x, y);
    shown_[i] = filled_at(x, y);
    state_[i] = current_;
    return shown_[i];
  }

  ImageSize tile_;
  int columns_;
  int rows_;
  Appearance appearance_;
  std::vector<Sample> samples_;
  std::vector<Shown> shown_;
  std::vector<std::uint32_t> surfaces_;
  /// kKnown, kWanted, or in which round the place was filled last; 0: never.
  std::vector<std::uint8_t> state_;
  std::uint8_t current_ = 1;
};

}  // namespace goldthread
