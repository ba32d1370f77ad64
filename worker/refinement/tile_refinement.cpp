// SPDX-License-Identifier: Apache-2.0
#include "worker/refinement/tile_refinement.h"

#include <algorithm>

#include "worker/refinement/sample_sequence.h"

namespace goldthread {
namespace {

constexpr int kFineGridSpacing = 8;
/// That are kept at a time, however many a step takes.
constexpr std::uint32_t kMostRays = 1U << 14;
/// Of the squared error at the places between a grid's samples; half of it is left when they are
/// sampled too, as at edges, whose area halves.
constexpr double kLeftByHalving = 0.5;
/// Of the squared difference of two neighbours: the error of what lies between them at an edge.
constexpr double kErrorOfDifference = 1.0 / 6;

std::uint32_t seed_of(const PixelRect& rect) {
  return static_cast<std::uint32_t>(rect.y) * 0x10001U + static_cast<std::uint32_t>(rect.x);
}

}  // namespace

void TileRefinement::restart(const TileTask& task) {
  task_ = task;
  const ImageSize tile{task.rect.width, task.rect.height};
  lattice_.restart(tile, task.appearance, task.with_surfaces);
  antialiasing_.restart(tile);
  probes_.restart(tile, seed_of(task.rect));
  finest_.clear();
  surprises_.clear();
  changed_.clear();
  step_ = kNoStep;
  quality_ = {};
}

bool TileRefinement::advance(const Cast& cast) {
  changed_.clear();
  step_ = step_.next();
  lattice_.forget_filled();
  if (step_ < kFirstAdaptiveStep) return advance_coarsely(cast);
  const StepPlan plan = plan_of(step_);
  const bool even = task_.how.sampling == Sampling::kEveryPixel;
  return even ? advance_evenly(plan, cast) : advance_adaptively(plan, cast);
}

bool TileRefinement::advance_coarsely(const Cast& cast) {
  const int spacing = step_ == Step{1} ? kCoarsestSpacing : kFineGridSpacing;
  if (!cast_grid(spacing, cast)) return false;
  quality_.squared_error = error_of_grid(spacing);
  measure_gradient();
  return true;
}

bool TileRefinement::cast_positions(const Cast& cast) {
  samples_.resize(positions_.size());
  met_.resize(positions_.size());
  return positions_.empty() || cast(positions_, samples_, met_);
}

bool TileRefinement::cast_places(std::span<const SampleOffset> places, const Cast& cast) {
  positions_.clear();
  for (const SampleOffset place : places) positions_.push_back(position_of(task_.rect, place));
  if (!cast_positions(cast)) return false;
  for (std::size_t i = 0; i < places.size(); ++i)
    lattice_.put(places[i].x, places[i].y, samples_[i], met_[i]);
  changed_.insert(changed_.end(), places.begin(), places.end());
  return true;
}

bool TileRefinement::cast_grid(int spacing, const Cast& cast) {
  auto places = grid_places(lattice_.tile(), spacing);
  std::erase_if(places, [&](SampleOffset place) { return lattice_.known(place.x, place.y); });
  return cast_places(places, cast);
}

bool TileRefinement::advance_evenly(const StepPlan& plan, const Cast& cast) {
  if (step_ == kFirstAdaptiveStep) {
    if (!cast_grid(1, cast)) return false;
    finest_ = squares_of(lattice_, 2);
    if (!cast_apron(cast)) return false;
  }
  const auto count = std::min(plan.even_samples, task_.how.most_samples);
  if (!cast_orders(antialiasing_.choose_all(lattice_, finest_, count), cast)) return false;
  quality_.squared_error = antialiasing_.squared_error();
  return true;
}

bool TileRefinement::advance_adaptively(const StepPlan& plan, const Cast& cast) {
  if (!subdivide(plan, cast) || !antialias(plan, cast) || !probe(plan, cast)) return false;
  quality_.squared_error = probes_.squared_error(lattice_) + antialiasing_.squared_error();
  return true;
}

bool TileRefinement::subdivide(const StepPlan& plan, const Cast& cast) {
  const bool all_five = task_.how.sampling == Sampling::kSubdivision;
  const SubdivisionRule rule{plan.threshold, plan.bend, all_five, all_five ? 0 : plan.whole};
  std::vector<Square> squares = squares_of(lattice_, kFineGridSpacing);
  for (int spacing = kFineGridSpacing; spacing > 1; spacing /= 2) {
    wanted_.clear();
    choose(lattice_, squares, spacing, rule, surprises_, wanted_);
    if (!cast_places(wanted_, cast)) return false;
    squares = quarters(lattice_, squares, spacing);
    if (spacing == 4) finest_ = with_next(lattice_, squares, 2);
  }
  surprises_.clear();
  return true;
}

bool TileRefinement::cast_apron(const Cast& cast) {
  const auto wanted = antialiasing_.wanted_apron(finest_);
  positions_.clear();
  for (const ApronPixel pixel : wanted)
    positions_.push_back(sample_position(task_.rect.x + pixel.x, task_.rect.y + pixel.y, 0));
  if (!cast_positions(cast)) return false;
  for (std::size_t i = 0; i < wanted.size(); ++i)
    antialiasing_.put_apron(wanted[i], shown(samples_[i], task_.appearance));
  return true;
}

bool TileRefinement::antialias(const StepPlan& plan, const Cast& cast) {
  lattice_.forget_filled();
  return cast_apron(cast) &&
         cast_orders(antialiasing_.choose(lattice_, finest_, plan, task_.how.most_samples), cast);
}

bool TileRefinement::cast_some(std::span<const PixelOrder> orders, const Cast& cast) {
  positions_.clear();
  for (const PixelOrder& order : orders)
    for (std::uint32_t number = order.first; number < order.last; ++number)
      positions_.push_back(
          sample_position(task_.rect.x + order.place.x, task_.rect.y + order.place.y, number));
  if (!cast_positions(cast)) return false;
  std::size_t at = 0;
  for (const PixelOrder& order : orders) {
    const std::size_t count = order.last - order.first;
    antialiasing_.add(lattice_, order, std::span(samples_).subspan(at, count), met_[at],
                      task_.appearance);
    at += count;
  }
  return true;
}

bool TileRefinement::cast_orders(std::span<const PixelOrder> orders, const Cast& cast) {
  std::vector<PixelOrder> some;
  std::uint32_t rays = 0;
  for (const PixelOrder& order : orders) {
    changed_.push_back(order.place);
    for (std::uint32_t first = order.first; first < order.last;) {
      const std::uint32_t last = std::min(order.last, first + (kMostRays - rays));
      some.push_back({order.place, first, last});
      rays += last - first;
      first = last;
      if (rays < kMostRays) continue;
      if (!cast_some(some, cast)) return false;
      some.clear();
      rays = 0;
    }
  }
  if (!cast_some(some, cast)) return false;
  if (orders.empty()) return true;
  // A pixel whose centre was cast in this step, too, is there already.
  std::sort(changed_.begin(), changed_.end());
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  return true;
}

bool TileRefinement::probe(const StepPlan& plan, const Cast& cast) {
  lattice_.forget_filled();
  const auto places = probes_.next(lattice_, plan.probes);
  std::vector<Shown> filled;
  filled.reserve(places.size());
  for (const SampleOffset place : places)
    filled.push_back(Shown::of(lattice_.at(place.x, place.y)));
  if (!cast_places(places, cast)) return false;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const ShownLanes found = lattice_.at(places[i].x, places[i].y), expected = filled[i].lanes();
    const bool surprising = exceeds(distance(found, expected), plan.threshold);
    probes_.note(places[i], squared_distance(found, expected), surprising);
    if (surprising) surprises_.push_back(places[i]);
  }
  return true;
}

