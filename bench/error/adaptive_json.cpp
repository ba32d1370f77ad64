// SPDX-License-Identifier: Apache-2.0
#include "bench/error/adaptive_json.h"

namespace goldthread::bench {
namespace {

using Json = nlohmann::ordered_json;

Json json_of_size(ImageSize size) { return {size.width, size.height}; }

Json row_json(const AdaptiveRow& row) {
  return {{"look", name_of(row.look)},
          {"size", json_of_size(row.size)},
          {"target", row.target},
          {"stepVoxels", row.step_voxels > 0 ? Json(row.step_voxels) : Json("default")},
          {"seconds", json_of(row.seconds)},
          {"cpuSeconds", row.cpu_seconds},
          {"castSeconds", row.cast_seconds},
          {"overhead", row.overhead()},
          {"steps", row.steps},
          {"rays", row.rays},
          {"estimatedRms", row.estimated},
          {"trueRms", row.rms}};
}

Json row_json(const EveryPixelRow& row) {
  return {{"program", row.program},
          {"look", name_of(row.look)},
          {"size", json_of_size(row.size)},
          {"stepVoxels", row.step_voxels > 0 ? Json(row.step_voxels) : Json("default")},
          {"seconds", json_of(row.seconds)},
          {"trueRms", row.rms}};
}

Json row_json(const CalibrationRow& row) {
  return {
      {"look", name_of(row.look)},     {"step", row.step},   {"raysPerPixel", row.rays_per_pixel},
      {"estimatedRms", row.estimated}, {"trueRms", row.rms}, {"ratio", row.ratio()}};
}

Json row_json(const FirstPictureRow& row) {
  return {{"look", name_of(row.look)},
          {"size", json_of_size(row.size)},
          {"step", row.step},
          {"seconds", json_of(row.seconds)},
          {"trueRms", row.rms}};
}

Json row_json(const TruthRow& row) {
  return {{"look", name_of(row.look)}, {"size", json_of_size(row.size)},
          {"stride", row.stride},      {"raysPerPixel", row.rays_per_pixel},
          {"rmsCoarser", row.coarser}, {"seconds", row.seconds}};
}

template <class Row>
Json rows_json(const std::vector<Row>& rows) {
  Json list = Json::array();
  for (const Row& row : rows) list.push_back(row_json(row));
  return list;
}

}  // namespace

Json json_of(const AdaptiveReport& report) {
  return {{"tilePixels", report.tile_px},
          {"rows", rows_json(report.rows)},
          {"raySteps", rows_json(report.ray_steps)},
          {"everyPixel", rows_json(report.every_pixel)},
          {"calibration", rows_json(report.calibration)},
          {"firstPictures", rows_json(report.first_pictures)},
          {"truths", rows_json(report.truths)}};
}

Json json_of(const InterruptRow& row) {
  return {{"look", name_of(row.look)},
          {"size", json_of_size(row.size)},
          {"interrupts", row.count},
          {"medianSeconds", row.median},
          {"percentile99Seconds", row.percentile_99},
          {"batchMedianSeconds", row.batch_median},
          {"batchPercentile99Seconds", row.batch_percentile_99}};
}

}  // namespace goldthread::bench
