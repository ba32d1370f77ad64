// SPDX-License-Identifier: Apache-2.0
#pragma once
// The golden thread of one tile: "a single step that if repeated a few times will generate a crude
// image, one which repeated many times will generate a high quality image, and one which could be
// repeated indefinitely" (Bergman et al. 1986). What a tile holds after so many steps follows from
// the rays and the settings alone: not from who cast them, when, or in how many visits. No ray is
// cast twice.

#include <functional>
#include <span>
#include <vector>

#include "common/protocol/messages.h"
#include "common/tile/refinement.h"
#include "worker/refinement/antialiasing.h"
#include "worker/refinement/probes.h"
#include "worker/refinement/step_plan.h"
#include "worker/refinement/subdivision.h"

namespace goldthread {

struct TileTask {
  PixelRect rect;
  Refinement how;
  Appearance appearance;
  bool with_surfaces = false;  ///< the scene has isosurfaces
};

class TileRefinement {
 public:
  /// Casts rays: one sample, and the surfaces it met (may be left alone without surfaces), for each
  /// position. False if the work is no longer wanted.
  using Cast = std::function<bool(std::span<const PixelPosition> positions,
                                  std::span<Sample> samples, std::span<std::uint32_t> surfaces)>;

  explicit TileRefinement(const TileTask& task) { restart(task); }
  /// As if new, in the same memory.
  void restart(const TileTask& task);

  /// One step further. False if `cast` gave up; the tile is then of no use any more.
  bool advance(const Cast& cast);
  Step step() const { return step_; }
  const TileQuality& quality() const { return quality_; }

  /// The places that the last step has changed, each once.
  std::span<const SampleOffset> changed() const { return changed_; }
  const Sample& sample(SampleOffset place) const { return lattice_.sample(place.x, place.y); }
  const TileLattice& lattice() const { return lattice_; }
  /// Roughly what it takes in memory.
  std::size_t bytes() const {
    return lattice_.bytes() + antialiasing_.bytes() +
           positions_.capacity() * (sizeof(PixelPosition) + sizeof(Sample) + sizeof(std::uint32_t));
  }

 private:
  bool cast_places(std::span<const SampleOffset> places, const Cast& cast);
  bool cast_grid(int spacing, const Cast& cast);
  bool subdivide(const StepPlan& plan, const Cast& cast);
  bool antialias(const StepPlan& plan, const Cast& cast);
  bool cast_apron(const Cast& cast);
  bool cast_orders(std::span<const PixelOrder> orders, const Cast& cast);
  bool cast_some(std::span<const PixelOrder> orders, const Cast& cast);
  bool probe(const StepPlan& plan, const Cast& cast);
  bool advance_evenly(const StepPlan& plan, const Cast& cast);
  bool advance_adaptively(const StepPlan& plan, const Cast& cast);
  bool advance_coarsely(const Cast& cast);
  void measure_gradient();
  double error_of_grid(int spacing);

  /// Casts rays through positions_, to samples_ and met_.
  bool cast_positions(const Cast& cast);

  TileTask task_;
  TileLattice lattice_;
  Antialiasing antialiasing_;
  Probes probes_;
  std::vector<PixelPosition> positions_;  ///< of a batch of rays, and what they bring
  std::vector<Sample> samples_;
  std::vector<std::uint32_t> met_;
  std::vector<SampleOffset> wanted_;
  std::vector<Square> finest_;  ///< squares of spacing 2 in which something is known
  std::vector<SampleOffset> surprises_;
  Step step_ = kNoStep;
  TileQuality quality_;
  std::vector<SampleOffset> changed_;
};

}  // namespace goldthread
