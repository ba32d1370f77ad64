// SPDX-License-Identifier: Apache-2.0
// `goldthread serve`: an interactive session in a browser.

#include <spdlog/spdlog.h>

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>
#include <string>

#include "common/scene/resolve.h"
#include "common/transport/shared_memory.h"
#include "compositor/gateway/address_hint.h"
#include "master/main/program.h"
#include "master/main/progress.h"
#include "master/main/scene_setup.h"
#include "master/serve_job.h"

namespace goldthread {
namespace {

/// 128 bits from the system's source, in hexadecimal.
std::string random_token() {
  std::random_device device;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", device());
  return token;
}

}  // namespace

void run_serve(Cluster& cluster, const Options& options) {
  Scene scene = scene_of(options);
  const bool size_given = options.size || scene.image.size_given;
  const std::string token = options.token.value_or(random_token());
  std::optional<Progress> progress;

  ServeRequest request;
  request.host = options.host;
  request.port = options.port;
  request.token = token;
  if (size_given) request.size = scene.image.size;
  request.tiles = tile_choice_of(options);
  request.stop = stop_rule_of(options);
  request.display = {options.filter, options.update, false};
  request.resolve = resolve_scene;
  request.step_mm = [stop = request.stop](const Scene& s, const VolumeInfo& info) {
    return step_of(s, info, stop);
  };
  request.ended = interrupted;
  request.worker_lost = log_lost_worker;
  request.opened = [&](std::uint16_t port) {
    const AddressHint hint = address_hint(options.host, port, token, host_name());
    std::printf("%s\n", hint.url.c_str());
    std::fflush(stdout);
    spdlog::info("from another machine: {}  then open {}", hint.ssh_line, hint.ssh_url);
    progress.emplace("reading " + scene.volumes.front().file.filename().string());
  };
  request.progress = [&](double fraction) { progress->update(fraction); };
  request.loaded = [&](const VolumeInfo& info) {
    progress.reset();
    log_volume(info);
  };
  ServeJob(cluster, scene, std::move(request)).run();
  spdlog::info("the session has ended");
}

}  // namespace goldthread
