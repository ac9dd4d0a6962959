#pragma once
// What Weghorst, Hooper and Greenberg found, asked of our numbers.
#include "host/experiments/bounding-volumes/bounding_page.h"

namespace rayfarm {

struct BoundingRelation {
  std::string what, theirs, ours;
  bool holds;
  std::string why;  ///< it does not: by what was measured
};

std::vector<BoundingRelation> bounding_relations(const BoundingResults& results);

/// b·B + i·I of all rays of a picture.
double search_cost_ns(const EnvironmentRun& environment, size_t combination);

}  // namespace rayfarm
