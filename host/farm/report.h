#pragma once
// What people are told at the end.
#include <string>

#include "host/farm/job_result.h"
#include "protocol/traffic_meter.h"

namespace rayfarm {

/// The thesis's result message: bytes per pixel (4.4.4.2).
inline constexpr double kModelBytesPerPixel = 9;
/// What results of pictures weighed on the net.
uint64_t picture_result_bytes(const JobResult& result, const TrafficMeter& meter);
/// The same of each pixel that came.
double bytes_per_received_pixel(const JobResult& result, const TrafficMeter& meter);

/// For people who want a picture: what was written, time, rays, speed, losses. At most ten lines.
std::string format_report(const JobResult& result, const TrafficMeter& meter);

/// The same of a job that made no pictures. `made`: what it made, a line.
std::string format_zones_report(const JobResult& result, const std::string& made);

/// For experimenters: traffic by command, times, rays and nodes, who traced what.
std::string format_full_report(const JobResult& result, const TrafficMeter& meter);

}  // namespace rayfarm
