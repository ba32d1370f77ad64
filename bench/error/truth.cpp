// SPDX-License-Identifier: Apache-2.0
#include "bench/error/truth.h"

#include <algorithm>
#include <numeric>

namespace goldthread::bench {
namespace {

constexpr int kGrids[] = {4, 16, 48};
/// The spread of displayed colours from which on a pixel gets the second and the third grid.
constexpr double kSpreads[] = {1.0 / 255, 12.0 / 255};

/// The mean of edge×edge rays in a pixel as displayed, and how far they differ.
struct GridMean {
  Color color{0};
  double spread = 0;
};

class PixelCaster {
 public:
  explicit PixelCaster(const TruthRequest& request) : request_(request) {}

  GridMean mean(PixelPosition centre, int edge) {
    positions_.clear();
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x)
        positions_.push_back({centre.x + (float(x) + 0.5F) / float(edge) - 0.5F,
                              centre.y + (float(y) + 0.5F) / float(edge) - 0.5F});
    samples_.resize(positions_.size());
    request_.source.cast(positions_, samples_);
    rays_ += positions_.size();
    return mean_of_samples();
  }
  std::uint64_t rays() const { return rays_; }

 private:
  Color shown(const glm::dvec3& color, double alpha) const {
    const bool linear = request_.image.color_space == ColorSpace::kLinear;
    return displayed(color, alpha, request_.image.background, linear);
  }
  GridMean mean_of_samples() const {
    glm::dvec3 color(0);
    double alpha = 0;
    Color low(1), high(0);
    for (const Sample& sample : samples_) {
      const glm::dvec3 own(sample.red, sample.green, sample.blue);
      color += own;
      alpha += sample.alpha;
      const Color seen = shown(own, sample.alpha);
      low = glm::min(low, seen);
      high = glm::max(high, seen);
    }
    const double count = double(samples_.size());
    const glm::dvec3 range = high - low;
    return {shown(color / count, alpha / count), std::max({range.r, range.g, range.b})};
  }

  const TruthRequest& request_;
  std::vector<PixelPosition> positions_;
  std::vector<Sample> samples_;
  std::uint64_t rays_ = 0;
};

/// How fine the grid must be.
int edge_for(double spread) {
  if (spread <= kSpreads[0]) return kGrids[0];
  return spread <= kSpreads[1] ? kGrids[1] : kGrids[2];
}

/// Pixels that one thread takes at a time.
constexpr std::size_t kPixels = 256;

}  // namespace

Truth filtered_truth(const TruthRequest& request) {
  const std::size_t count = request.subset.count();
  Truth truth;
  truth.colors.resize(count);
  std::vector<Color> coarser(count);
  std::vector<std::uint64_t> rays((count + kPixels - 1) / kPixels);
  in_parallel(
      request.threads, rays.size(),
      [&](std::size_t batch) {
        PixelCaster caster(request);
        for (std::size_t i = batch * kPixels; i < std::min(count, (batch + 1) * kPixels); ++i) {
          PixelPosition centre = request.subset.centre(i);
          centre.x += float(request.shift.x);
          centre.y += float(request.shift.y);
          const GridMean first = caster.mean(centre, kGrids[0]);
          const int edge = edge_for(first.spread);
          truth.colors[i] = edge == kGrids[0] ? first.color : caster.mean(centre, edge).color;
          coarser[i] = caster.mean(centre, edge / 2).color;
        }
        rays[batch] = caster.rays();
      },
      request.progress);
  truth.rays_per_pixel =
      double(std::accumulate(rays.begin(), rays.end(), std::uint64_t{0})) / double(count);
  truth.coarser = picture_error(coarser, truth.colors).rms;
  return truth;
}

}  // namespace goldthread::bench
