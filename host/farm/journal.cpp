#include "host/farm/journal.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "common/errors/input_error.h"
#include "common/files/regular_file.h"

namespace rayfarm {
namespace {

/// The first line: the number is the format's.
constexpr std::string_view kMagic = "rayfarm-journal 1\n";
/// Longer than any head.
constexpr size_t kMostHeadBytes = 1 << 16;
/// Longer than any result, with its head.
constexpr uint32_t kMostRecordBytes = kMostSubpolygonBytes + (1 << 16);
constexpr const char* kInUse = "another job writes it";
constexpr size_t kFrameBytes = 8;  ///< of a record: its length and its check

/// Of the length, too, so that a damaged one is seen.
uint32_t check_of(uint32_t size, std::span<const std::byte> record) {
  const auto bytes = [](const void* at) { return static_cast<const Bytef*>(at); };
  const uLong begin = crc32(0, bytes(&size), sizeof size);
  return static_cast<uint32_t>(crc32_z(begin, bytes(record.data()), record.size()));
}

[[noreturn]] void fail() {
  throw std::runtime_error(std::strerror(errno ? errno : EIO));
}

void write_bytes(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail();
    bytes = bytes.subspan(static_cast<size_t>(count));
  }
}

void sync_file(int descriptor) {
  while (fdatasync(descriptor) != 0)
    if (errno != EINTR) fail();
}

/// A name that was made is on disk when its folder is.
void sync_folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const int descriptor = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // some file systems know no such thing
  fsync(descriptor);
  close(descriptor);
}

/// Until the descriptor is closed, if nobody else holds a lock.
JournalUse lock(int descriptor, int kind) {
  if (flock(descriptor, kind | LOCK_NB) == 0) return JournalUse::none;
  return errno == EWOULDBLOCK ? JournalUse::by_a_job : JournalUse::unknown;
}

/// Others who look whether it is in use hold it for a moment.
JournalUse lock_to_write(int descriptor) {
  JournalUse use = lock(descriptor, LOCK_EX);
  for (int i = 0; i < 20 && use == JournalUse::by_a_job; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    use = lock(descriptor, LOCK_EX);
  }
  return use;
}

/// The last line of a head.
std::string check_line_of(std::string_view head) {
  const auto* bytes = reinterpret_cast<const Bytef*>(head.data());
  return fmt::format("check {:08x}\n", static_cast<uint32_t>(crc32_z(0, bytes, head.size())));
}

bool read_exactly(std::FILE* file, void* out, size_t size) {
  return std::fread(out, 1, size, file) == size;
}

}  // namespace

const std::string& JournalHead::value(const std::string& name) const {
  static const std::string none;
  for (const auto& [key, value] : lines)
    if (key == name) return value;
  return none;
}

std::string journal_of(const std::string& file) {
  return file + ".journal";
}

bool is_journal(const std::string& path) {
  try {
    const RegularFile opened = open_regular_file(path);
    std::string begin(kMagic.size(), '\0');
    begin.resize(std::fread(begin.data(), 1, begin.size(), opened.file.get()));
    return kMagic.starts_with(begin);
  } catch (const IoError&) {
    return false;
  }
}

JournalUse use_of_journal(const std::string& path) {
  try {
    return lock(fileno(open_regular_file(path).file.get()), LOCK_SH);
  } catch (const IoError&) {
    return JournalUse::unknown;
  }
}

std::optional<JournalHead> read_journal_head(const std::string& path) {
  const RegularFile opened = open_regular_file(path);
  std::string text(kMostHeadBytes, '\0');
  text.resize(std::fread(text.data(), 1, text.size(), opened.file.get()));
  std::string_view rest = text;
  const size_t end = rest.find("\n\n");
  const bool is_ours = rest.starts_with(kMagic) || kMagic.starts_with(rest);
  if (is_ours && end == std::string_view::npos && text.size() < kMostHeadBytes) return std::nullopt;
  if (!is_ours || end == std::string_view::npos)
    throw IoError(fmt::format("{}: is no journal of this version of Rayfarm; remove it", path));
  JournalHead head;
  head.bytes = end + 2;
  const size_t check = rest.rfind("\ncheck ", end) + 1;
  if (check == 0 || rest.substr(check, end + 1 - check) != check_line_of(rest.substr(0, check)))
    throw IoError(fmt::format("{}: the head of this journal is damaged; remove it", path));
  rest = rest.substr(kMagic.size(), check - kMagic.size());
  while (!rest.empty()) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    const size_t space = std::min(line.find(' '), line.size());
    head.lines.emplace_back(line.substr(0, space), line.substr(std::min(space + 1, line.size())));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  }
  return head;
}

