// SPDX-License-Identifier: Apache-2.0
#include "worker/refinement/sample_sequence.h"

namespace goldthread {
namespace {

std::uint32_t reversed(std::uint32_t bits) {
  bits = (bits << 16) | (bits >> 16);
  bits = ((bits & 0x00FF00FFU) << 8) | ((bits & 0xFF00FF00U) >> 8);
  bits = ((bits & 0x0F0F0F0FU) << 4) | ((bits & 0xF0F0F0F0U) >> 4);
  bits = ((bits & 0x33333333U) << 2) | ((bits & 0xCCCCCCCCU) >> 2);
  return ((bits & 0x55555555U) << 1) | ((bits & 0xAAAAAAAAU) >> 1);
}

/// A bijection in which each bit depends on the lower ones alone, after Laine and Karras; the
/// constants are Vegdahl's.
std::uint32_t laine_karras(std::uint32_t bits, std::uint32_t seed) {
  bits ^= bits * 0x3D20ADEAU;
  bits += seed;
  bits *= (seed >> 16) | 1U;
  bits ^= bits * 0x05526C56U;
  bits ^= bits * 0x53A22864U;
  return bits;
}

/// `fraction` is a binary fraction of 32 digits.
std::uint32_t scrambled(std::uint32_t fraction, std::uint32_t seed) {
  return reversed(laine_karras(reversed(fraction), seed));
}

std::uint32_t sobol_second(std::uint32_t index) {
  std::uint32_t fraction = 0;
  for (std::uint32_t direction = 1U << 31; index != 0; index >>= 1) {
    if ((index & 1U) != 0) fraction ^= direction;
    direction ^= direction >> 1;
  }
  return fraction;
}

std::uint32_t hash(std::uint32_t x, std::uint32_t y) {
  std::uint32_t h = x * 0x9E3779B1U ^ (y * 0x85EBCA77U + 0xC2B2AE3DU);
  h = (h ^ (h >> 16)) * 0x7FEB352DU;
  h = (h ^ (h >> 15)) * 0x846CA68BU;
  return h ^ (h >> 16);
}

float unit(std::uint32_t fraction) { return static_cast<float>(fraction >> 8) * 0x1p-24F; }

}  // namespace

PixelPosition sample_position(int x, int y, std::uint32_t number) {
  const auto left = static_cast<float>(x), top = static_cast<float>(y);
  if (number == 0) return {left + 0.5F, top + 0.5F};
  const std::uint32_t seed = hash(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
  const std::uint32_t index = number - 1;
  return {left + unit(scrambled(reversed(index), seed)),
          top + unit(scrambled(sobol_second(index), hash(seed, 1)))};
}

}  // namespace goldthread
