// SPDX-License-Identifier: Apache-2.0
#include "worker/refinement/antialiasing.h"

#include <algorithm>
#include <cmath>

namespace goldthread {
namespace {

/// Before anything is learned: a centre sample is off by this share of its bend, as sure as if so
/// many pixels had said so.
constexpr double kFirstShare = 0.08;
constexpr double kFirstPixels = 8;
/// The samples that a pixel gets first, beyond the one in its centre.
constexpr std::uint32_t kFirstSamples = 4;

std::uint32_t key_of(SampleOffset place) { return (std::uint32_t(place.y) << 16) | place.x; }

double bend_between(const Shown& before, const Shown& at, const Shown& after) {
  double most = 0;
  for (std::size_t c = 0; c < 3; ++c)
    most = std::max(most, std::abs(double(before.value[c]) - 2 * double(at.value[c]) +
                                   double(after.value[c])));
  return most;
}

/// Calls what(x, y) for the pixels of each square.
template <class What>
void for_pixels(const TilePlane& plane, std::span<const Square> squares, const What& what) {
  for (const Square square : squares)
    for (int y = square.y; y < square.y + 2; ++y)
      for (int x = square.x; x < square.x + 2; ++x)
        if (plane.is_pixel(x, y)) what(x, y);
}

}  // namespace

Antialiasing::Antialiasing(ImageSize tile)
    : apron_(tile),
      learned_(kFirstShare * kFirstShare * kFirstPixels),
      learned_from_(kFirstPixels) {}

std::vector<ApronPixel> Antialiasing::wanted_apron(std::span<const Square> squares) {
  std::vector<ApronPixel> wanted;
  const auto want = [&](ApronPixel pixel) {
    if (!apron_.at(pixel)) wanted.push_back(pixel);
  };
  const ImageSize tile = apron_.tile();
  for (const Square square : squares)
    for (const int i : {0, 1}) {
      if (square.x == 0 && square.y + i < tile.height) want({-1, square.y + i});
      if (square.y == 0 && square.x + i < tile.width) want({square.x + i, -1});
    }
  return wanted;
}

double Antialiasing::bend_of(TilePlane& plane, int x, int y) {
  const Shown& centre = plane.at(x, y);
  const auto before = [&](ApronPixel apron, int bx, int by) -> const Shown& {
    if (bx >= 0 && by >= 0) return plane.at(bx, by);
    const auto& known = apron_.at(apron);
    return known ? *known : centre;
  };
  return std::max(bend_between(before({-1, y}, x - 1, y), centre, plane.at(x + 1, y)),
                  bend_between(before({x, -1}, x, y - 1), centre, plane.at(x, y + 1)));
}

std::vector<PixelOrder> Antialiasing::choose(TilePlane& plane, std::span<const Square> squares,
                                             const StepPlan& plan, std::uint32_t most) {
  std::vector<PixelOrder> orders;
  const double share = squared_share();
  for (const PixelSum& sum : sums_) {
    const std::uint32_t more = sum.count() - 1;
    if (sum.count() + more <= most && sum.squared_error(share) >= plan.worth * more)
      orders.push_back({sum.place(), sum.count(), sum.count() + more});
  }
  if (most <= kFirstSamples) return orders;
  for_pixels(plane, squares, [&](int x, int y) {
    const SampleOffset place{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)};
    if (find(place) != nullptr || bend_of(plane, x, y) <= double(plan.edge)) return;
    orders.push_back({place, plane.known(x, y) ? 1U : 0U, 1 + kFirstSamples});
  });
  return orders;
}

std::vector<PixelOrder> Antialiasing::choose_all(const TilePlane& plane,
                                                 std::uint32_t count) const {
  std::vector<PixelOrder> orders;
  for (const SampleOffset place : grid_places(plane.tile(), 1)) {
    const PixelSum* sum = find(place);
    const std::uint32_t held = sum != nullptr ? sum->count() : 1;
    if (held < count) orders.push_back({place, held, count});
  }
  return orders;
}

void Antialiasing::add(TilePlane& plane, const PixelOrder& order, std::span<const Sample> samples,
                       std::uint32_t surfaces, const Appearance& appearance) {
  const int x = order.place.x, y = order.place.y;
  auto found = place_of_.find(key_of(order.place));
  const bool is_new = found == place_of_.end();
  if (is_new) {
    const Sample& first = order.first == 0 ? samples[0] : plane.sample(x, y);
    found = place_of_.emplace(key_of(order.place), sums_.size()).first;
    sums_.emplace_back(order.place, bend_of(plane, x, y), first, shown(first, appearance));
    if (order.first == 0) samples = samples.subspan(1);
  }
  PixelSum& sum = sums_[found->second];
  for (const Sample& sample : samples) sum.add(sample, shown(sample, appearance));
  if (is_new) learn(sum);
  const bool centre_was_known = plane.with_surfaces() && plane.known(x, y);
  plane.put(x, y, sum.mean(), centre_was_known ? plane.surfaces_at(x, y) : surfaces);
}

void Antialiasing::learn(const PixelSum& sum) {
  if (sum.count() < 3) return;
  // The others' mean has an error of its own, which is not the centre's.
  const double off = squared_distance(sum.centre(), sum.mean_of_others()) - sum.squared_error(0);
  learned_ += std::min(1.0, off / (sum.bend() * sum.bend()));
  learned_from_ += 1;
}

double Antialiasing::squared_error(TilePlane& plane, std::span<const Square> squares) {
  const double share = squared_share();
  double of_sums = 0;
  for (const PixelSum& sum : sums_) of_sums += sum.squared_error(share);
  double bends = 0;
  for_pixels(plane, squares, [&](int x, int y) {
    if (find({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)}) != nullptr) return;
    const double bend = bend_of(plane, x, y);
    bends += bend * bend;
  });
  return of_sums + bends * share;
}

const PixelSum* Antialiasing::find(SampleOffset place) const {
  const auto found = place_of_.find(key_of(place));
  return found == place_of_.end() ? nullptr : &sums_[found->second];
}

}  // namespace goldthread