double TileRefinement::error_of_grid(int spacing) {
  // Half of the samples of the finer grid lie between two of the coarser one, which is what they
  // are held against.
  double sum = 0;
  int count = 0;
  const bool between = spacing < kCoarsestSpacing;
  const int step = between ? 2 * spacing : spacing;
  for (int y = 0; y < lattice_.tile().height; y += spacing)
    for (int x = 0; x < lattice_.tile().width; x += step) {
      const ShownLanes left = lattice_.at(x, y), right = lattice_.at(x + step, y);
      sum += between ? kLeftByHalving *
                           squared_distance(lattice_.at(x + spacing, y), middle(left, right))
                     : kErrorOfDifference * squared_distance(left, right);
      ++count;
    }
  return sum / count * lattice_.tile().width * lattice_.tile().height;
}

void TileRefinement::measure_gradient() {
  const int spacing = step_ == Step{1} ? kCoarsestSpacing : kFineGridSpacing;
  double sum = 0;
  int count = 0;
  for (int y = 0; y < lattice_.tile().height; y += spacing)
    for (int x = 0; x < lattice_.tile().width; x += spacing) {
      const ShownLanes at = lattice_.at(x, y);
      sum += squared_distance(at, lattice_.at(x + spacing, y)) +
             squared_distance(at, lattice_.at(x, y + spacing));
      ++count;
    }
  const double per_pixel = sum / (2.0 * count * spacing * spacing);
  quality_.squared_gradient = per_pixel * lattice_.tile().width * lattice_.tile().height;
}

}  // namespace goldthread
