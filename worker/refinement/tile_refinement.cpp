// SPDX-License-Identifier: Apache-2.0
#include "worker/refinement/tile_refinement.h"

#include <algorithm>

#include "worker/refinement/sample_sequence.h"

namespace goldthread {
namespace {

constexpr int kFineGridSpacing = 8;
/// Of the squared error at the places between a grid's samples; half of it is left when they are
/// sampled too, as at edges, whose area halves.
constexpr double kLeftByHalving = 0.5;
/// Of the squared difference of two neighbours: the error of what lies between them at an edge.
constexpr double kErrorOfDifference = 1.0 / 6;

std::uint32_t seed_of(const PixelRect& rect) {
  return static_cast<std::uint32_t>(rect.y) * 0x10001U + static_cast<std::uint32_t>(rect.x);
}

}  // namespace

TileRefinement::TileRefinement(const TileTask& task)
    : task_(task),
      plane_({task.rect.width, task.rect.height}, task.appearance, task.with_surfaces),
      antialiasing_(plane_.tile()),
      probes_(plane_.tile(), seed_of(task.rect)) {}

bool TileRefinement::advance(const Cast& cast) {
  changed_.clear();
  step_ = step_.next();
  plane_.forget_filled();
  const StepPlan plan = plan_of(step_);
  if (step_ < kFirstAdaptiveStep) return advance_coarsely(cast);
  const bool even = task_.how.sampling == Sampling::kEveryPixel;
  if (!(even ? advance_evenly(plan, cast) : advance_adaptively(plan, cast))) return false;
  std::sort(changed_.begin(), changed_.end());
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  measure_gradient();
  return true;
}

bool TileRefinement::advance_coarsely(const Cast& cast) {
  const int spacing = step_ == Step{1} ? kCoarsestSpacing : kFineGridSpacing;
  if (!cast_grid(spacing, cast)) return false;
  quality_.squared_error = error_of_grid(spacing);
  measure_gradient();
  return true;
}

bool TileRefinement::cast_places(std::span<const SampleOffset> places, const Cast& cast) {
  if (places.empty()) return true;
  std::vector<PixelPosition> positions(places.size());
  std::transform(places.begin(), places.end(), positions.begin(),
                 [&](SampleOffset place) { return position_of(task_.rect, place); });
  std::vector<Sample> samples(places.size());
  std::vector<std::uint32_t> surfaces(places.size());
  if (!cast(positions, samples, surfaces)) return false;
  for (std::size_t i = 0; i < places.size(); ++i)
    plane_.put(places[i].x, places[i].y, samples[i], surfaces[i]);
  changed_.insert(changed_.end(), places.begin(), places.end());
  return true;
}

bool TileRefinement::cast_grid(int spacing, const Cast& cast) {
  auto places = grid_places(plane_.tile(), spacing);
  std::erase_if(places, [&](SampleOffset place) { return plane_.known(place.x, place.y); });
  return cast_places(places, cast);
}

bool TileRefinement::advance_evenly(const StepPlan& plan, const Cast& cast) {
  if (step_ == kFirstAdaptiveStep) {
    if (!cast_grid(1, cast)) return false;
    finest_ = squares_of(plane_, 2);
    if (!cast_apron(cast)) return false;
  } else {
    const auto count = std::min(plan.even_samples, task_.how.most_samples);
    if (!cast_orders(antialiasing_.choose_all(plane_, count), cast)) return false;
  }
  quality_.squared_error = antialiasing_.squared_error(plane_, finest_);
  return true;
}

bool TileRefinement::advance_adaptively(const StepPlan& plan, const Cast& cast) {
  if (!subdivide(plan, cast) || !antialias(plan, cast) || !probe(plan, cast)) return false;
  quality_.squared_error =
      probes_.squared_error(plane_) + antialiasing_.squared_error(plane_, finest_);
  return true;
}

bool TileRefinement::subdivide(const StepPlan& plan, const Cast& cast) {
  const bool all_five = task_.how.sampling == Sampling::kSubdivision;
  const SubdivisionRule rule{plan.threshold, plan.bend, all_five};
  std::vector<Square> squares = squares_of(plane_, kFineGridSpacing);
  std::vector<SampleOffset> wanted;
  for (int spacing = kFineGridSpacing; spacing > 1; spacing /= 2) {
    wanted.clear();
    choose(plane_, squares, spacing, rule, surprises_, wanted);
    if (!cast_places(wanted, cast)) return false;
    squares = quarters(plane_, squares, spacing);
    if (spacing == 4) finest_ = squares;
  }
  surprises_.clear();
  return true;
}

bool TileRefinement::cast_apron(const Cast& cast) {
  const auto wanted = antialiasing_.wanted_apron(finest_);
  if (wanted.empty()) return true;
  std::vector<PixelPosition> positions;
  for (const ApronPixel pixel : wanted)
    positions.push_back(sample_position(task_.rect.x + pixel.x, task_.rect.y + pixel.y, 0));
  std::vector<Sample> samples(wanted.size());
  std::vector<std::uint32_t> surfaces(wanted.size());
  if (!cast(positions, samples, surfaces)) return false;
  for (std::size_t i = 0; i < wanted.size(); ++i)
    antialiasing_.put_apron(wanted[i], shown(samples[i], task_.appearance));
  return true;
}

bool TileRefinement::antialias(const StepPlan& plan, const Cast& cast) {
  plane_.forget_filled();
  return cast_apron(cast) &&
         cast_orders(antialiasing_.choose(plane_, finest_, plan, task_.how.most_samples), cast);
}

bool TileRefinement::cast_orders(std::span<const PixelOrder> orders, const Cast& cast) {
  std::vector<PixelPosition> positions;
  for (const PixelOrder& order : orders)
    for (std::uint32_t number = order.first; number < order.last; ++number)
      positions.push_back(sample_position(task_.rect.x + order.place.x,
                                          task_.rect.y + order.place.y, number));
  if (positions.empty()) return true;
  std::vector<Sample> samples(positions.size());
  std::vector<std::uint32_t> surfaces(positions.size());
  if (!cast(positions, samples, surfaces)) return false;
  std::size_t at = 0;
  for (const PixelOrder& order : orders) {
    const std::size_t count = order.last - order.first;
    antialiasing_.add(plane_, order, std::span(samples).subspan(at, count),
                      surfaces[at], task_.appearance);
    changed_.push_back(order.place);
    at += count;
  }
  return true;
}

bool TileRefinement::probe(const StepPlan& plan, const Cast& cast) {
  plane_.forget_filled();
  const auto places = probes_.next(plane_, plan.probes);
  std::vector<Shown> filled;
  for (const SampleOffset place : places) filled.push_back(plane_.filled_at(place.x, place.y));
  if (!cast_places(places, cast)) return false;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Shown& found = plane_.at(places[i].x, places[i].y);
    const bool surprising = distance(found, filled[i]) > plan.threshold;
    probes_.note(places[i], squared_distance(found, filled[i]), surprising);
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
  for (int y = 0; y < plane_.tile().height; y += spacing)
    for (int x = 0; x < plane_.tile().width; x += step) {
      const Shown &left = plane_.at(x, y), &right = plane_.at(x + step, y);
      sum += between ? kLeftByHalving * squared_distance(plane_.at(x + spacing, y),
                                                         midpoint(left, right))
                     : kErrorOfDifference * squared_distance(left, right);
      ++count;
    }
  return sum / count * plane_.tile().width * plane_.tile().height;
}

void TileRefinement::measure_gradient() {
  const int spacing = step_ == Step{1} ? kCoarsestSpacing : kFineGridSpacing / 2;
  double sum = 0;
  int count = 0;
  for (int y = 0; y < plane_.tile().height; y += spacing)
    for (int x = 0; x < plane_.tile().width; x += spacing) {
      const Shown& at = plane_.at(x, y);
      sum += squared_distance(at, plane_.at(x + spacing, y)) +
             squared_distance(at, plane_.at(x, y + spacing));
      ++count;
    }
  const double per_pixel = sum / (2.0 * count * spacing * spacing);
  quality_.squared_gradient = per_pixel * plane_.tile().width * plane_.tile().height;
}

}  // namespace goldthread
