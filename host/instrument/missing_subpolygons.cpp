#include "host/instrument/missing_subpolygons.h"

#include <fmt/core.h>

namespace rayfarm {

std::string tell_missing_subpolygons(const SubpolygonGrid& grid, int processors, int per_processor,
                                     int least_side) {
  const int64_t asked = int64_t{per_processor} * processors,
                room = room_for(grid.width, grid.height, least_side);
  if (room >= asked) return {};
  const int64_t pixels = int64_t{grid.width} * grid.height;
  std::string text = fmt::format("{} subpolygons for each of {} processors are {}, but the {} × {} pixels ",
                                 per_processor, processors, asked, grid.width, grid.height);
  text += pixels < asked ? fmt::format("are only {}", pixels)
                         : fmt::format("have room for only {} of at least {} × {} (--least-side)", room,
                                       least_side, least_side);
  text += fmt::format("; they are cut into {}", grid.count());
  if (grid.count() < processors)
    text += fmt::format(", so that {} processors have none in a frame", processors - grid.count());
  return text;
}

}  // namespace rayfarm
