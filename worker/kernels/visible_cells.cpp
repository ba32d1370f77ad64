// SPDX-License-Identifier: Apache-2.0
#include "worker/kernels/visible_cells.h"

#include <algorithm>

namespace goldthread {
namespace {

constexpr std::size_t kGatherPadding = 3;

// Chebyshev distances in two passes, in raster order and back: each looks at the 13 of the 26
// neighbours that it has passed (Rosenfeld and Pfaltz 1968; exact for this metric).
class ChessboardTransform {
 public:
  ChessboardTransform(std::vector<std::uint8_t>& distances, glm::ivec3 counts)
      : distances_(distances), counts_(counts) {}

  void run() {
    for (int z = 0; z < counts_.z; ++z)
      for (int y = 0; y < counts_.y; ++y)
        for (int x = 0; x < counts_.x; ++x) relax({x, y, z}, 1);
    for (int z = counts_.z - 1; z >= 0; --z)
      for (int y = counts_.y - 1; y >= 0; --y)
        for (int x = counts_.x - 1; x >= 0; --x) relax({x, y, z}, -1);
  }

 private:
  std::size_t index(glm::ivec3 c) const {
    return (std::size_t(c.z) * std::size_t(counts_.y) + std::size_t(c.y)) * std::size_t(counts_.x) +
           std::size_t(c.x);
  }

  // Looks at the 13 neighbours that raster order (or its reverse) has passed.
  void relax(glm::ivec3 cell, int direction) {
    std::uint8_t& own = distances_[index(cell)];
    if (own == 0) return;
    int least = own;
    for (int n = 0; n < 13; ++n) {
      const glm::ivec3 offset(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
      const glm::ivec3 other = cell + offset * direction;
      if (glm::any(glm::lessThan(other, glm::ivec3(0))) ||
          glm::any(glm::greaterThanEqual(other, counts_)))
        continue;
      least = std::min(least, distances_[index(other)] + 1);
    }
    own = std::uint8_t(least);
  }

  std::vector<std::uint8_t>& distances_;
  glm::ivec3 counts_;
};

}  // namespace

CellVisibility::CellVisibility(const TransferFunction* function,
                               std::span<const Isosurface> isosurfaces, double value_bias,
                               double margin)
    : value_bias_(value_bias), margin_(margin) {
  if (function != nullptr) nodes_ = function->opacity;
  opaque_before_.push_back(0);
  for (const OpacityNode& node : nodes_)
    opaque_before_.push_back(opaque_before_.back() + (node.alpha > 0 ? 1 : 0));
  for (const Isosurface& surface : isosurfaces) isovalues_.push_back(surface.value);
  std::sort(isovalues_.begin(), isovalues_.end());
}

bool CellVisibility::operator()(CellRange stored) const {
  if (!(stored.minimum <= stored.maximum)) return false;
  const double minimum = double(stored.minimum) + value_bias_;
  const double maximum = double(stored.maximum) + value_bias_;
  const auto surface = std::lower_bound(isovalues_.begin(), isovalues_.end(), minimum);
  if (surface != isovalues_.end() && *surface <= maximum) return true;
  return !nodes_.empty() && has_extinction(minimum - margin_, maximum + margin_);
}

// Opacity is linear between nodes: over an interval it is 0 exactly if it is at all nodes inside
// and at the next ones outside, or the interval ends on an inner one.
bool CellVisibility::has_extinction(double minimum, double maximum) const {
  const auto below = [](const OpacityNode& node, double value) { return node.value < value; };
  const auto above = [](double value, const OpacityNode& node) { return value < node.value; };
  const auto first = std::lower_bound(nodes_.begin(), nodes_.end(), minimum, below);
  const auto end = std::upper_bound(nodes_.begin(), nodes_.end(), maximum, above);
  auto from = std::size_t(first - nodes_.begin());
  auto until = std::size_t(end - nodes_.begin());
  const bool starts_on_node = from < nodes_.size() && nodes_[from].value == minimum;
  const bool ends_on_node = until > 0 && nodes_[until - 1].value == maximum;
  if (from > 0 && !starts_on_node) --from;
  if (until < nodes_.size() && !ends_on_node) ++until;
  return opaque_before_[until] > opaque_before_[from];
}

std::vector<std::uint8_t> cell_distances(std::span<const CellRange> cells, glm::ivec3 counts,
                                         const CellVisibility& visible) {
  std::vector<std::uint8_t> to_visible(cells.size() + kGatherPadding, kMostCellDistance);
  std::vector<std::uint8_t> to_empty(cells.size(), kMostCellDistance);
  for (std::size_t i = 0; i < cells.size(); ++i) (visible(cells[i]) ? to_visible : to_empty)[i] = 0;
  ChessboardTransform(to_visible, counts).run();
  ChessboardTransform(to_empty, counts).run();
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (to_visible[i] == 0) to_visible[i] = std::uint8_t(to_empty[i] | kCellIsVisible);
  return to_visible;
}

}  // namespace goldthread
