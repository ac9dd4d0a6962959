#pragma once
// What an OBJ file says beside its mesh, and whether the mesh can be read: every number and index is looked
// at, materials are read, and what is not used is noted.
#include <set>
#include <string_view>
#include <vector>

#include "common/description/formats/mtl_loader.h"
#include "common/description/formats/records.h"

namespace rayfarm {

class ObjRecords {
 public:
  /// Reads all of `text`, the file `path`. Its materials join the scene; faces without one have `material`.
  /// Throws InputError and Stopped.
  ObjRecords(SceneDescription& scene, std::string_view text, const std::string& path, uint32_t material,
             const std::stop_token& stop);

  /// How many there are, to make room for them.
  struct Counts {
    size_t vertices = 0, normals = 0, uvs = 0, faces = 0, corners = 0;
  };
  const Counts& counts() const { return counts_; }
  /// True if edges between some faces are to stay sharp.
  bool has_smoothing_groups() const { return smoothing_groups_.size() > 1; }
  /// Of the next face, `f` record by `f` record.
  uint32_t next_material();

 private:
  /// From `first_face` on faces have `material`.
  struct Run {
    size_t first_face = 0;
    uint32_t material = 0;
  };
  /// Records of a kind that is not used.
  struct Unused {
    std::string what;
    SourcePlace first;
    size_t count = 0;
  };

  void read_record();
  size_t read_numbers(size_t least);
  void read_face();
  void use_material(std::string_view name);
  void read_libraries();
  void count_unused(std::string_view what);

  SceneDescription& scene_;
  const std::string& path_;
  const std::stop_token& stop_;
  Records records_;
  MaterialIds ids_;
  std::vector<std::string> libraries_;
  std::vector<Run> runs_;
  std::vector<Unused> unused_;
  std::set<std::string, std::less<>> smoothing_groups_;
  Counts counts_;
  size_t asked_ = 0, run_ = 0;  ///< faces asked for so far, and the run of the last one
};

}  // namespace rayfarm
