// SPDX-License-Identifier: Apache-2.0
#include "master/tile_cut.h"

#include <cstdint>

namespace goldthread {
namespace {

constexpr int kEdges[] = {64, 32, 16};

}  // namespace

int root_edge(ImageSize image, int threads) {
  for (const int edge : kEdges) {
    const TileGrid grid = TileGrid::squares(image, edge);
    if (std::int64_t{grid.roots()} >= std::int64_t{kTilesPerThread} * threads) return edge;
  }
  return kCoarsestSpacing;
}

ViewCut cut_of(const TileChoice& choice, ImageSize image, Sampling sampling, Update update,
               int threads) {
  if (choice.rows) return {TileGrid::rows_of(image)};
  if (choice.edge) return {TileGrid::squares(image, *choice.edge)};
  if (update == Update::kAll && sampling != Sampling::kEveryPixel)
    return {TileGrid::squares(image, kRefinedEdge)};
  return {TileGrid::squares(image, root_edge(image, threads)),
          update == Update::kAll || update == Update::kWhole};
}

TileGrid split_dear(const TileGrid& before, const CostHistory& costs, Step last, int threads) {
  TileGrid cut{before.image, before.tile, {}};
  const double total = costs.predict_area_us({0, 0, cut.image.width, cut.image.height}, last);
  if (!(total > 0)) return cut;
  const double dear = kDearShare * total / threads;
  const auto is_dear = [&](const PixelRect& rect, bool was_split) {
    return costs.predict_area_us(rect, last) > (was_split ? kStaysSplit : 1) * dear;
  };
  auto was = before.splits.begin();
  for (std::uint32_t root = 0; root < cut.roots(); ++root) {
    while (was != before.splits.end() && was->root < root) ++was;
    const bool was_split = was != before.splits.end() && was->root == root;
    if (!cut.can_split(root, false) || !is_dear(cut.root_rect(root), was_split)) continue;
    SplitRoot split{root, 0};
    for (int quarter = 0; quarter < 4 && cut.can_split(root, true); ++quarter) {
      const auto bit = static_cast<std::uint8_t>(1U << quarter);
      if (is_dear(quarter_of(cut.root_rect(root), quarter),
                  was_split && (was->quarters & bit) != 0))
        split.quarters |= bit;
    }
    cut.splits.push_back(split);
  }
  return cut;
}

}  // namespace goldthread
