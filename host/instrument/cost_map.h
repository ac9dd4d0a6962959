#pragma once
// Files of cost maps: what tracing cost, subpolygon by subpolygon, in a real render.
#include <string>

#include "host/farm/job_result.h"
#include "host/instrument/simulator.h"

namespace rayfarm {

/// Writes the costs of a job's whole frames as JSON. Throws IoError.
void write_cost_map(const std::string& path, const JobResult& result, const SubpolygonGrid& grid);

/// Throws IoError if it can't be read, InputError if it is not a cost map.
CostMap read_cost_map(const std::string& path);

}  // namespace rayfarm
