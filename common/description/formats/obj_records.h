#pragma once
// What an OBJ file says beside its mesh: materials are read and given to faces, so are smoothing groups, and
// what is not used is noted.
#include <map>
#include <string_view>
#include <vector>

#include "common/description/formats/mtl_loader.h"
#include "common/description/formats/obj_piece.h"

namespace rayfarm {

class ObjRecords {
 public:
  /// Materials of the file `path` join the scene; faces without one have `material`.
  ObjRecords(SceneDescription& scene, const std::string& path, uint32_t material, const std::stop_token& stop)
      : scene_(scene), path_(path), stop_(stop), materials_{{0, material}} {}

  /// The file's next piece. Throws InputError and Stopped.
  void add(const ObjPiece& piece);
  /// Notes what is not used.
  void add_notes() const;

  /// Faces from `first_face` on, up to the next run's, have a value.
  struct Run {
    size_t first_face = 0;
    uint32_t value = 0;
  };
  const std::vector<Run>& materials() const { return materials_; }
  /// Smoothing groups, by their order of appearance from 1 on; 0: flat. Before the first `s` all is of one.
  const std::vector<Run>& smoothing() const { return smoothing_; }
  bool has_smoothing() const { return smoothing_.size() > 1; }  ///< the file says what is smooth
  bool is_smooth() const { return !groups_.empty(); }           ///< something, by what it says
  /// Objects and groups (`o`, `g`) that have faces.
  std::vector<NamedFaces> names();
  int lines() const { return lines_; }  ///< so far

 private:
  static constexpr uint32_t kAllSmooth = 1;
  /// Records of a kind that is not used.
  struct Unused {
    std::string what;
    SourcePlace first;
    size_t count = 0;
  };

  void add(const ObjPiece::Setting& setting);
  void use_material(const ObjPiece::Setting& setting);
  void read_libraries(const ObjPiece::Setting& setting);
  void count_unused(std::string_view what, int line, size_t count);

  SceneDescription& scene_;
  const std::string& path_;
  const std::stop_token& stop_;
  MaterialIds ids_;
  std::vector<std::string> libraries_;
  std::vector<Run> materials_, smoothing_{{0, kAllSmooth}};
  std::map<std::string, uint32_t, std::less<>> groups_;
  std::optional<std::string> newest_group_;  ///< that the last run was the first to name
  void end_name(size_t faces);
  std::vector<NamedFaces> names_;
  std::map<std::string, size_t, std::less<>> name_ids_;  ///< which of names_
  size_t name_ = SIZE_MAX, name_begin_ = 0;              ///< that of the faces from the last `o` or `g` on
  std::vector<Unused> unused_;
  int lines_ = 0;
  size_t faces_ = 0;
};

}  // namespace rayfarm