uint64_t read_journal(const std::string& path, const JournalHead& head,
                      const std::function<void(std::span<const std::byte> record)>& take) {
  const RegularFile opened = open_regular_file(path);
  std::FILE* file = opened.file.get();
  if (fseeko(file, static_cast<off_t>(head.bytes), SEEK_SET) != 0)
    throw IoError(fmt::format("{}: can't be read: {}", path, std::strerror(errno)));
  errno = 0;
  uint64_t end = head.bytes;
  Bytes record;
  while (true) {
    std::byte frame[kFrameBytes];
    if (!read_exactly(file, frame, sizeof frame)) break;
    ByteReader reader(frame);
    const uint32_t size = reader.u32(), check = reader.u32();
    if (size > kMostRecordBytes || size > opened.size_bytes - std::min(opened.size_bytes, end)) break;
    record.resize(size);
    if (!read_exactly(file, record.data(), size) || check_of(size, record) != check) break;
    take(record);
    end += kFrameBytes + size;
  }
  // What a disk can't give now is no end of what was written.
  if (std::ferror(file))
    throw IoError(fmt::format("{}: can't be read: {}", path, std::strerror(errno ? errno : EIO)));
  return end;
}

JournalWriter::JournalWriter(double every_s) : every_s_(every_s) {
  if (every_s > 0) thread_ = std::thread([this] { run(); });
}

JournalWriter::~JournalWriter() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
  for (const auto& [path, file] : files_)
    if (file.descriptor >= 0) close(file.descriptor);
}

void JournalWriter::begin(const std::string& path, JournalLines lines) {
  if (!keeps_any()) return;
  std::string text(kMagic);
  for (const auto& [name, value] : lines) text += fmt::format("{} {}\n", name, value);
  text += check_line_of(text) + "\n";
  const auto bytes = std::as_bytes(std::span(text));
  const std::lock_guard lock(mutex_);
  files_[path].head.assign(bytes.begin(), bytes.end());
}

void JournalWriter::go_on(const std::string& path, uint64_t end) {
  if (!keeps_any()) return;
  const std::lock_guard lock(mutex_);
  files_[path].end = end;
}

void JournalWriter::leave(const std::string& path) {
  if (!keeps_any()) return;
  const std::lock_guard lock(mutex_);
  files_[path].is_broken = files_[path].is_left = true;
}

void JournalWriter::append(const std::string& path, std::span<const std::byte> record) {
  if (!keeps_any()) return;
  ByteWriter frame;
  const auto size = static_cast<uint32_t>(record.size());
  frame.u32(size);
  frame.u32(check_of(size, record));
  const Bytes head = frame.take();
  bool is_much = false;
  {
    const std::lock_guard lock(mutex_);
    File& file = files_[path];
    if (file.is_broken || file.is_over) return;
    if (pending_bytes_ + record.size() > kMostPendingBytes) {
      file.has_gaps = true;
      tell(
          path,
          "the disk is too slow for all results; those that it can't take are traced again if the job has to "
          "go on");
      return;
    }
    file.pending.insert(file.pending.end(), head.begin(), head.end());
    file.pending.insert(file.pending.end(), record.begin(), record.end());
    pending_bytes_ += head.size() + record.size();
    is_much = pending_bytes_ > kMostPendingBytes / 4;
    is_hurried_ |= is_much;
  }
  if (is_much) changed_.notify_all();
}

void JournalWriter::remove(const std::string& path) {
  if (!keeps_any()) return;
  {
    const std::lock_guard lock(mutex_);
    const auto file = files_.find(path);
    if (file == files_.end()) return;
    pending_bytes_ -= file->second.pending.size();
    file->second.pending.clear();
    file->second.is_over = true;
    is_hurried_ = true;
  }
  changed_.notify_all();
}

