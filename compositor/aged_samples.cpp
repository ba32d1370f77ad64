// SPDX-License-Identifier: Apache-2.0
#include "compositor/aged_samples.h"

#include <algorithm>
#include <cmath>

#include "common/tile/update_pattern.h"

namespace goldthread {
namespace {

struct WeightedSum {
  Sample sum;
  float weight = 0;

  void add(const Sample& sample, float w) {
    sum.red += w * sample.red;
    sum.green += w * sample.green;
    sum.blue += w * sample.blue;
    sum.alpha += w * sample.alpha;
    weight += w;
  }
  Sample mean() const {
    if (weight == 0) return {};
    return {sum.red / weight, sum.green / weight, sum.blue / weight, sum.alpha / weight};
  }
};

/// A sample less than a pixel away from a pixel's centre: which one of a block how far away, and
/// the tent's weight. The same for that pixel of every block.
struct Neighbour {
  int block_x = 0;  ///< −1 … 1
  int block_y = 0;
  std::uint32_t number = 0;
  float weight = 0;
};
using Neighbours = std::vector<Neighbour>;

Neighbours neighbours_of(int x, int y) {
  Neighbours result;
  const auto& pattern = frameless_pattern();
  for (int block_y = -1; block_y <= 1; ++block_y)
    for (int block_x = -1; block_x <= 1; ++block_x)
      for (std::uint32_t number = 0; number < kFramelessSamples; ++number) {
        const double dx = block_x * kFramelessBlock + double(pattern[number].x) - (x + 0.5);
        const double dy = block_y * kFramelessBlock + double(pattern[number].y) - (y + 0.5);
        if (std::abs(dx) >= 1 || std::abs(dy) >= 1) continue;
        const double weight = (1 - std::abs(dx)) * (1 - std::abs(dy));
        result.push_back({block_x, block_y, number, static_cast<float>(weight)});
      }
  return result;
}

/// Row by row for the pixels of a block.
const std::vector<Neighbours>& neighbour_table() {
  static const std::vector<Neighbours> table = [] {
    std::vector<Neighbours> all;
    for (int y = 0; y < kFramelessBlock; ++y)
      for (int x = 0; x < kFramelessBlock; ++x) all.push_back(neighbours_of(x, y));
    return all;
  }();
  return table;
}

}  // namespace

double fading(double moved_px) {
  const double square = 4 * moved_px * moved_px;
  return 1 / (1 + square * square);
}

AgedSamples::AgedSamples(PixelRect rect, Update update)
    : rect_(rect),
      update_(update),
      samples_(update_places(rect, update)),
      views_(parts_of(update)),
      places_(views_.size()) {}

bool AgedSamples::put(Epoch view, std::uint32_t part, std::span<const Sample> samples) {
  if (part >= views_.size()) return false;
  std::vector<std::uint32_t>& places = places_[part];
  if (places.empty())
    for (const UpdatePlace& place : places_of(rect_, update_, part)) places.push_back(place.index);
  if (places.size() != samples.size()) return false;
  for (std::size_t i = 0; i < places.size(); ++i) samples_[places[i]] = samples[i];
  views_[part] = view;
  return true;
}

bool AgedSamples::any() const {
  return std::any_of(views_.begin(), views_.end(),
                     [](const auto& view) { return view.has_value(); });
}

std::vector<Sample> AgedSamples::picture(const Movement& moved_px) const {
  return update_ == Update::kFrameless ? weighted(moved_px) : pixels();
}

std::vector<Sample> AgedSamples::pixels() const {
  std::vector<Sample> result = samples_;
  if (std::all_of(views_.begin(), views_.end(), [](const auto& view) { return view.has_value(); }))
    return result;
  for (int y = 0; y < rect_.height; ++y)
    for (int x = 0; x < rect_.width; ++x)
      result[std::size_t(y * rect_.width + x)] = nearest_known(x, y);
  return result;
}

Sample AgedSamples::nearest_known(int x, int y) const {
  WeightedSum sum;
  for (int radius = 0; sum.weight == 0 && radius <= kFramelessBlock; ++radius)
    for (int v = std::max(y - radius, 0); v <= std::min(y + radius, rect_.height - 1); ++v)
      for (int u = std::max(x - radius, 0); u <= std::min(x + radius, rect_.width - 1); ++u) {
        const auto index = static_cast<std::uint32_t>(v * rect_.width + u);
        if (views_[part_of(rect_, update_, index)]) sum.add(samples_[index], 1);
      }
  return sum.mean();
}

std::vector<float> AgedSamples::weights(const Movement& moved_px) const {
  std::vector<float> weights(samples_.size(), 0);
  for (std::uint32_t part = 0; part < views_.size(); ++part) {
    if (!views_[part]) continue;
    const auto weight = static_cast<float>(fading(moved_px(*views_[part])));
    for (const std::uint32_t place : places_[part]) weights[place] = weight;
  }
  return weights;
}

std::vector<Sample> AgedSamples::weighted(const Movement& moved_px) const {
  const std::vector<float> fade = weights(moved_px);
  const int across = blocks_across(rect_.width), down = blocks_across(rect_.height);
  std::vector<Sample> result;
  result.reserve(std::size_t(rect_.width) * std::size_t(rect_.height));
  for (int y = 0; y < rect_.height; ++y)
    for (int x = 0; x < rect_.width; ++x) {
      WeightedSum sum;
      const int block_x = x / kFramelessBlock, block_y = y / kFramelessBlock;
      const int in_block = y % kFramelessBlock * kFramelessBlock + x % kFramelessBlock;
      for (const Neighbour& neighbour : neighbour_table()[std::size_t(in_block)]) {
        const int u = block_x + neighbour.block_x, v = block_y + neighbour.block_y;
        if (u < 0 || v < 0 || u >= across || v >= down) continue;
        const std::size_t i = std::size_t(v * across + u) * kFramelessSamples + neighbour.number;
        sum.add(samples_[i], fade[i] * neighbour.weight);
      }
      if (sum.weight == 0) {
        const std::size_t first = std::size_t(block_y * across + block_x) * kFramelessSamples;
        for (std::size_t i = first; i < first + kFramelessSamples; ++i)
          sum.add(samples_[i], fade[i]);
      }
      result.push_back(sum.mean());
    }
  return result;
}

}  // namespace goldthread
