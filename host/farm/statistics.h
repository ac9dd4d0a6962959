#pragma once
// What programs are told at the end: a JSON file.
#include <string>

#include "common/scene/render_settings.h"
#include "host/farm/job_result.h"
#include "protocol/job_plan.h"
#include "protocol/traffic_meter.h"

namespace rayfarm {

/// Writes the statistics file, whole or not at all. Throws IoError.
void write_statistics(const std::string& path, const JobResult& result, const TrafficMeter& meter,
                      const JobPlan& plan, const RenderSettings& settings, int ranks);

}  // namespace rayfarm
