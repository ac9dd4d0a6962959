#pragma once
// Journals of earlier runs, for a job that goes on where one of them was.
#include <optional>
#include <string>

#include "host/farm/farm_options.h"
#include "host/render/render_options.h"

namespace rayfarm {

/// What the journals of all frames of this job say that they are of.
JournalLines journal_lines(const RenderSettings& settings,
                           const std::map<std::string, std::string>& attributes);

/// The journal of a frame's file, if there is one. Throws JobError with what differs if it is of another job,
/// and if it is none.
std::optional<JournalHead> find_journal(const std::string& file, FrameNumber frame, const JournalLines& job);

/// How the journal's job was cut into subpolygons. Throws JobError if it says no such thing.
SubpolygonGrid grid_of(const JournalHead& head, const PixelRect& crop, const std::string& file);

}  // namespace rayfarm
