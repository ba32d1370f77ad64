// SPDX-License-Identifier: Apache-2.0
#pragma once
// How a view is refined and shown: what master, workers and compositors must agree on. A tile is
// refined in steps of the golden thread; which samples it holds after so many steps follows from
// the scene, the view and these settings alone.

#include <compare>
#include <cstdint>
#include <tuple>

namespace goldthread {

/// How a step chooses its new samples.
enum class Sampling : std::uint8_t {
  kAdaptive,     ///< VOL2's partial subdivision: a sample between two that differ
  kSubdivision,  ///< conventional: all five samples of a square whose corners differ
  kEveryPixel    ///< a ray in each pixel's centre, then evenly more
};

/// How pixels come from samples.
enum class Filter : std::uint8_t { kBox, kBilinear, kBiquadratic, kPiecewiseQuadratic, kBicubic };

/// What of a moving picture is cast anew for each displayed frame; the rest is of older views.
enum class Update : std::uint8_t {
  kAll,        ///< every sample
  kHalf,       ///< a checkerboard's fields in turn
  kQuarter,    ///< one sample of 2×2 in turn
  kFrameless,  ///< frameless antialiasing: one of a block's Poisson-disk samples in turn
  kWhole       ///< each pixel's centre, all at once: a session's choice, not a page's
};

/// What a page may choose without the scene being cast again.
struct DisplaySettings {
  Filter filter = Filter::kBilinear;
  Update update = Update::kAll;
  bool cine = false;  ///< rock the picture when it is at rest
  bool operator==(const DisplaySettings&) const = default;
  static constexpr auto fields() {
    return std::tuple{&DisplaySettings::filter, &DisplaySettings::update, &DisplaySettings::cine};
  }
};

/// How many steps a tile has taken; 0: it holds nothing. Each view begins with the coarse steps,
/// which are the same for every kind of sampling.
struct Step {
  std::uint16_t value = 0;
  auto operator<=>(const Step&) const = default;
  Step next() const { return {static_cast<std::uint16_t>(value + 1)}; }
  static constexpr auto fields() { return std::tuple{&Step::value}; }
};
constexpr Step kNoStep{0};
/// The first two steps cast a grid of one ray in 16×16 and in 8×8 pixels.
constexpr Step kFirstAdaptiveStep{3};
constexpr Step kLastStep{200};  ///< far beyond what a lifetime computes

struct Refinement {
  Sampling sampling = Sampling::kAdaptive;
  std::uint32_t most_samples = 1U << 20;  ///< in one pixel
  bool operator==(const Refinement&) const = default;
  static constexpr auto fields() {
    return std::tuple{&Refinement::sampling, &Refinement::most_samples};
  }
};

/// How many samples each pixel has after a step of Sampling::kEveryPixel, if it may have so many:
/// none of its own at first, then 1, 5, 9, 17 …
constexpr std::uint32_t even_samples(Step step) {
  if (step <= kFirstAdaptiveStep) return step == kFirstAdaptiveStep ? 1 : 0;
  const unsigned doublings = step.value - kFirstAdaptiveStep.value - 1U;
  return 1 + (4U << (doublings < 18 ? doublings : 18));
}

/// Whether a quantum from one step to another makes sense. For bytes of a peer.
constexpr bool is_step(Step from, Step to) { return from < to && to <= kLastStep; }

}  // namespace goldthread
