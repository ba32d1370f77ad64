// SPDX-License-Identifier: Apache-2.0
#pragma once
// A fixture whose tests run once on each instruction set that this machine has.

#include <gtest/gtest.h>

#include <string>

#include "worker/kernels/kernel_table.h"

namespace goldthread::test {

class EveryInstructionSet : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { force_instruction_set(GetParam()); }
  void TearDown() override { force_instruction_set(""); }
};

}  // namespace goldthread::test

/// Instantiates a suite whose class derives from EveryInstructionSet.
#define GOLDTHREAD_ON_EVERY_INSTRUCTION_SET(suite)                                       \
  INSTANTIATE_TEST_SUITE_P(, suite, testing::ValuesIn(::goldthread::instruction_sets()), \
                           [](const auto& set) { return set.param; })
