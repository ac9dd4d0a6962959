#pragma once
// The `render` block of a scene: options of `rayfarm render` that count where the command line does not have
// them.
#include "common/description/scene_description.h"
#include "host/commands/command_line.h"

namespace rayfarm {

/// Checks the options that `words` of the command line gave, as far as they can be judged before the scene is
/// known, and sets what adopts the scene's. Throws UsageError.
void check_until_scene_is_known(RenderOptions& options, const std::vector<std::string>& words);

/// Throws InputError at the first option of the scene that is none, can't have its value, or doesn't fit the
/// others.
void check_scene_choices(const SceneDescription& scene);

}  // namespace rayfarm
