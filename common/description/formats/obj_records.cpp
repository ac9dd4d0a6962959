#include "common/description/formats/obj_records.h"

#include <algorithm>
#include <filesystem>

namespace rayfarm {
namespace {

constexpr size_t kMostNames = 1 << 16;
constexpr size_t kMostKinds = 24;  // of what is not used: a file of rubbish has many

}  // namespace

void ObjRecords::add(const ObjPiece& piece) {
  auto unused = piece.unused.begin();
  const auto count_unused_above = [&](int line) {
    for (; unused != piece.unused.end() && unused->line < line; ++unused)
      count_unused(unused->what, unused->line, unused->count);
  };
  for (const ObjPiece::Setting& setting : piece.settings) {
    throw_if_stopped(stop_);
    count_unused_above(setting.line);
    add(setting);
  }
  count_unused_above(std::numeric_limits<int>::max());
  lines_ += piece.lines;
  faces_ += piece.sides.size();
}

void ObjRecords::add_notes() const {
  for (const Unused& u : unused_)
    scene_.notes.add(
        u.first, u.count == 1 ? fmt::format("{} is not used", u.what)
                              : fmt::format("{} is not used, here and {} times more", u.what, u.count - 1));
}

void ObjRecords::add(const ObjPiece::Setting& setting) {
  switch (setting.kind) {
    case ObjPiece::Setting::material:
      return use_material(setting);
    case ObjPiece::Setting::library:
      return read_libraries(setting);
    case ObjPiece::Setting::smoothing: {
      const bool is_flat = setting.text == "off" || setting.text == "0" || setting.text == "null";
      const size_t face = faces_ + setting.faces_before;
      // Of those that no face comes between the last counts, wherever pieces end.
      if (smoothing_.size() > 1 && smoothing_.back().first_face == face) {
        smoothing_.pop_back();
        if (newest_group_) groups_.erase(*newest_group_);
      }
      newest_group_.reset();
      uint32_t group = 0;
      if (!is_flat) {
        const auto [found, is_new] =
            groups_.try_emplace(setting.text, static_cast<uint32_t>(groups_.size()) + 1);
        group = found->second;
        if (is_new) newest_group_ = setting.text;
      }
      smoothing_.push_back({face, group});
      return;
    }
    case ObjPiece::Setting::name: {
      end_name(faces_ + setting.faces_before);
      if (const auto found = name_ids_.find(setting.text);
          found != name_ids_.end() || names_.size() == kMostNames) {
        name_ = found != name_ids_.end() ? found->second : SIZE_MAX;
        return;
      }
      name_ = names_.size();
      name_ids_.emplace(setting.text, name_);
      names_.push_back({setting.text, 0});
      return;
    }
  }
}

void ObjRecords::end_name(size_t faces) {
  if (name_ < names_.size()) names_[name_].faces += faces - name_begin_;
  name_begin_ = faces;
}

std::vector<NamedFaces> ObjRecords::names() {
  end_name(faces_);
  std::vector<NamedFaces> used;
  for (NamedFaces& name : names_)
    if (name.faces > 0 && !name.name.empty()) used.push_back(std::move(name));
  return used;
}

void ObjRecords::use_material(const ObjPiece::Setting& setting) {
  const size_t face = faces_ + setting.faces_before;
  const std::string_view name = setting.text;
  if (const auto found = ids_.find(name); found != ids_.end()) {
    materials_.push_back({face, found->second});
    return;
  }
  materials_.push_back({face, materials_.front().value});
  std::vector<std::string> names;
  for (const auto& [known, id] : ids_) names.push_back(known);
  count_unused(names.empty() ? "`usemtl`, as no `mtllib` before it defines a material,"
                             : fmt::format("material '{}', which no `mtllib` defines{},", name.substr(0, 80),
                                           suggestion(name, names)),
               setting.line, 1);
}

/// One file, whose name may have spaces, or several.
void ObjRecords::read_libraries(const ObjPiece::Setting& setting) {
  std::string all(setting.text);
  if (all.empty()) return;
  const SourcePlace place{path_, lines_ + setting.line, setting.column};
  const std::filesystem::path folder = std::filesystem::path(path_).parent_path();
  std::error_code ignored;
  std::vector<std::string> names;
  if (!std::filesystem::exists(folder / all, ignored)) std::replace(all.begin(), all.end(), '\\', '/');
  if (std::filesystem::exists(folder / all, ignored)) {
    names.push_back(all);
  } else {
    for (size_t begin = 0; begin < all.size();) {
      const size_t end = std::min(all.find_first_of(" \t", begin), all.size());
      if (end > begin) names.push_back(all.substr(begin, end - begin));
      begin = end + 1;
    }
    // Where none of several is there it may be one whose name has blanks: that it is not there is said once.
    if (std::none_of(names.begin(), names.end(), [&](const std::string& name) {
          return std::filesystem::exists(folder / name, ignored);
        }))
      names = {all};
  }
  for (const std::string& name : names) {
    const std::string library = (folder / name).string();
    if (std::find(libraries_.begin(), libraries_.end(), library) != libraries_.end()) continue;
    libraries_.push_back(library);
    try {
      ids_.merge(load_mtl(scene_, library, stop_));
    } catch (const IoError& e) {  // files are passed on without their materials
      scene_.notes.add(place, fmt::format("{}: what it defines is not used", e.what()));
    }
  }
}

/// `line`: of the piece that is being added.
void ObjRecords::count_unused(std::string_view what, int line, size_t count) {
  const auto found =
      std::find_if(unused_.begin(), unused_.end(), [what](const Unused& u) { return u.what == what; });
  if (found != unused_.end())
    found->count += count;
  else if (unused_.size() < kMostKinds)
    unused_.push_back({std::string(what), {path_, lines_ + line}, count});
}

}  // namespace rayfarm
