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
#include <random>

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

/// True if `name`, which begins as said above, belongs to a process that is gone.
bool is_stale(std::string_view name, const std::string& beginning) {
  if (!name.starts_with(beginning) || !name.ends_with(kEnding)) return false;
  name.remove_prefix(beginning.size());
  name.remove_suffix(kEnding.size());
  pid_t process = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), process);
  name.remove_prefix(static_cast<size_t>(end - name.data()));
  if (error != std::errc{} || process <= 0 || name.size() <= kTokenDigits + 1 || name.front() != '.' ||
      name.find_first_not_of("0123456789abcdef", 1) != std::string_view::npos)
    return false;  // not a name that is made here
  if (process == getpid()) return name.substr(1, kTokenDigits) != token();
  return has_ended(process);
}

void remove_stale(const std::filesystem::path& folder, const std::string& beginning) {
  std::error_code ignored;
  for (std::filesystem::directory_iterator entry(folder, ignored), end; entry != end;
       entry.increment(ignored))
    if (is_stale(entry->path().filename().string(), beginning))
      std::filesystem::remove(entry->path(), ignored);
}

std::string problem_of(int error) {
  return std::strerror(error ? error : EIO);
}

}  // namespace

WholeFile::WholeFile(const std::string& path) : path_(path) {
  const std::filesystem::path target(path);
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";
  std::error_code error;
  const auto status = std::filesystem::status(target, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    fail("what stands there is not a regular file");
  const std::string beginning = beginning_for(target);
  remove_stale(folder, beginning);
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

}  // namespace rayfarm
