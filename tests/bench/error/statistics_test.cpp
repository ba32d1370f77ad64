// SPDX-License-Identifier: Apache-2.0
#include "bench/error/statistics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace goldthread::bench {
namespace {

using Picture = std::vector<Color>;

TEST(Statistics, TheMedianIsTheMiddleOneOrTheMeanOfTwo) {
  EXPECT_EQ(median({3, 1, 2}), 2);
  EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
  EXPECT_EQ(median({7}), 7);
  EXPECT_TRUE(std::isnan(median({})));
}

TEST(Statistics, ASummaryHoldsQuickestMedianAndCount) {
  const std::vector<double> times{0.3, 0.1, 0.9};
  const Seconds seconds = summarize(times);
  EXPECT_EQ(seconds.minimum, 0.1);
  EXPECT_EQ(seconds.median, 0.3);
  EXPECT_EQ(seconds.count, 3);
  EXPECT_EQ(summarize({}).count, 0);
}

TEST(Statistics, APictureIsNoDistanceFromItself) {
  const Picture picture{{0.1, 0.2, 0.3}, {1, 0, 0.5}};
  const PictureError error = picture_error(picture, picture);
  EXPECT_EQ(error.rms, 0);
  EXPECT_EQ(error.percentile_999, 0);
  EXPECT_EQ(error.maximum, 0);
  EXPECT_EQ(error.share_off_by_32, 0);
}

TEST(Statistics, AConstantDifferenceIsTheRmsAndTheMaximum) {
  const Picture reference(50, Color(0.25)), shown(50, Color(0.25 + 3 / 255.0));
  const PictureError error = picture_error(shown, reference);
  EXPECT_NEAR(error.rms, 3, 1e-9);
  EXPECT_NEAR(error.percentile_999, 3, 1e-9);
  EXPECT_NEAR(error.maximum, 3, 1e-9);
}

TEST(Statistics, OneChannelOfOnePixelCountsByItsShareOfTheSquares) {
  Picture reference(100, Color(0)), shown(100, Color(0));
  shown[17].g = 60 / 255.0;
  const PictureError error = picture_error(shown, reference);
  EXPECT_NEAR(error.rms, 60 / std::sqrt(300.0), 1e-9);
  EXPECT_NEAR(error.maximum, 60, 1e-9);
  EXPECT_NEAR(error.share_off_by_32, 0.01, 1e-12);
}

TEST(Statistics, APixelOffBy32IsNotYetOffByMore) {
  const Picture reference(1, Color(0));
  EXPECT_EQ(picture_error(Picture(1, Color(31.9 / 255)), reference).share_off_by_32, 0);
  EXPECT_EQ(picture_error(Picture(1, Color(32.1 / 255)), reference).share_off_by_32, 1);
}

TEST(Statistics, The999thPercentileLeavesOutOnePixelInAThousand) {
  Picture reference(2000, Color(0)), shown(2000, Color(0));
  shown[0].r = 200 / 255.0;
  shown[1].r = 100 / 255.0;
  shown[2].r = 50 / 255.0;
  EXPECT_NEAR(picture_error(shown, reference).percentile_999, 50, 1e-9);
}

TEST(Statistics, NotANumberIsAsWrongAsCanBe) {
  const Picture shown(1, Color(std::numeric_limits<double>::quiet_NaN()));
  const PictureError error = picture_error(shown, Picture(1, Color(0)));
  EXPECT_EQ(error.rms, 255);
  EXPECT_EQ(error.maximum, 255);
}

TEST(Statistics, WhatIsDisplayedIsOverTheBackgroundAndWithinRange) {
  EXPECT_EQ(displayed(Color(0.25), 0.5, Color(0.5), false), Color(0.5));
  EXPECT_EQ(displayed(Color(2), 1, Color(0), false), Color(1));
  EXPECT_EQ(displayed(Color(-1), 0, Color(0), false), Color(0));
  // Linear light is encoded, and the background, a displayed colour, comes back as it was.
  EXPECT_NEAR(displayed(Color(0), 0, Color(0.4), true).r, 0.4, 1e-12);
  EXPECT_NEAR(displayed(Color(0.214041140482), 1, Color(0), true).g, 0.5, 1e-9);
}

TEST(Statistics, CandidateShiftsAreHalfPixelsUpToOneTheNearestFirst) {
  const auto shifts = candidate_shifts();
  EXPECT_EQ(shifts.size(), 25u);
  EXPECT_EQ(shifts.front(), Shift{});
  EXPECT_THAT(shifts, testing::Contains(Shift{-1, 0.5}));
  EXPECT_EQ(std::hypot(shifts.back().x, shifts.back().y), std::sqrt(2.0));
}

TEST(Statistics, TheBestAlignmentUndoesAShift) {
  // A picture of x + 10 y, sampled half a pixel to the right and one up.
  const auto sampled = [](Shift shift) {
    Picture picture;
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 8; ++x)
        picture.emplace_back(((x + shift.x) + 10 * (y + shift.y)) / 255.0, 0, 0);
    return picture;
  };
  const Alignment best = best_alignment(sampled({0.5, -1}), sampled);
  EXPECT_EQ(best.shift, (Shift{0.5, -1}));
  EXPECT_EQ(best.error.rms, 0);
}

TEST(Statistics, AlignmentPrefersNoShiftAmongEquals) {
  const Picture flat(9, Color(0.5));
  EXPECT_EQ(best_alignment(flat, [&](Shift) { return flat; }).shift, Shift{});
}

TEST(Statistics, TheOrderOfASquareLawIsTwo) {
  EXPECT_NEAR(order_between(2, 12, 0.5, 0.75), 2, 1e-12);
  EXPECT_NEAR(order_between(1, 3, 0.5, 1.5), 1, 1e-12);
}

}  // namespace
}  // namespace goldthread::bench
