// SPDX-License-Identifier: Apache-2.0
#include "bench/error/peers.h"

#include <unistd.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/image/image_file.h"
#include "common/scene/scene_file.h"

namespace goldthread::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr std::chrono::seconds kPatience{180};

Json list_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw PeerFailure(file.string() + " cannot be written");
}

/// The grid without its place in the world: axes that peers take as x, y and z. A left-handed grid
/// is turned over along x, which its voxels must follow.
struct GridFrame {
  glm::dmat3 axes;
  glm::dvec3 origin;
  bool flip_x = false;

  explicit GridFrame(const VolumeGeometry& geometry)
      : axes(geometry.direction), origin(geometry.origin_mm) {
    const glm::dmat3 gram = glm::transpose(axes) * axes;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (std::abs(gram[i][j] - (i == j)) > 1e-4)
          throw PeerFailure("the volume's grid is sheared");
    if (glm::determinant(axes) > 0) return;
    flip_x = true;
    origin += axes[0] * (geometry.spacing_mm.x * (geometry.size.x - 1));
    axes[0] = -axes[0];
  }
  glm::dvec3 point(const glm::dvec3& world) const { return vector(world - origin); }
  glm::dvec3 vector(const glm::dvec3& world) const { return glm::transpose(axes) * world; }
};

