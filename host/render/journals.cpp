#include "host/render/journals.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "common/errors/input_error.h"
#include "host/process/exit_code.h"
#include "host/render/settings_lines.h"
#include "protocol/build_identity.h"

namespace rayfarm {
namespace {

[[noreturn]] void refuse(const std::string& journal, const std::string& problem) {
  throw JobError(kUsageError, fmt::format("--resume: {}: {}; remove it, or leave out --resume, to begin anew",
                                          journal, problem));
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
  std::string differences;
  for (const auto& [name, value] : job)
    if (head->value(name) != value && (name != "settings" || differences.empty()))
      differences += (differences.empty() ? "" : ", ") + name_difference(name);
  if (head->value("frame") != fmt::format("{}", frame.value()))
    differences += (differences.empty() ? "" : ", ") + std::string("another frame");
  if (!differences.empty()) refuse(path, "it is of " + differences);
  return head;
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
  return grid;
}

}  // namespace rayfarm
