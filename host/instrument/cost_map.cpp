#include "host/instrument/cost_map.h"

#include "common/errors/input_error.h"
#include "host/files/json.h"
#include "host/files/text_file.h"

namespace rayfarm {

void write_cost_map(const std::string& path, const JobResult& result, const SubpolygonGrid& grid) {
  Json j;
  j["width"] = grid.width;
  j["height"] = grid.height;
  j["columns"] = grid.columns;
  j["rows"] = grid.rows;
  j["frames"] = Json::Array();
  for (const FrameResult& frame : result.frames) {
    if (!frame.is_written || frame.is_resumed) continue;  // what was resumed cost nothing now
    Json::Array seconds, bytes;
    for (SubpolygonId i; i.value() < grid.count(); ++i) {
      const DisplayPolygon p = grid.polygon(i);
      const double pixels = double(p.right - p.left + 1) * (p.bottom - p.top + 1);
      seconds.push_back(frame.costs[i.place()].busy_s / pixels);
      bytes.push_back(static_cast<double>(frame.costs[i.place()].bytes) / pixels);
    }
    j["frames"].push_back(
        Json::Object{{"frame", frame.frame.value()}, {"pixel_s", seconds}, {"pixel_bytes", bytes}});
  }
  write_text_file(path, j.dump() + "\n");
}

CostMap read_cost_map(const std::string& path) {
  try {
    const JsonView j = JsonView::read_file(path);
    CostMap map;
    map.width_px = j.at("width").integer();
    map.height_px = j.at("height").integer();
    map.columns = j.at("columns").integer();
    map.rows = j.at("rows").integer();
    map.frames = static_cast<int>(j.at("frames").size());
    map.pixel_s.clear();
    map.pixel_bytes.clear();
    const size_t cells =
        static_cast<size_t>(std::max(0, map.columns)) * static_cast<size_t>(std::max(0, map.rows));
    for (const JsonView& frame : j.at("frames").elements()) {
      const std::vector<double> seconds = frame.at("pixel_s").numbers(),
                                bytes = frame.at("pixel_bytes").numbers();
      if (seconds.size() != cells || bytes.size() != cells)
        throw InputError({path},
                         "a frame has not as many cells as the map says; write it anew with --cost-map");
      map.pixel_s.insert(map.pixel_s.end(), seconds.begin(), seconds.end());
      map.pixel_bytes.insert(map.pixel_bytes.end(), bytes.begin(), bytes.end());
    }
    if (map.frames == 0) throw InputError({path}, "the cost map holds no frame");
    return map;
  } catch (const JsonError& e) {
    throw InputError({path},
                     fmt::format("not a cost map ({}); `rayfarm render --cost-map` writes them", e.what()));
  }
}

}  // namespace rayfarm
