// SPDX-License-Identifier: Apache-2.0
#include "worker/kernels/packet_size.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace goldthread {
namespace {

constexpr std::size_t kMost = 16;
using Rays = std::vector<PixelPosition>;

/// The pixels of a block of 4×4, row by row, without the first `skipped`.
Rays block(float x, float y, int skipped = 0) {
  Rays rays;
  for (int i = skipped; i < 16; ++i)
    rays.push_back({x + 0.5F + float(i % 4), y + 0.5F + float(i / 4)});
  return rays;
}
Rays operator+(Rays first, const Rays& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

TEST(PacketSize, ABlockIsAPacket) { EXPECT_EQ(packet_size(block(0, 0) + block(4, 0), kMost), 16u); }

TEST(PacketSize, ABlockWithoutItsCornerIsFilledUpFromTheNextOne) {
  EXPECT_EQ(packet_size(block(0, 0, 1) + block(4, 0, 1), kMost), 16u);
}

TEST(PacketSize, WhatIsNearIsNotSpoiledByWhatIsFar) {
  EXPECT_EQ(packet_size(block(0, 0, 1) + block(40, 0, 1), kMost), 15u);
  EXPECT_EQ(packet_size(block(0, 0, 8) + block(0, 40), kMost), 8u);
}

TEST(PacketSize, LessThanHalfAPacketIsFilledUpFromAnywhere) {
  EXPECT_EQ(packet_size(block(0, 0, 9) + block(40, 40), kMost), 16u);
}

TEST(PacketSize, ScatteredRaysFillPackets) {
  Rays rays;
  for (int i = 0; i < 40; ++i) rays.push_back({float(16 * (i % 4)), float(16 * (i / 4))});
  EXPECT_EQ(packet_size(rays, kMost), 16u);
}

TEST(PacketSize, AListEnds) {
  for (std::size_t count = 1; count <= kMost; ++count) {
    const Rays rays = block(0, 0, static_cast<int>(kMost - count));
    EXPECT_EQ(packet_size(rays, kMost), count);
  }
}

TEST(PacketSize, IsNeverNothingAndNeverTooMuch) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> anywhere(-30, 30);
  for (int i = 0; i < 10000; ++i) {
    Rays rays(1 + random() % 40);
    for (PixelPosition& ray : rays) ray = {anywhere(random), anywhere(random)};
    const std::size_t size = packet_size(rays, kMost);
    EXPECT_GE(size, std::min(rays.size(), kMost / 2));
    EXPECT_LE(size, std::min(rays.size(), kMost));
  }
}

}  // namespace
}  // namespace goldthread
