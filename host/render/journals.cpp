#include "host/render/journals.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <limits>
#include <thread>
#include <utility>

#include "common/errors/input_error.h"
#include "common/files/whole_file.h"
#include "host/farm/preview.h"
#include "host/process/exit_code.h"
#include "host/process/interrupt.h"
#include "host/render/settings_lines.h"
#include "protocol/build_identity.h"
#include "protocol/clock.h"

namespace rayfarm {
namespace {

[[noreturn]] void refuse(const std::string& journal, const std::string& problem) {
  throw JobError(kUsageError, fmt::format("--resume: {}: {}; remove it, or leave out --resume, to begin anew",
                                          journal, problem));
}

/// What the journal is of in place of this frame of the job; empty if it is of that.
std::string differences_of(const JournalHead& head, FrameNumber frame, const JournalLines& job) {
  std::string differences;
  for (const auto& [name, value] : job)
    if (head.value(name) != value && (name != "settings" || differences.empty()))
      differences += (differences.empty() ? "" : ", ") + name_difference(name);
  if (head.value("frame") != fmt::format("{}", frame.value()))
    differences += (differences.empty() ? "" : ", ") + std::string("another frame");
  return differences;
}

}  // namespace

JournalLines journal_lines(const RenderSettings& settings,
                           const std::map<std::string, std::string>& attributes) {
  JournalLines lines{{"version", attributes.at("rayfarm/version")},
                     {"build", build_identity()},
                     {"scene", attributes.at("rayfarm/scene")}};
  const auto of_settings = lines_of(settings);
  lines.insert(lines.end(), of_settings.begin(), of_settings.end());
  return lines;
}

void refuse_if_in_work(const std::string& file) {
  // Processes whose mpirun was killed end within a second.
  constexpr double kEndingJob_s = 5;
  const std::string journal = journal_of(file);
  JournalUse use = use_of_journal(journal);
  for (const double begin = now_s(); use == JournalUse::by_a_job; use = use_of_journal(journal)) {
    if (interrupted_by() != 0) throw JobError(kStopped, "stopped before anything was traced");
    if (now_s() - begin > kEndingJob_s)
      throw JobError(kUsageError,
                     fmt::format("{} is being written by another job, which makes {}; wait until it ends, or "
                                 "give this one another name (-o)",
                                 journal, file));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  if (use == JournalUse::none && is_journal(journal)) remove_files_of_other_machines(file);
}

std::optional<JournalHead> find_journal(const std::string& file, FrameNumber frame, const JournalLines& job) {
  const std::string path = journal_of(file);
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return std::nullopt;
  std::optional<JournalHead> head;
  try {
    head = read_journal_head(path);
  } catch (const IoError& e) {
    throw JobError(kUsageError, fmt::format("--resume: {}", e.what()));
  }
  if (!head) return std::nullopt;
  if (const std::string differences = differences_of(*head, frame, job); !differences.empty())
    refuse(path, "it is of " + differences);
  return head;
}

bool holds_work_of(const std::string& file, FrameNumber frame, const JournalLines& job) {
  try {
    const std::optional<JournalHead> head = read_journal_head(journal_of(file));
    return head && differences_of(*head, frame, job).empty();
  } catch (const IoError&) {
    return false;
  }
}

SubpolygonGrid grid_of(const JournalHead& head, const PixelRect& crop, const std::string& file) {
  SubpolygonGrid grid{crop.x0, crop.y0, crop.width(), crop.height(), 0, 0};
  const auto read = [&](const char* name, int most) {
    const std::string& text = head.value(name);
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || value < 1 || value > most)
      refuse(journal_of(file), fmt::format("it is damaged: it does not say how many {} there are", name));
    return value;
  };
  grid.columns = read("columns", crop.width());
  grid.rows = read("rows", crop.height());
  if (!head.value("small_height").empty()) {
    grid.small_height = read("small_height", crop.height() - grid.rows);
    grid.small_columns = read("small_columns", crop.width());
    grid.small_rows = read("small_rows", grid.small_height);
  }
  if (grid.height - grid.small_height < grid.rows ||
      int64_t{grid.columns} * grid.rows + int64_t{grid.small_columns} * grid.small_rows >
          std::numeric_limits<int>::max())
    refuse(journal_of(file), "it is damaged: there are more subpolygons than rows or pixels");
  return grid;
}

std::vector<std::string> adopt_journals(const PixelRect& crop, const RenderOptions& options,
                                        FarmHostOptions& job) {
  const auto& found = job.journals.found;
  if (found.empty()) return {};
  const std::string& first = job.files[found.begin()->first.place()];
  SubpolygonGrid& grid = job.plan.pictures.grid;
  grid = grid_of(found.begin()->second, crop, first);
  for (const auto& [frame, head] : found) {
    const std::string& file = job.files[frame.place()];
    const SubpolygonGrid other = grid_of(head, crop, file);
    if (other != grid)
      throw JobError(kUsageError,
                     fmt::format("--resume: {} was cut into {} subpolygons, and {} into {}; "
                                 "resume them apart (--frames), or remove one",
                                 journal_of(first), grid.text(), journal_of(file), other.text()));
  }
  if (!options.cost_map.empty() && grid.small_height > 0)
    throw JobError(kUsageError,
                   fmt::format("--cost-map: {} was cut into {} subpolygons, and a cost map is one of "
                               "equal cells; leave out --cost-map, or --resume",
                               first, grid.text()));
  std::vector<std::string> notes;
  if (std::exchange(job.plan.policy, AssignmentPolicy::on_demand) != AssignmentPolicy::on_demand)
    notes.emplace_back("--assign interleaved: what an earlier run left is handed out on demand");
  if (!options.cost_map.empty())
    notes.emplace_back("--cost-map leaves out frames of which an earlier run has made a part");
  return notes;
}

void remove_leftovers(const std::string& file) {
  std::error_code ignored;
  if (is_journal(journal_of(file))) std::filesystem::remove(journal_of(file), ignored);
  if (is_preview(preview_of(file))) std::filesystem::remove(preview_of(file), ignored);
}

}  // namespace rayfarm
