#pragma once
// The files that a job writes: whether they can be written, and which are there already.
#include <map>
#include <string>
#include <vector>

#include "common/image/image_file.h"
#include "host/render/render_options.h"

namespace rayfarm {

/// Found before hours of work, not after: every folder exists or can be made in one that does, and can be
/// written to; no two outputs have one name. Throws JobError. Only the host writes, so only it looks.
void check_outputs(const RenderOptions& options);

/// Throws JobError if an output, or the file of a picture, is one of the files that the scene was read from.
void check_outputs_are_no_inputs(const RenderOptions& options, const std::vector<std::string>& pictures,
                                 const std::vector<std::string>& inputs);

/// Makes the outputs' folders where they are missing. Throws JobError.
void make_output_folders(const RenderOptions& options);

/// What a picture's file carries, by which it is known again: version, seed, samples, and hashes of the scene
/// as compiled and of all settings.
std::map<std::string, std::string> make_attributes(const RenderSettings& settings,
                                                   std::span<const std::byte> scene_block);

/// Why the file is not the whole picture of this job's frame, or nothing if it is.
std::string why_not_finished(const std::string& file, const RenderSettings& settings, FrameNumber frame,
                             const std::map<std::string, std::string>& attributes);

}  // namespace rayfarm