void JournalWriter::sync() {
  if (!keeps_any()) return;
  std::unique_lock lock(mutex_);
  is_hurried_ = true;
  changed_.notify_all();
  changed_.wait(lock, [this] { return !is_writing_ && !has_work(); });
}

std::vector<std::string> JournalWriter::take_problems() {
  const std::lock_guard lock(mutex_);
  return std::exchange(problems_, {});
}

void JournalWriter::tell(const std::string& path, const std::string& problem) {
  const std::string text = fmt::format("{}: {}", path, problem);
  if (told_.insert(text).second) problems_.push_back(text);
}

bool JournalWriter::is_whole(const std::string& path) {
  const std::lock_guard lock(mutex_);
  const auto file = files_.find(path);
  if (file == files_.end() || file->second.has_gaps) return false;
  return !file->second.is_broken || file->second.is_left;
}

bool JournalWriter::has_work() const {
  return std::any_of(files_.begin(), files_.end(), [](const auto& entry) {
    return entry.second.is_over || (!entry.second.pending.empty() && !entry.second.is_broken);
  });
}

void JournalWriter::run() {
  std::unique_lock lock(mutex_);
  while (!is_ending_) {
    changed_.wait_for(lock, std::chrono::duration<double>(every_s_),
                      [this] { return is_ending_ || is_hurried_; });
    is_hurried_ = false;
    write_all(lock);
    changed_.notify_all();
  }
  write_all(lock);
}

void JournalWriter::write_all(std::unique_lock<std::mutex>& lock) {
  is_writing_ = true;
  for (auto entry = files_.begin(); entry != files_.end();) {
    File& file = entry->second;  // stays where it is while others are added
    const std::string& path = entry->first;
    const Bytes pending = std::exchange(file.pending, {});
    const bool is_over = file.is_over;
    lock.unlock();
    std::string problem;
    try {
      if (!is_over && !pending.empty() && !file.is_broken) write(path, file, pending);
    } catch (const std::exception& e) {
      problem = e.what();
    }
    if (is_over) {
      const bool is_there = file.descriptor >= 0 || file.end > 0 || file.is_left;
      if (file.descriptor >= 0) close(file.descriptor);
      if (is_there) unlink(path.c_str());
    }
    lock.lock();
    pending_bytes_ -= pending.size();  // till now it took memory
    if (!problem.empty()) {
      file.is_broken = true;  // its lock is kept until the frame's file is whole, and it is removed
      tell(path,
           fmt::format("can't be written: {}; if the job has to go on, what is not in it is traced again",
                       problem));
    }
    entry = is_over ? files_.erase(entry) : std::next(entry);
  }
  is_writing_ = false;
}

/// Called without the lock: only this thread touches what is neither pending nor over.
void JournalWriter::write(const std::string& path, File& file, const Bytes& pending) {
  errno = 0;
  if (file.descriptor < 0) {
    const bool is_new = file.end == 0;
    struct stat there {};
    if (lstat(path.c_str(), &there) == 0) {
      if (!S_ISREG(there.st_mode) || !is_journal(path))
        throw std::runtime_error("what stands there is no journal");
      if (use_of_journal(path) == JournalUse::by_a_job) throw std::runtime_error(kInUse);
      if (is_new && unlink(path.c_str()) != 0) fail();
    }
    // Made exclusively, so that no link that somebody left there is followed.
    file.descriptor =
        open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOFOLLOW | (is_new ? O_CREAT | O_EXCL : 0), 0666);
    if (file.descriptor < 0) fail();
    if (lock_to_write(file.descriptor) == JournalUse::by_a_job) {
      close(std::exchange(file.descriptor, -1));
      throw std::runtime_error(kInUse);
    }
    try {
      if (!is_new && (ftruncate(file.descriptor, static_cast<off_t>(file.end)) != 0 ||
                      lseek(file.descriptor, 0, SEEK_END) < 0))
        fail();
      write_bytes(file.descriptor, file.head);
      write_bytes(file.descriptor, pending);
      sync_file(file.descriptor);
      if (is_new) sync_folder_of(path);
    } catch (const std::exception&) {
      if (is_new) {
        unlink(path.c_str());
        close(std::exchange(file.descriptor, -1));
      }
      throw;
    }
    return;
  }
  write_bytes(file.descriptor, pending);
  sync_file(file.descriptor);
}

}  // namespace rayfarm
