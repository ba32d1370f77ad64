// SPDX-License-Identifier: Apache-2.0
#include "worker/refinement/probes.h"

#include <algorithm>

namespace goldthread {
namespace {

constexpr int kEdge = kCoarsestSpacing;
constexpr std::uint32_t kPlaces = kEdge * kEdge;

int blocks_along(int extent) { return (extent + kEdge - 1) / kEdge; }

/// Place `number` of a block in an order in which each prefix is spread out: the first 4^k places
/// hold one in each square of 16/2^k. Starts anywhere in it.
SampleOffset place_in_block(std::uint32_t number) {
  unsigned x = 0, y = 0;
  // The lowest pair of bits decides the quarter, the next one the quarter of it, and so on; x ^ y
  // for the diagonal first.
  for (unsigned bit = 0; bit < 4; ++bit) {
    const unsigned quarter = (number >> (2 * bit)) & 3U;
    const unsigned right = (quarter ^ (quarter >> 1)) & 1U;
    const unsigned low = quarter & 1U;
    x |= right << (3 - bit);
    y |= low << (3 - bit);
  }
  return {static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)};
}

std::uint32_t start_of(std::uint32_t seed, std::uint32_t block) {
  std::uint32_t h = (seed * 0x9E3779B1U) ^ (block * 0x85EBCA77U);
  h = (h ^ (h >> 15)) * 0x846CA68BU;
  return h >> 24;
}

}  // namespace

void Probes::restart(ImageSize tile, std::uint32_t seed) {
  columns_ = blocks_along(tile.width);
  blocks_.clear();
  const int rows = blocks_along(tile.height);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns_; ++column) {
      Block block;
      block.x = column * kEdge;
      block.y = row * kEdge;
      block.offset = start_of(seed, static_cast<std::uint32_t>(blocks_.size()));
      blocks_.push_back(block);
    }
}

std::vector<SampleOffset> Probes::next(const TileLattice& lattice, int count) {
  std::vector<SampleOffset> places;
  for (Block& block : blocks_) {
    block.looked = 0;
    block.mean_squared = 0;
    const std::uint32_t end = std::min(kPlaces, block.taken + static_cast<std::uint32_t>(count));
    for (; block.taken < end; ++block.taken) {
      // An offset by exclusive or keeps every prefix spread out.
      const SampleOffset inner = place_in_block(block.taken ^ block.offset);
      const int x = block.x + inner.x, y = block.y + inner.y;
      if (!lattice.is_pixel(x, y)) continue;
      ++block.looked;
      if (!lattice.known(x, y))
        places.push_back({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)});
    }
  }
  return places;
}

void Probes::note(SampleOffset place, double squared, bool surprising) {
  Block& block = blocks_[static_cast<std::size_t>((place.y / kEdge) * columns_ + place.x / kEdge)];
  const std::uint32_t looked = surprising ? block.taken : static_cast<std::uint32_t>(block.looked);
  block.mean_squared += squared / looked;
}

double Probes::squared_error(const TileLattice& lattice) const {
  double sum = 0;
  for (const Block& block : blocks_)
    sum += block.mean_squared * lattice.pixels_of_block(block.x, block.y);
  return sum;
}

}  // namespace goldthread
