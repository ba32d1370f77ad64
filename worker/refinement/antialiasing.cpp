// SPDX-License-Identifier: Apache-2.0
#include "worker/refinement/antialiasing.h"

#include <algorithm>
#include <cmath>

namespace goldthread {
namespace {

/// Before anything is learned: a centre sample is off by this share of its bend, as sure as if so
/// many pixels had said so.
constexpr double kFirstShare = 0.08;
constexpr double kFirstPixels = 3;
/// The samples that a pixel gets first, beyond the one in its centre.
constexpr std::uint32_t kFirstSamples = 4;

/// The second difference of three pixels in a row.
ShownLanes bend_between(ShownLanes before, ShownLanes at, ShownLanes after) {
  return distance(before + after, at + at);
}

/// Calls what(x, y) for the pixels of each square.
template <class What>
void for_pixels(const TileLattice& lattice, std::span<const Square> squares, const What& what) {
  for (const Square square : squares)
    for (int y = square.y; y < square.y + 2; ++y)
      for (int x = square.x; x < square.x + 2; ++x)
        if (lattice.is_pixel(x, y)) what(x, y);
}

}  // namespace

void Antialiasing::restart(ImageSize tile) {
  apron_.restart(tile);
  sums_.clear();
  number_of_.clear();
  squared_bends_ = 0;
  learned_ = kFirstShare * kFirstShare * kFirstPixels;
  learned_from_ = kFirstPixels;
}

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

double Antialiasing::squared_bend(TileLattice& lattice, int x, int y) {
  const ShownLanes centre = lattice.at(x, y);
  const auto before = [&](ApronPixel apron, int bx, int by) {
    if (bx >= 0 && by >= 0) return lattice.at(bx, by);
    const auto& known = apron_.at(apron);
    return known ? known->lanes() : centre;
  };
  const double bend = double(
      greatest(greater_of(bend_between(before({-1, y}, x - 1, y), centre, lattice.at(x + 1, y)),
                          bend_between(before({x, -1}, x, y - 1), centre, lattice.at(x, y + 1)))));
  return bend * bend;
}

std::vector<PixelOrder> Antialiasing::choose(TileLattice& lattice, std::span<const Square> squares,
                                             const StepPlan& plan, std::uint32_t most) {
  std::vector<PixelOrder> orders;
  const PixelErrorModel model(squared_share());
  for (const PixelSum& sum : sums_) {
    const std::uint32_t more = sum.count() - 1;
    if (sum.count() + more <= most && sum.squared_error(model) >= plan.worth * more)
      orders.push_back({sum.place(), sum.count(), sum.count() + more});
  }
  squared_bends_ = 0;
  const double edge = double(plan.edge) * double(plan.edge);
  for_pixels(lattice, squares, [&](int x, int y) {
    if (lattice.sampled_further(x, y)) return;
    const double bend = squared_bend(lattice, x, y);
    if (bend <= edge || most <= kFirstSamples) {
      squared_bends_ += bend;
      return;
    }
    const SampleOffset place{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)};
    orders.push_back({place, lattice.known(x, y) ? 1U : 0U, 1 + kFirstSamples});
  });
  return orders;
}

std::vector<PixelOrder> Antialiasing::choose_all(TileLattice& lattice,
                                                 std::span<const Square> squares,
                                                 std::uint32_t count) {
  std::vector<PixelOrder> orders;
  squared_bends_ = 0;
  for_pixels(lattice, squares, [&](int x, int y) {
    const SampleOffset place{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)};
    const PixelSum* sum = lattice.sampled_further(x, y) ? find(place) : nullptr;
    const std::uint32_t held = sum != nullptr ? sum->count() : 1;
    if (held < count) orders.push_back({place, held, count});
    if (count == 1) squared_bends_ += squared_bend(lattice, x, y);
  });
  return orders;
}

void Antialiasing::add(TileLattice& lattice, const PixelOrder& order,
                       std::span<const Sample> samples, std::uint32_t surfaces,
                       const Appearance& appearance) {
  const int x = order.place.x, y = order.place.y;
  if (number_of_.empty()) {
    const ImageSize tile = apron_.tile();
    number_of_.resize(std::size_t(tile.width) * std::size_t(tile.height));
  }
  std::uint32_t& number = number_of_[index(order.place)];
  const bool is_new = number == 0;
  if (is_new) {
    const Sample& first = order.first == 0 ? samples[0] : lattice.sample(x, y);
    sums_.emplace_back(order.place, std::sqrt(squared_bend(lattice, x, y)), first,
                       shown(first, appearance));
    number = static_cast<std::uint32_t>(sums_.size());
    if (order.first == 0) samples = samples.subspan(1);
  }
  PixelSum& sum = sums_[number - 1];
  for (const Sample& sample : samples) sum.add(sample, shown(sample, appearance));
  if (is_new) learn(sum);
  const bool centre_was_known = lattice.with_surfaces() && lattice.known(x, y);
  lattice.put_mean(x, y, sum.mean(), centre_was_known ? lattice.surfaces_at(x, y) : surfaces);
}

void Antialiasing::learn(const PixelSum& sum) {
  const double bend = sum.bend() * sum.bend();
  if (sum.count() < 3 || !(bend > 0)) return;
  // The others' mean has an error of its own, which is not the centre's.
  const double off = squared_distance(sum.centre().lanes(), sum.mean_of_others().lanes()) -
                     sum.squared_error(PixelErrorModel(squared_share()));
  learned_ += std::clamp(off / bend, -1.0, 1.0);
  learned_from_ += 1;
}

double Antialiasing::squared_error() const {
  const PixelErrorModel model(squared_share());
  double sum = squared_bends_ * squared_share();
  for (const PixelSum& pixel : sums_) sum += pixel.squared_error(model);
  return sum;
}

const PixelSum* Antialiasing::find(SampleOffset place) const {
  const std::uint32_t number = number_of_.empty() ? 0 : number_of_[index(place)];
  return number == 0 ? nullptr : &sums_[number - 1];
}

}  // namespace goldthread
