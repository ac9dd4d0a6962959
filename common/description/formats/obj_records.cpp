#include "common/description/formats/obj_records.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

namespace rayfarm {
namespace {

constexpr size_t kMostKinds = 24;  // of what is not used: a file of rubbish has many

/// Corners are `v`, `v/vt`, `v//vn` or `v/vt/vn`, whole numbers other than 0.
bool is_corner(std::string_view word) {
  const char* at = word.data();
  const char* const end = at + word.size();
  for (int part = 0; part < 3; ++part) {
    const bool is_left_out = part == 1 && at != end && *at == '/';
    if (!is_left_out) {
      int index = 0;
      const auto [stop, error] = std::from_chars(at, end, index);
      if (error != std::errc{} || index == 0) return false;
      at = stop;
    }
    if (at == end) return true;
    if (*at++ != '/') return false;
  }
  return false;
}

}  // namespace

ObjRecords::ObjRecords(SceneDescription& scene, std::string_view text, const std::string& path,
                       uint32_t material, const std::stop_token& stop)
    : scene_(scene), path_(path), stop_(stop), records_(text, path, stop), runs_{{0, material}} {
  while (records_.next()) read_record();
  for (const Unused& u : unused_)
    scene_.notes.add(
        u.first, u.count == 1 ? fmt::format("{} is not used", u.what)
                              : fmt::format("{} is not used, here and {} times more", u.what, u.count - 1));
}

uint32_t ObjRecords::next_material() {
  while (run_ + 1 < runs_.size() && runs_[run_ + 1].first_face <= asked_) ++run_;
  ++asked_;
  return runs_[run_].material;
}

void ObjRecords::read_record() {
  const std::string_view key = records_.keyword();
  if (key == "v") {
    ++counts_.vertices;
    if (read_numbers(3) >= 6) count_unused("a vertex's colour");
  } else if (key == "vn") {
    ++counts_.normals;
    read_numbers(3);
  } else if (key == "vt") {
    ++counts_.uvs;
    read_numbers(1);
  } else if (key == "f") {
    read_face();
  } else if (key == "usemtl") {
    use_material(records_.rest());
  } else if (key == "mtllib") {
    read_libraries();
  } else if (key == "s") {
    smoothing_groups_.emplace(records_.word());
  } else if (key != "g" && key != "o") {
    count_unused(fmt::format("`{}`", key.substr(0, 40)));
  }
}

/// At least `least` numbers, which the library would take for 0 where they are none. Returns how many there
/// are.
size_t ObjRecords::read_numbers(size_t least) {
  size_t count = 0;
  for (; count < least || records_.has_number(); ++count)
    if (!std::isfinite(static_cast<float>(records_.number())))
      records_.fail("the number is beyond what a mesh holds (3.4e38)");
  return count;
}

void ObjRecords::read_face() {
  size_t corners = 0;
  for (; records_.has_more(); ++corners)
    if (const std::string_view word = records_.word(); !is_corner(word))
      records_.fail(fmt::format("expected a corner like 1, 1/2, 1//3 or 1/2/3, counted from 1, found '{}'",
                                word.substr(0, 40)));
  if (corners > 0) ++counts_.faces;  // without corners the library knows of no face
  counts_.corners += corners;
  if (corners < 3) count_unused("a face of fewer than three corners");
}

void ObjRecords::use_material(std::string_view name) {
  if (const auto found = ids_.find(name); found != ids_.end()) {
    runs_.push_back({counts_.faces, found->second});
    return;
  }
  runs_.push_back({counts_.faces, runs_.front().material});
  std::vector<std::string> names;
  for (const auto& [known, id] : ids_) names.push_back(known);
  count_unused(names.empty() ? "`usemtl`, as no `mtllib` before it defines a material,"
                             : fmt::format("material '{}', which no `mtllib` defines{},", name.substr(0, 80),
                                           suggestion(name, names)));
}

/// One file, whose name may have spaces, or several.
void ObjRecords::read_libraries() {
  const std::string all(records_.rest());
  if (all.empty()) return;
  const SourcePlace place = records_.place();
  const std::filesystem::path folder = std::filesystem::path(path_).parent_path();
  std::error_code ignored;
  std::vector<std::string> names;
  if (std::filesystem::exists(folder / all, ignored)) {
    names.push_back(all);
  } else {
    for (size_t begin = 0; begin < all.size();) {
      const size_t end = std::min(all.find(' ', begin), all.size());
      if (end > begin) names.push_back(all.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  for (const std::string& name : names) {
    const std::string library = (folder / name).string();
    if (std::find(libraries_.begin(), libraries_.end(), library) != libraries_.end()) continue;
    libraries_.push_back(library);
    try {
      ids_.merge(load_mtl(scene_, library, stop_));
    } catch (const IoError& e) {
      throw InputError(place, e.what());
    }
  }
}

void ObjRecords::count_unused(std::string_view what) {
  const auto found =
      std::find_if(unused_.begin(), unused_.end(), [what](const Unused& u) { return u.what == what; });
  if (found != unused_.end())
    ++found->count;
  else if (unused_.size() < kMostKinds)
    unused_.push_back({std::string(what), records_.line_place(), 1});
}

}  // namespace rayfarm
