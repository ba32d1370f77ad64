// SPDX-License-Identifier: Apache-2.0
#pragma once
// Other renderers on the same job: the volume as a raw file, camera and materials as JSON, and a
// process that renders them. A peer knows neither directions of a grid nor linear colours: the
// camera is given to it in the grid's own frame.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/error/process.h"
#include "bench/error/statistics.h"
#include "bench/error/subject.h"

namespace goldthread::bench {

struct PeerSettings {
  std::filesystem::path folder;   ///< for what is exchanged with peers
  std::filesystem::path program;  ///< goldthread itself, for the time from start to picture
  int threads = 1;
};

/// Where the peers' scripts are, and ParaView's pvbatch: installed, or unpacked by launch/peers.
std::filesystem::path peer_script(const std::string& name);
std::filesystem::path pvbatch();

/// What all peers are told. Throws PeerFailure for a scene that they cannot follow: a sheared grid,
/// linear colours.
class PeerJob {
 public:
  PeerJob(const Subject& subject, const PeerSettings& settings);
  const std::filesystem::path& file() const { return file_; }
  /// The same job, to be rendered in this look and step without being asked.
  std::filesystem::path variant(Look look, double step_mm) const;

 private:
  std::filesystem::path folder_;
  std::filesystem::path file_;
  std::string text_;
};

/// VTK in a process that waits for commands. Each call throws PeerFailure.
class VtkPeer {
 public:
  VtkPeer(const PeerJob& job, const PeerSettings& settings, const VirtualDisplay& display);
  const std::string& version() const { return version_; }
  double frame_seconds(Look look, double step_mm, ImageSize size);
  double isovalue_seconds(double value, double back);
  /// The subset's pixels of a picture in this look.
  std::vector<Color> picture(Look look, double step_mm, ImageSize size, int stride);

 private:
  std::filesystem::path folder_;
  ChildProcess process_;
  std::string version_;
};

/// Seconds from the start of a process to its end with a first picture written.
double vtk_first_picture_seconds(const std::filesystem::path& job, const PeerSettings& settings,
                                 const VirtualDisplay& display);
double own_first_picture_seconds(const Scene& scene, const PeerSettings& settings);

/// ParaView's pvbatch, all frames at once: its processes use their cores even while they wait.
struct ParaViewFrames {
  std::string version;
  std::string mapper;
  std::vector<double> seconds;
  std::vector<Color> picture;
};
constexpr int kParaViewRanks = 2;
ParaViewFrames run_paraview(const PeerJob& job, const PeerSettings& settings, int frames,
                            ImageSize size, int stride, const VirtualDisplay& display);

}  // namespace goldthread::bench
