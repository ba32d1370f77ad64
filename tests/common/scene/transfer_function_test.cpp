// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/scene/scene.h"

namespace goldthread {
namespace {

TransferFunction example() {
  TransferFunction function;
  function.color = {{0, {0, 0, 0}}, {60, {0.8, 0.4, 0.3}}, {255, {1, 1, 1}}};
  function.opacity = {{10, 0.1}, {20, 0.5}, {20, 0.9}, {40, 1}};
  return function;
}

TEST(TransferFunction, IsLinearBetweenNodesAndConstantOutside) {
  const TransferFunction function = example();
  EXPECT_EQ(function.color_at(-5), glm::dvec3(0, 0, 0));
  EXPECT_EQ(function.color_at(30), glm::dvec3(0.4, 0.2, 0.15));
  EXPECT_EQ(function.color_at(1000), glm::dvec3(1, 1, 1));
  EXPECT_DOUBLE_EQ(function.opacity_at(-1e30), 0.1);
  EXPECT_DOUBLE_EQ(function.opacity_at(15), 0.3);
  EXPECT_DOUBLE_EQ(function.opacity_at(1e30), 1);
}

TEST(TransferFunction, AtAStepTheLaterNodeHolds) {
  const TransferFunction function = example();
  EXPECT_DOUBLE_EQ(function.opacity_at(20), 0.9);
  EXPECT_NEAR(function.opacity_at(std::nextafter(20.0, 0.0)), 0.5, 1e-12);
}

TEST(TransferFunction, ExtinctionOverTheUnitDistanceGivesTheOpacityBack) {
  TransferFunction function = example();
  for (const double unit : {0.1, 1.0, 7.0}) {
    function.unit_distance_mm = unit;
    for (const double value : {10.0, 13.0, 19.0, 25.0, 39.0}) {
      const double alpha = -std::expm1(-function.extinction_at(value) * unit);
      EXPECT_NEAR(alpha, function.opacity_at(value), 1e-14);
    }
  }
}

TEST(TransferFunction, FullOpacityIsCappedAtOneMillionthBelowOne) {
  TransferFunction function = example();
  function.unit_distance_mm = 2;
  // The cap is 1 − 1e-6 rounded to a double, which moves its logarithm by up to 1.2e-10.
  EXPECT_NEAR(function.extinction_at(40), -std::log(1e-6) / 2, 1.2e-10 / 2);
}

TEST(TransferFunction, TinyOpacitiesKeepTheirDigits) {
  TransferFunction function;
  function.color = {{0, {1, 1, 1}}};
  function.opacity = {{0, 1e-17}};
  EXPECT_DOUBLE_EQ(function.extinction_at(0), 1e-17);
}

TEST(TransferFunction, ANodelessOrNanLookupIsTransparent) {
  EXPECT_EQ(TransferFunction{}.opacity_at(3), 0);
  EXPECT_EQ(TransferFunction{}.color_at(3), glm::dvec3(0, 0, 0));
  EXPECT_EQ(example().extinction_at(std::numeric_limits<double>::quiet_NaN()), 0);
}

}  // namespace
}  // namespace goldthread
