// SPDX-License-Identifier: Apache-2.0
#pragma once
// A volume that arrives slice by slice; internal to volume_io. Slices may differ in type (DICOM's
// rescaling is chosen per slice): what came before then becomes float32.

#include <cstddef>
#include <memory>
#include <span>

#include "common/base/result.h"
#include "common/volume/stored_type.h"
#include "common/volume/volume_io.h"

namespace goldthread {

class SliceAssembly {
 public:
  /// Takes over `loaded`, whose info lacks only its type; slices are those of its geometry.
  explicit SliceAssembly(LoadedVolume loaded) : loaded_(std::move(loaded)) {}

  /// The next slice: interleaved components of `type`.
  std::optional<Failure> add(std::span<const std::byte> pixels, StoredType type);
  /// After the last slice.
  LoadedVolume finish() && { return std::move(loaded_); }

 private:
  std::optional<Failure> begin(StoredType type);
  std::optional<Failure> become_float();
  std::size_t slice_voxels() const;

  LoadedVolume loaded_;
  StoredType type_{};
  int slices_ = 0;
};

}  // namespace goldthread
