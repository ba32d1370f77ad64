// SPDX-License-Identifier: Apache-2.0
#include "worker/slabs/ray_messages.h"

#include <cstring>
#include <span>

namespace goldthread {
namespace {

/// Writes columns one behind the other.
class Packer {
 public:
  explicit Packer(std::byte* to) : to_(to) {}
  template <class T>
  void put(const std::vector<T>& column) {
    const auto bytes = std::as_bytes(std::span(column));
    if (!bytes.empty()) std::memcpy(to_, bytes.data(), bytes.size());
    to_ += bytes.size();
  }

 private:
  std::byte* to_;
};

class Unpacker {
 public:
  explicit Unpacker(const std::byte* from) : from_(from) {}
  template <class T>
  void take(std::vector<T>& column) {
    const auto bytes = std::as_writable_bytes(std::span(column));
    if (!bytes.empty()) std::memcpy(bytes.data(), from_, bytes.size());
    from_ += bytes.size();
  }

 private:
  const std::byte* from_;
};

std::size_t gathered_bytes(std::size_t rays, bool with_surfaces) {
  return rays * (sizeof(Sample) + (with_surfaces ? sizeof(std::uint32_t) : 0));
}

}  // namespace

AdvanceRays request_of(const RayBatch& batch, Epoch epoch, std::uint32_t job) {
  const std::size_t count = batch.positions.size();
  AdvanceRays request{
      epoch, job, batch.stage.completes, static_cast<std::uint32_t>(count),
      Buffer(count * sizeof(PixelPosition) + gathered_bytes(count, !batch.surfaces.empty()))};
  Packer packer(request.packed.data());
  packer.put(batch.positions);
  packer.put(batch.samples);
  packer.put(batch.surfaces);
  return request;
}

std::optional<RayBatch> batch_of(const AdvanceRays& request, bool with_surfaces) {
  const std::size_t count = request.count;
  if (request.packed.size() != count * sizeof(PixelPosition) + gathered_bytes(count, with_surfaces))
    return {};
  RayBatch batch{request.completes ? kComplete : kGather, std::vector<PixelPosition>(count),
                 std::vector<Sample>(count), std::vector<std::uint32_t>(with_surfaces ? count : 0)};
  Unpacker unpacker(request.packed.data());
  unpacker.take(batch.positions);
  unpacker.take(batch.samples);
  unpacker.take(batch.surfaces);
  return batch;
}

RaysAdvanced answer_of(const RayBatch& batch, Epoch epoch, std::uint32_t job) {
  RaysAdvanced answer{epoch, job, batch.taken,
                      Buffer(gathered_bytes(batch.samples.size(), !batch.surfaces.empty()))};
  Packer packer(answer.packed.data());
  packer.put(batch.samples);
  packer.put(batch.surfaces);
  return answer;
}

bool take_answer(const RaysAdvanced& answer, RayBatch& batch) {
  if (answer.packed.size() != gathered_bytes(batch.samples.size(), !batch.surfaces.empty()))
    return false;
  Unpacker unpacker(answer.packed.data());
  unpacker.take(batch.samples);
  unpacker.take(batch.surfaces);
  batch.taken = answer.taken;
  return true;
}

}  // namespace goldthread
