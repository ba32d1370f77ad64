// SPDX-License-Identifier: Apache-2.0
#pragma once
// The words for settings of refinement and display that users, scripts and pages see.

#include <array>
#include <optional>
#include <string_view>

#include "common/tile/refinement.h"

namespace goldthread {

template <class Value>
struct Named {
  std::string_view name;
  Value value;
};

constexpr std::array<Named<Sampling>, 3> kSamplingNames{{{"adaptive", Sampling::kAdaptive},
                                                         {"subdivision", Sampling::kSubdivision},
                                                         {"every-pixel", Sampling::kEveryPixel}}};
constexpr std::array<Named<Filter>, 5> kFilterNames{
    {{"box", Filter::kBox},
     {"bilinear", Filter::kBilinear},
     {"biquadratic", Filter::kBiquadratic},
     {"piecewise-quadratic", Filter::kPiecewiseQuadratic},
     {"bicubic", Filter::kBicubic}}};
/// Those that can be chosen.
constexpr std::array<Named<Update>, 4> kUpdateNames{{{"100", Update::kAll},
                                                     {"50", Update::kHalf},
                                                     {"25", Update::kQuarter},
                                                     {"frameless", Update::kFrameless}}};

/// Empty for what has no name.
template <class Value, std::size_t kCount>
constexpr std::string_view name_in(const std::array<Named<Value>, kCount>& names, Value value) {
  for (const Named<Value>& named : names)
    if (named.value == value) return named.name;
  return {};
}

template <class Value, std::size_t kCount>
constexpr std::optional<Value> value_in(const std::array<Named<Value>, kCount>& names,
                                        std::string_view name) {
  for (const Named<Value>& named : names)
    if (named.name == name) return named.value;
  return std::nullopt;
}

}  // namespace goldthread
