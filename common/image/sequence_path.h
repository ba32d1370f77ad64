// SPDX-License-Identifier: Apache-2.0
#pragma once
// Names of the files of a sequence: "frame%04d.png". The pattern comes from a user, so it is never
// handed to printf.

#include <string>

#include "common/base/result.h"

namespace goldthread {

/// A pattern with exactly one %d, %Nd or %0Nd (N from 1 to 9); %% stands for a per cent sign.
class SequencePath {
 public:
  /// A Failure of status kUsage if there is no conversion, more than one, or another one.
  static Result<SequencePath> parse(const std::string& pattern);

  /// `frame` must not be negative.
  std::string at(int frame) const;

 private:
  SequencePath() = default;
  std::string before_, after_;
  int width_ = 0;
  char fill_ = ' ';
};

}  // namespace goldthread
