// SPDX-License-Identifier: Apache-2.0
#pragma once
// Whether compressing pays on a link: if it takes less time off the wire than it takes from the
// cores at both ends. Pure: estimates in, decision out.

namespace goldthread {

/// Running estimates of what the codec does with what is sent.
struct CodecEstimate {
  double ratio = 1;                   ///< bytes sent / raw bytes
  double compress_bytes_per_s = 0;    ///< raw bytes a core takes in
  double decompress_bytes_per_s = 0;  ///< raw bytes a core gives out
};

/// What a second of a core is worth at each end: 1 where it would compute a picture or hold others
/// up, less where it would mostly wait.
struct CoreNeed {
  double sender = 1;
  double receiver = 1;
};

class CompressionChoice {
 public:
  explicit CompressionChoice(CoreNeed need) : need_(need) {}
  /// By what the link carries (bytes/s, raw or not) and the codec does. Changes its mind only
  /// where the other choice is better by more than estimates wander.
  bool decide(double link_bytes_per_s, const CodecEstimate& codec);
  bool on() const { return on_; }

 private:
  CoreNeed need_;
  bool on_ = false;
};

}  // namespace goldthread
