// SPDX-License-Identifier: Apache-2.0
#include "bench/kernels/ray_lists.h"

#include <algorithm>
#include <random>

namespace goldthread::bench {
namespace {

constexpr int kCoarsestSpacing = 8;
constexpr double kThreshold = 24.0 / 255;

std::uint32_t spread(std::uint32_t v) {
  v = (v | v << 8) & 0x00FF00FFU;
  v = (v | v << 4) & 0x0F0F0F0FU;
  v = (v | v << 2) & 0x33333333U;
  return (v | v << 1) & 0x55555555U;
}

class Subdivision {
 public:
  Subdivision(ImageSize image, const std::vector<Color>& picture)
      : image_(image), picture_(picture), has_sample_(picture.size()) {
    for (int y = 0; y <= image_.height; y += kCoarsestSpacing)
      for (int x = 0; x <= image_.width; x += kCoarsestSpacing) has_sample_[index(x, y)] = true;
  }

  /// Divides what differs at `spacing`; the lists of what is new.
  std::vector<RayList> divide(int spacing) {
    std::vector<bool> is_new(picture_.size());
    for (int y = 0; y < image_.height; y += spacing)
      for (int x = 0; x < image_.width; x += spacing)
        if (differs(x, y, spacing)) divide(x, y, spacing / 2, is_new);
    for (std::size_t i = 0; i < is_new.size(); ++i) has_sample_[i] = has_sample_[i] || is_new[i];
    return lists_of(image_, Order::kCurve, [&](int x, int y) { return is_new[index(x, y)]; });
  }

 private:
  std::size_t index(int x, int y) const {
    return std::size_t(y) * std::size_t(image_.width + 1) + std::size_t(x);
  }

  /// False also where a corner is missing: the square was never reached.
  bool differs(int x, int y, int spacing) const {
    Color least(1e9), greatest(-1e9);
    for (const auto& [i, j] :
         {std::pair{x, y}, {x + spacing, y}, {x, y + spacing}, {x + spacing, y + spacing}}) {
      if (i > image_.width || j > image_.height || !has_sample_[index(i, j)]) return false;
      least = glm::min(least, picture_[index(i, j)]);
      greatest = glm::max(greatest, picture_[index(i, j)]);
    }
    return glm::any(glm::greaterThan(greatest - least, Color(kThreshold)));
  }

  void divide(int x, int y, int half, std::vector<bool>& is_new) const {
    for (int j = 0; j <= 2; ++j)
      for (int i = 0; i <= 2; ++i) {
        const std::size_t at = index(x + i * half, y + j * half);
        if (!has_sample_[at]) is_new[at] = true;
      }
  }

  ImageSize image_;
  const std::vector<Color>& picture_;
  std::vector<bool> has_sample_;
};

}  // namespace

std::uint32_t z_order(std::uint32_t x, std::uint32_t y) { return spread(x) | spread(y) << 1; }

std::vector<RayList> lists_of(ImageSize image, Order order,
                              const std::function<bool(int x, int y)>& wanted) {
  struct Place {
    std::uint32_t key;
    int x, y;
  };
  std::vector<RayList> lists;
  for (int top = 0; top < image.height; top += kTileEdge)
    for (int left = 0; left < image.width; left += kTileEdge) {
      std::vector<Place> places;
      for (int y = top; y < std::min(top + kTileEdge, image.height); ++y)
        for (int x = left; x < std::min(left + kTileEdge, image.width); ++x) {
          const auto i = std::uint32_t(x - left), j = std::uint32_t(y - top);
          const auto key = order == Order::kCurve ? z_order(i, j) : j * kTileEdge + i;
          if (wanted(x, y)) places.push_back({key, x, y});
        }
      if (places.empty()) continue;
      std::ranges::sort(places, {}, &Place::key);
      RayList list;
      for (const Place& place : places)
        list.push_back({float(place.x) + 0.5F, float(place.y) + 0.5F});
      lists.push_back(std::move(list));
    }
  return lists;
}

std::vector<RayList> random_lists(ImageSize image, Order order, double share) {
  std::mt19937 random(1);
  std::bernoulli_distribution chosen(share);
  return lists_of(image, order, [&](int, int) { return chosen(random); });
}

std::vector<RayList> subdivision_lists(ImageSize image, const std::vector<Color>& picture) {
  Subdivision subdivision(image, picture);
  std::vector<RayList> all;
  for (int spacing = kCoarsestSpacing; spacing > 1; spacing /= 2)
    for (RayList& list : subdivision.divide(spacing)) all.push_back(std::move(list));
  return all;
}

std::vector<RayList> batches(ImageSize image, std::size_t count) {
  std::vector<RayList> all;
  for (const RayList& tile : lists_of(image, Order::kCurve, [](int, int) { return true; }))
    for (std::size_t first = 0; first < tile.size(); first += count) {
      const std::size_t end = std::min(first + count, tile.size());
      all.emplace_back(tile.begin() + std::ptrdiff_t(first), tile.begin() + std::ptrdiff_t(end));
    }
  return all;
}

}  // namespace goldthread::bench
