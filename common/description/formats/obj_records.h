#pragma once
// What an OBJ file says beside its mesh: materials are read and given to faces, and what is not used is
// noted.
#include <string_view>
#include <unordered_set>
#include <vector>

#include "common/description/formats/mtl_loader.h"
#include "common/description/formats/obj_piece.h"

namespace rayfarm {

class ObjRecords {
 public:
  /// Materials of the file `path` join the scene; faces without one have `material`.
  ObjRecords(SceneDescription& scene, const std::string& path, uint32_t material, const std::stop_token& stop)
      : scene_(scene), path_(path), stop_(stop), runs_{{0, material}} {}

  /// The file's next piece. Throws InputError and Stopped.
  void add(const ObjPiece& piece);
  /// Notes what is not used.
  void add_notes() const;

  /// Faces from `first_face` on, up to the next run's, have `material`.
  struct Run {
    size_t first_face = 0;
    uint32_t material = 0;
  };
  const std::vector<Run>& runs() const { return runs_; }
  /// True if edges between some faces are to stay sharp.
  bool has_smoothing_groups() const { return smoothing_groups_.size() > 1; }
  int lines() const { return lines_; }  ///< so far

 private:
  /// Records of a kind that is not used.
  struct Unused {
    std::string what;
    SourcePlace first;
    size_t count = 0;
  };

  void use_material(const ObjPiece::Setting& setting);
  void read_libraries(const ObjPiece::Setting& setting);
  void count_unused(std::string_view what, int line, size_t count);

  SceneDescription& scene_;
  const std::string& path_;
  const std::stop_token& stop_;
  MaterialIds ids_;
  std::vector<std::string> libraries_;
  std::vector<Run> runs_;
  std::vector<Unused> unused_;
  std::unordered_set<std::string_view> smoothing_groups_;
  int lines_ = 0;
  size_t faces_ = 0;
};

}  // namespace rayfarm
