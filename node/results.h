#pragma once
// How a node returns what came of an item.
#include "node/node.h"

namespace rayfarm {

/// Sends a subpolygon's pixels and its report in the plan's form: as one block, or pixel by pixel. In blocks
/// goes what the next pass needs.
void send_subpolygon(Transport& transport, NodeId self, const JobPlan& plan, const DisplayPolygon& polygon,
                     const SubpolygonReport& report, uint16_t pass, const ItemResult& result);

/// Sends what came of an item of zones; `result` has all but its bytes.
void send_zones(Transport& transport, NodeId self, ZoneResult result, const Bytes& bytes);

}  // namespace rayfarm
