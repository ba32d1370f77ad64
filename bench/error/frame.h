// SPDX-License-Identifier: Apache-2.0
#pragma once
// One picture by the ray caster alone: a ray in each pixel's centre, tiles of 64×64 pixels taken by
// threads in turn. And the same picture by the reference, on a regular subset of the pixels.

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "bench/error/statistics.h"
#include "common/scene/scene.h"
#include "common/volume/volume.h"
#include "worker/sample_source.h"

namespace goldthread::bench {

/// Calls work(i) once for each i < count, from `threads` threads (the caller's among them).
/// The caller's tells `progress` the share that is done.
void in_parallel(
    int threads, std::size_t count, const std::function<void(std::size_t)>& work,
    const std::function<void(double)>& progress = [](double) {});

/// Casts whole pictures of one size.
class FrameCaster {
 public:
  FrameCaster(ImageSize size, int threads);

  /// The picture is kept until the next call.
  CastCounts cast(const SampleSource& source);
  /// What the last cast shows at pixels (x, y) with x and y multiples of `stride`, row by row.
  std::vector<Color> shown(const ImageSettings& image, int stride) const;

 private:
  ImageSize size_;
  int threads_;
  std::vector<PixelPosition> positions_;  ///< tile by tile
  std::vector<std::size_t> tile_ends_;    ///< behind each tile's last position
  std::vector<Sample> samples_;
};

/// The subset of pixels that pictures are compared on: every `stride`-th in both directions.
struct Subset {
  ImageSize image;
  int stride = 1;
  std::size_t count() const;
  /// The centre of the i-th one, row by row.
  PixelPosition centre(std::size_t i) const;
};

/// The double-precision integrator's picture of a resolved scene at the subset's pixel centres,
/// moved by `shift`; `voxels` as reference::voxels_of() gives them. Slow.
struct ReferenceRequest {
  const Scene& scene;
  const VolumeGeometry& geometry;
  std::span<const double> voxels;
  Subset subset;
  int substeps = 16;  ///< per crossed cell
  int threads = 1;
  Shift shift;
  std::function<void(double)> progress = [](double) {};
};
std::vector<Color> reference_picture(const ReferenceRequest& request);

}  // namespace goldthread::bench
