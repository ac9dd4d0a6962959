#pragma once
// What is said at the end: a table for people, a JSON file for programs.
#include <string>

#include "common/image/image_file.h"
#include "common/scene/render_settings.h"
#include "host/job_result.h"
#include "protocol/job_plan.h"
#include "protocol/traffic_meter.h"

namespace rayfarm {

/// The thesis's result message: bytes per pixel (4.4.4.2).
inline constexpr double kModelBytesPerPixel = 9;

/// For people who want a picture: what was written, time, rays, speed, losses. At most ten lines.
std::string format_report(const JobResult& result, const TrafficMeter& meter);

/// For experimenters: traffic by command, times, rays and nodes, who traced what.
std::string format_full_report(const JobResult& result, const TrafficMeter& meter, const JobPlan& plan);

/// Writes the statistics file, whole or not at all. Throws IoError.
void write_statistics(const std::string& path, const JobResult& result, const TrafficMeter& meter,
                      const JobPlan& plan, const RenderSettings& settings, int ranks);

}  // namespace rayfarm
