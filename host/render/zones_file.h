#pragma once
// The light of zones in files, so that later renders of the same scene need not find it again. Only the host
// reads and writes them.
//
// A file is lines of text (`name value`), an empty line, and the solution's bytes. The first lines name the
// format and all that the solution depends on, the last two its length and SHA-256.
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/scene/render_settings.h"
#include "common/scene/scene.h"
#include "protocol/byte_stream.h"
#include "protocol/index.h"

namespace rayfarm {

/// The settings with all that zones don't depend on left at what it is without a user's word: of the picture,
/// its samples, and of other lighting models.
RenderSettings settings_of_zones(const RenderSettings& settings);

class ZonesFile {
 public:
  /// `name` may hold ####, for the frame. Where the scene is looked at from does not matter. `has_poses`: a
  /// solution is of its frame alone.
  ZonesFile(std::string name, const Scene& scene, const RenderSettings& settings, bool has_poses);

  std::string file_of(FrameNumber frame) const;
  /// Nothing if there is no such file. Throws JobError if it is damaged, or of another scene, settings,
  /// pose or program.
  std::optional<Bytes> read(FrameNumber frame) const;
  /// Whole or not at all. Throws IoError.
  void write(FrameNumber frame, std::span<const std::byte> solution) const;

 private:
  /// What the solution depends on: a line's name, and its value.
  using Lines = std::vector<std::pair<std::string, std::string>>;
  Lines lines_of(FrameNumber frame) const;

  std::string name_;
  Lines lines_;
  bool has_poses_;
};

}  // namespace rayfarm
