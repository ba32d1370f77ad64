// SPDX-License-Identifier: Apache-2.0
#pragma once
// Rays as bytes of messages, and back. Pure; bytes that do not fit are refused.

#include <optional>

#include "common/protocol/messages.h"
#include "worker/slabs/slab_source.h"

namespace goldthread {

AdvanceRays request_of(const RayBatch& batch, Epoch epoch, std::uint32_t job);
/// The rays of a request; nothing if its bytes are not as many as its count says, with what was met
/// exactly if `with_surfaces`.
std::optional<RayBatch> batch_of(const AdvanceRays& request, bool with_surfaces);

RaysAdvanced answer_of(const RayBatch& batch, Epoch epoch, std::uint32_t job);
/// Puts an answer into the batch that was asked for; false if it does not fit.
bool take_answer(const RaysAdvanced& answer, RayBatch& batch);

}  // namespace goldthread
