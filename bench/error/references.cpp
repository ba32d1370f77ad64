// SPDX-License-Identifier: Apache-2.0
#include "bench/error/references.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/error/rounds.h"
#include "bench/reference/reference_integrator.h"

namespace goldthread::bench {
namespace {

/// Per crossed cell; the reference's error falls with their square. Shine on edges needs many. To
/// tell one alignment from another a few are enough.
constexpr int kSubsteps = 64;
constexpr int kSubstepsForAlignment = 8;
/// How much sparser than the reference the pixels are on which convergence is checked, and those on
/// which an alignment is searched for.
constexpr int kThinForConvergence = 2;
constexpr int kThinForAlignment = 4;

}  // namespace

References::References(const Subject& subject, const ErrorBenchSettings& settings)
    : subject_(subject), settings_(settings), voxels_(reference::voxels_of(*subject.volume)) {}

std::vector<Color> References::compute(Look look, int stride, int substeps, Shift shift) const {
  const Scene scene = subject_.in(look);
  return reference_picture({scene,
                            subject_.volume->info().geometry,
                            voxels_,
                            {scene.image.size, stride},
                            substeps,
                            settings_.threads,
                            shift,
                            in_phase(settings_, fmt::format("reference, {}", name_of(look)))});
}

const std::vector<Color>& References::kept(Look look, int stride, int substeps, Shift shift) {
  const Key key{look, stride, shift.x, shift.y};
  const auto known = pictures_.find(key);
  if (known != pictures_.end()) return known->second;
  return pictures_[key] = compute(look, stride, substeps, shift);
}

const std::vector<Color>& References::of(Look look) {
  const bool known = std::any_of(rows_.begin(), rows_.end(),
                                 [&](const ReferenceRow& row) { return row.look == look; });
  if (known) return moved(look, {});
  ReferenceRow row{look, kSubsteps};
  row.seconds = seconds_of([&] { moved(look, {}); });
  const std::vector<Color>& picture = moved(look, {});
  const int stride = kThinForConvergence * settings_.stride;
  const auto sparse =
      thinned(picture, {subject_.scene.image.size, settings_.stride}, kThinForConvergence);
  row.halved = picture_error(compute(look, stride, kSubsteps / 2, {}), sparse).rms;
  row.doubled = picture_error(compute(look, stride, kSubsteps * 2, {}), sparse).rms;
  rows_.push_back(row);
  return picture;
}

const std::vector<Color>& References::moved(Look look, Shift shift) {
  return kept(look, settings_.stride, kSubsteps, shift);
}

Alignment References::align(Look look, std::span<const Color> shown) {
  const auto sparse =
      thinned(shown, {subject_.scene.image.size, settings_.stride}, kThinForAlignment);
  const int stride = kThinForAlignment * settings_.stride;
  const Shift best = best_alignment(sparse, [&](Shift shift) {
                       return kept(look, stride, kSubstepsForAlignment, shift);
                     }).shift;
  return {best, picture_error(shown, moved(look, best))};
}

std::vector<Color> thinned(std::span<const Color> picture, const Subset& subset, int keep) {
  const auto columns = (subset.image.width + subset.stride - 1) / subset.stride;
  const auto rows = (subset.image.height + subset.stride - 1) / subset.stride;
  std::vector<Color> colors;
  for (int y = 0; y < rows; y += keep)
    for (int x = 0; x < columns; x += keep)
      colors.push_back(picture[std::size_t(y) * std::size_t(columns) + std::size_t(x)]);
  return colors;
}

}  // namespace goldthread::bench