template <class T>
void append_row(std::string& bytes, const Volume& volume, bool flip, int j, int k) {
  const int width = volume.info().geometry.size.x;
  for (int i = 0; i < width; ++i) {
    const T value = static_cast<T>(volume.at(flip ? width - 1 - i : i, j, k));
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
}

void append_row(std::string& bytes, const Volume& volume, bool flip, int j, int k) {
  switch (volume.info().type) {
    case VoxelType::kUInt8:
      return append_row<std::uint8_t>(bytes, volume, flip, j, k);
    case VoxelType::kInt8:
      return append_row<std::int8_t>(bytes, volume, flip, j, k);
    case VoxelType::kUInt16:
      return append_row<std::uint16_t>(bytes, volume, flip, j, k);
    case VoxelType::kInt16:
      return append_row<std::int16_t>(bytes, volume, flip, j, k);
    case VoxelType::kFloat32:
      return append_row<float>(bytes, volume, flip, j, k);
  }
}

void write_raw(const std::filesystem::path& file, const Volume& volume, bool flip) {
  std::ofstream stream(file, std::ios::binary);
  const glm::ivec3 size = volume.info().geometry.size;
  for (int k = 0; k < size.z; ++k)
    for (int j = 0; j < size.y; ++j) {
      std::string bytes;
      append_row(bytes, volume, flip, j, k);
      stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    }
  stream.close();
  if (!stream) throw PeerFailure(file.string() + " cannot be written");
}

Json job_of(const Subject& subject, const PeerSettings& settings, const GridFrame& frame,
            const std::filesystem::path& raw) {
  const VolumeInfo& info = subject.volume->info();
  const SceneVolume& material = subject.scene.volumes.front();
  const Camera& camera = *subject.scene.camera;
  const Shading shading = material.shading.value_or(Shading{});
  Json color = Json::array(), opacity = Json::array();
  for (const ColorNode& node : material.transfer_function->color)
    color.push_back({node.value, node.rgb.r, node.rgb.g, node.rgb.b});
  for (const OpacityNode& node : material.transfer_function->opacity)
    opacity.push_back({node.value, node.alpha});
  const glm::ivec3 size = info.geometry.size;
  return {{"volume",
           {{"file", raw.string()},
            // A reader of the original would not turn it over.
            {"original", frame.flip_x ? "" : std::filesystem::absolute(info.file).string()},
            {"type", name_of(info.type)},
            {"size", {size.x, size.y, size.z}},
            {"spacing", list_of(info.geometry.spacing_mm)}}},
          {"imageSize", {subject.scene.image.size.width, subject.scene.image.size.height}},
          {"background", list_of(subject.scene.image.background)},
          {"threads", settings.threads},
          {"camera",
           {{"position", list_of(frame.point(camera.position))},
            {"target", list_of(frame.point(camera.target))},
            {"up", list_of(frame.vector(camera.up))},
            {"fovy", camera.fovy_deg}}},
          {"color", color},
          {"opacity", opacity},
          {"unitDistance", material.transfer_function->unit_distance_mm},
          {"shading",
           {{"ambient", shading.ambient},
            {"diffuse", shading.diffuse},
            {"specular", shading.specular},
            {"shininess", shading.shininess}}},
          {"isosurface", {{"value", subject.isovalue}, {"color", {0.9, 0.8, 0.7}}}}};
}

std::vector<Color> read_picture(const std::filesystem::path& file, ImageSize size, int stride) {
  const auto image = read_image(file);
  if (!image) throw PeerFailure("its picture: " + image.failure().what);
  if (image->size != size || image->channels < 3) throw PeerFailure("its picture has another size");
  std::vector<Color> colors;
  for (int y = 0; y < size.height; y += stride)
    for (int x = 0; x < size.width; x += stride) {
      const float* pixel =
          &image->pixels[(std::size_t(y) * std::size_t(size.width) + std::size_t(x)) *
                         std::size_t(image->channels)];
      colors.emplace_back(pixel[0], pixel[1], pixel[2]);
    }
  return colors;
}

/// With the display, and with as many threads for what is drawn in software as for the rest.
std::vector<std::string> command_of(const PeerSettings& settings, const VirtualDisplay& display,
                                    const std::vector<std::string>& words) {
  const std::string threads = std::to_string(settings.threads);
  std::vector<std::string> command{"env", "DISPLAY=" + display.name(), "LP_NUM_THREADS=" + threads,
                                   "VTK_SMP_MAX_THREADS=" + threads, "LIBGL_ALWAYS_SOFTWARE=1"};
  command.insert(command.end(), words.begin(), words.end());
  return command;
}

std::vector<std::string> vtk_command(const std::filesystem::path& job) {
  // Debian's own Python: another one in PATH would not have Debian's VTK.
  return {"/usr/bin/python3", peer_script("vtk_peer.py").string(), job.string()};
}

Json answer_of(ChildProcess& process, const Json& request) {
  process.send(request.dump());
  for (;;) {
    const std::string line = process.receive(kPatience);
    if (!line.starts_with('{')) continue;  // what a library has to say
    Json answer = Json::parse(line, nullptr, false);
    if (answer.is_discarded()) throw PeerFailure("answers something else than JSON");
    return answer;
  }
}

double seconds_in(const Json& answer) {
  const auto seconds = answer.find("seconds");
  if (seconds == answer.end() || !seconds->is_number()) throw PeerFailure("tells no time");
  return seconds->get<double>();
}

double seconds_of_process(const std::vector<std::string>& command,
                          const std::filesystem::path& log) {
  const auto start = Clock::now();
  ChildProcess process(command, log);
  process.wait(kPatience);
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

std::filesystem::path peer_script(const std::string& name) {
  for (const char* folder :
       {GOLDTHREAD_SOURCE_DIR "/bench/error/peers", GOLDTHREAD_INSTALLED_PEERS}) {
    auto file = std::filesystem::path(folder) / name;
    if (std::filesystem::exists(file)) return file;
  }
  throw PeerFailure("its script " + name + " is not installed");
}

std::filesystem::path pvbatch() {
  for (const char* file : {GOLDTHREAD_SOURCE_DIR "/build/peers/pvbatch", "/usr/bin/pvbatch"})
    if (access(file, X_OK) == 0) return file;
  throw PeerFailure("pvbatch is not installed (launch/peers installs it)");
}

PeerJob::PeerJob(const Subject& subject, const PeerSettings& settings)
    : folder_(std::filesystem::absolute(settings.folder)), file_(folder_ / "job.json") {
  if (subject.scene.image.color_space == ColorSpace::kLinear)
    throw PeerFailure("the scene's colours are linear");
  const GridFrame frame(subject.volume->info().geometry);
  const auto raw = folder_ / "volume.raw";
  write_raw(raw, *subject.volume, frame.flip_x);
  text_ = job_of(subject, settings, frame, raw).dump(1);
  write_text(file_, text_);
}

std::filesystem::path PeerJob::variant(Look look, double step_mm) const {
  Json job = Json::parse(text_);
  job["look"] = name_of(look);
  job["step"] = step_mm;
  auto file = folder_ / "first_picture_job.json";
  write_text(file, job.dump(1));
  return file;
}

VtkPeer::VtkPeer(const PeerJob& job, const PeerSettings& settings, const VirtualDisplay& display)
    : folder_(std::filesystem::absolute(settings.folder)),
      process_(command_of(settings, display, vtk_command(job.file())), folder_ / "vtk.log") {
  const Json about = answer_of(process_, {{"command", "about"}});
  version_ = about.value("version", "") + ", " + about.value("backend", "") + " threads";
}

double VtkPeer::frame_seconds(Look look, double step_mm, ImageSize size) {
  return seconds_in(answer_of(process_, {{"command", "frame"},
                                         {"look", name_of(look)},
                                         {"step", step_mm},
                                         {"size", {size.width, size.height}}}));
}

double VtkPeer::isovalue_seconds(double value, double back) {
  return seconds_in(
      answer_of(process_, {{"command", "isovalue"}, {"value", value}, {"back", back}}));
}

std::vector<Color> VtkPeer::picture(Look look, double step_mm, ImageSize size, int stride) {
  const auto file = folder_ / (std::string("vtk_") + name_of(look) + ".png");
  answer_of(process_, {{"command", "picture"},
                       {"look", name_of(look)},
                       {"step", step_mm},
                       {"size", {size.width, size.height}},
                       {"file", file.string()}});
  return read_picture(file, size, stride);
}

double vtk_first_picture_seconds(const std::filesystem::path& job, const PeerSettings& settings,
                                 const VirtualDisplay& display) {
  const auto folder = std::filesystem::absolute(settings.folder);
  auto words = vtk_command(job);
  words.insert(words.end(), {"--first-picture", (folder / "vtk_first.png").string()});
  return seconds_of_process(command_of(settings, display, words), folder / "vtk_first.log");
}

double own_first_picture_seconds(const Scene& scene, const PeerSettings& settings) {
  const auto folder = std::filesystem::absolute(settings.folder);
  const auto file = folder / "scene.json";
  Scene written = scene;
  for (SceneVolume& volume : written.volumes) volume.file = std::filesystem::absolute(volume.file);
  write_text(file, scene_to_json(written));
  return seconds_of_process(
      {settings.program.string(), "render", file.string(), "-o", (folder / "first.png").string(),
       "--threads", std::to_string(settings.threads)},
      folder / "goldthread_first.log");
}

ParaViewFrames run_paraview(const PeerJob& job, const PeerSettings& settings, int frames,
                            ImageSize size, int stride, const VirtualDisplay& display) {
  const auto folder = std::filesystem::absolute(settings.folder);
  const auto result = folder / "paraview.json", picture = folder / "paraview.png";
  std::filesystem::remove(result);
  std::vector<std::string> words{"mpirun", "-n", std::to_string(kParaViewRanks)};
  if (geteuid() == 0) words.emplace_back("--allow-run-as-root");
  // The same share of the cores for each rank.
  PeerSettings share = settings;
  share.threads = std::max(1, settings.threads / kParaViewRanks);
  for (const std::string& word : {std::string("--oversubscribe"), pvbatch().string(),
                                  peer_script("paraview_peer.py").string(), job.file().string(),
                                  std::to_string(frames), result.string(), picture.string()})
    words.push_back(word);
  seconds_of_process(command_of(share, display, words), folder / "paraview.log");
  std::ifstream stream(result);
  const Json answer = Json::parse(stream, nullptr, false);
  if (!answer.is_object() || !answer.contains("seconds"))
    throw PeerFailure("ParaView tells no time");
  return {answer.value("version", ""), answer.value("mapper", ""),
          answer["seconds"].get<std::vector<double>>(), read_picture(picture, size, stride)};
}

}  // namespace goldthread::bench
