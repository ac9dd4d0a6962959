#include "common/files/whole_file.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string_view>
#include <utility>

#include "common/errors/input_error.h"
#include "common/files/regular_file.h"

namespace rayfarm {
namespace {

constexpr std::string_view kEnding = ".part";
constexpr size_t kTokenDigits = 16;

/// Of this process alone: another one with the same number, earlier or in another container, has another.
const std::string& token() {
  static const std::string text = [] {
    std::random_device random;
    return fmt::format("{:08x}{:08x}", random(), random());
  }();
  return text;
}

/// How the names of all files in the making of `target` begin that are made on this machine.
std::string beginning_for(const std::filesystem::path& target) {
  char host[HOST_NAME_MAX + 1] = "";
  gethostname(host, sizeof host - 1);
  // A name that is as long as names may be leaves no room for the rest of it.
  constexpr size_t kLongestRest = 48;
  const std::string after = fmt::format(".{}.", host);
  const std::string name = target.filename().string();
  const size_t room = NAME_MAX - std::min<size_t>(NAME_MAX, after.size() + kLongestRest);
  return "." + name.substr(0, room) + after;
}

/// Also true of a process that nobody has asked yet how it ended: it has no executable any more.
bool has_ended(pid_t process) {
  if (kill(process, 0) != 0) return errno == ESRCH;
  char first;
  return readlink(fmt::format("/proc/{}/exe", process).c_str(), &first, 1) < 0 && errno == ENOENT &&
         access("/proc/self", F_OK) == 0;
}

/// The process that a file in the making is of, and its token with what follows; nothing if the rest of its
/// name, from the process on, is not one that is made here.
std::optional<std::pair<pid_t, std::string_view>> maker_of(std::string_view rest) {
  if (!rest.ends_with(kEnding)) return std::nullopt;
  rest.remove_suffix(kEnding.size());
  pid_t process = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), process);
  rest.remove_prefix(static_cast<size_t>(end - rest.data()));
  if (error != std::errc{} || process <= 0 || rest.size() <= kTokenDigits + 1 || rest.front() != '.' ||
      rest.find_first_not_of("0123456789abcdef", 1) != std::string_view::npos)
    return std::nullopt;
  return std::pair(process, rest.substr(1));
}

/// True if `name`, which begins as said above, belongs to a process that is gone.
bool is_stale(std::string_view name, const std::string& beginning) {
  if (!name.starts_with(beginning)) return false;
  const auto maker = maker_of(name.substr(beginning.size()));
  if (!maker) return false;
  return maker->first == getpid() ? maker->second.substr(0, kTokenDigits) != token()
                                  : has_ended(maker->first);
}

/// Files of the folder whose names `is_wanted` wants.
template <typename IsWanted>
void remove_files(const std::filesystem::path& folder, IsWanted is_wanted) {
  std::error_code ignored;
  for (std::filesystem::directory_iterator entry(folder, ignored), end; entry != end;
       entry.increment(ignored))
    if (is_wanted(entry->path().filename().string())) std::filesystem::remove(entry->path(), ignored);
}

std::filesystem::path folder_of(const std::filesystem::path& target) {
  return target.has_parent_path() ? target.parent_path() : ".";
}

std::string problem_of(int error) {
  return std::strerror(error ? error : EIO);
}

}  // namespace

WholeFile::WholeFile(const std::string& path) : path_(path) {
  const std::filesystem::path target(path);
  const std::filesystem::path folder = folder_of(target);
  std::error_code error;
  const auto status = std::filesystem::status(target, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    fail("what stands there is not a regular file");
  const std::string beginning = beginning_for(target);
  remove_stale_files(std::span(&path, 1));
  static std::atomic<unsigned> counter{0};
  const std::string name =
      fmt::format("{}{}.{}{:x}{}", beginning, getpid(), token(), counter.fetch_add(1), kEnding);
  const std::string in_making = (folder / name).string();
  const int descriptor = open(in_making.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor < 0) fail(problem_of(errno));
  temporary_ = in_making;
  file_.reset(fdopen(descriptor, "w+b"));
  if (!file_) {
    const int of_opening = errno;
    close(descriptor);
    fail(problem_of(of_opening));
  }
}

WholeFile::~WholeFile() {
  remove();
}

void WholeFile::remove() {
  std::error_code ignored;
  if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
  temporary_.clear();
}

void WholeFile::fail(const std::string& problem) {
  remove();
  throw IoError(fmt::format("{}: can't be written: {}; check the folder, its permissions and the space left",
                            path_, problem));
}

void WholeFile::write(const std::function<void(std::FILE* file)>& work) {
  try {
    work(file_.get());
  } catch (const std::exception& e) {
    // A full disk is named as such, whatever the format's library made of it.
    errno = 0;
    if (std::fputc(0, file_.get()) == EOF || std::fflush(file_.get()) != 0) fail(problem_of(errno));
    fail(e.what());
  }
}

void WholeFile::commit() {
  // Forced to its disk, so that a full one shows here; what failed before that has left its mark, and is
  // asked for once more by a byte that is not meant to stay.
  errno = 0;
  if (std::ferror(file_.get())) {
    std::clearerr(file_.get());
    if (std::fputc(0, file_.get()) != EOF) std::fflush(file_.get());
    fail(problem_of(errno));
  }
  if (std::fflush(file_.get()) != 0 || fsync(fileno(file_.get())) != 0) fail(problem_of(errno));
  std::error_code error;
  std::filesystem::rename(temporary_, path_, error);
  if (error) fail(error.message());
  temporary_.clear();
}

void write_whole_file(const std::string& path, const std::function<void(std::FILE* file)>& write) {
  WholeFile file(path);
  file.write(write);
  file.commit();
}

void remove_stale_files(std::span<const std::string> paths) {
  std::map<std::filesystem::path, std::set<std::string>> beginnings;
  for (const std::string& path : paths) beginnings[folder_of(path)].insert(beginning_for(path));
  for (const auto& [folder, of_files] : beginnings)
    remove_files(folder, [&files = of_files](const std::string& name) {
      const auto next = files.upper_bound(name);  // what a name begins with stands before it
      return next != files.begin() && is_stale(name, *std::prev(next));
    });
}

void remove_files_of_other_machines(const std::string& path) {
  const std::filesystem::path target(path);
  const std::string beginning = "." + target.filename().string() + ".", own = beginning_for(target);
  remove_files(folder_of(target), [&](const std::string& name) {
    if (!name.starts_with(beginning) || name.starts_with(own)) return false;
    // A machine's name may have dots in it.
    for (size_t at = beginning.size(); (at = name.find('.', at)) != std::string::npos;)
      if (maker_of(std::string_view(name).substr(++at))) return true;
    return false;
  });
}

}  // namespace rayfarm
