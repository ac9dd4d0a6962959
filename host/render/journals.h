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

/// Throws JobError if another job is at work on the file: its journal is in use. One that is about to end is
/// waited for, and what one that has ended was writing is removed.
void refuse_if_in_work(const std::string& file);

/// The journal of a frame's file, if there is one with results. Throws JobError with what differs if it is of
/// another job, and if it is none.
std::optional<JournalHead> find_journal(const std::string& file, FrameNumber frame, const JournalLines& job);

/// True if a journal of this frame of this very job stands beside the file.
bool holds_work_of(const std::string& file, FrameNumber frame, const JournalLines& job);

/// How the journal's job was cut into subpolygons. Throws JobError if it says no such thing.
SubpolygonGrid grid_of(const JournalHead& head, const PixelRect& crop, const std::string& file);

/// Cuts the plan's pictures as they were when the journals that were found were written, and has them handed
/// out: nodes that know their own sets do not know what is done. Returns notes; throws JobError if journals
/// differ.
std::vector<std::string> adopt_journals(const PixelRect& crop, const RenderOptions& options,
                                        FarmHostOptions& job);

/// Removes what a run that was ended left beside the file: a journal and a preview, nobody else's files.
void remove_leftovers(const std::string& file);

}  // namespace rayfarm
