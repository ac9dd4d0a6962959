#pragma once
// What those who watch a job are told of the farm.
#include "host/farm/assignment.h"
#include "host/farm/job_result.h"
#include "host/view/watcher.h"
#include "protocol/traffic_meter.h"

namespace rayfarm {

/// All but the stage and its times.
FarmStatus status_of(const JobResult& result, const TrafficMeter& meter, const Assignment& assignment);

}  // namespace rayfarm
