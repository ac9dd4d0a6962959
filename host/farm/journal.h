#pragma once
// Journals: the results of frames in the making, kept on disk beside the frames' files, so that a job that
// ends before its time goes on where it was. A journal is text that says what it is of, its last line the
// CRC-32 of those before it, up to an empty line, and then records that are only ever appended: their length,
// its and their bytes' CRC-32, and a result as the net carries it. What a power cut leaves is read up to the
// first record that is not whole.
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "protocol/byte_stream.h"
#include "protocol/subpolygons.h"

namespace rayfarm {

/// Names and values, in order: what a journal is of.
using JournalLines = std::vector<std::pair<std::string, std::string>>;

struct JournalHead {
  JournalLines lines;
  uint64_t bytes = 0;  ///< of all that stands before the first record
  const std::string& value(const std::string& name) const;
};

/// Where the journal of a frame's file stands.
std::string journal_of(const std::string& file);

/// Nothing if the file is one that was only begun, and holds no result. Throws IoError if it is no journal,
/// or can't be read.
std::optional<JournalHead> read_journal_head(const std::string& path);
/// True if a journal stands there, whole or only begun: what may be replaced or removed.
bool is_journal(const std::string& path);
enum class JournalUse : uint8_t { none, by_a_job, unknown };
/// Whether a job that runs is writing to it; unknown where the file system has no locks, or no file is there.
JournalUse use_of_journal(const std::string& path);
/// Gives each whole record to `take`, in order; returns where they end. Throws IoError if the file can't be
/// read.
uint64_t read_journal(const std::string& path, const JournalHead& head,
                      const std::function<void(std::span<const std::byte> record)>& take);

/// Writes journals in a thread of its own, now and then, each time forced to the disk. What it can't write it
/// tells once; pictures can be made without it.
class JournalWriter {
 public:
  /// Seconds between two times; 0: nothing is kept.
  explicit JournalWriter(double every_s);
  /// All that was appended is on disk then.
  ~JournalWriter();
  JournalWriter(const JournalWriter&) = delete;
  JournalWriter& operator=(const JournalWriter&) = delete;

  bool keeps_any() const { return every_s_ > 0; }
  /// From now on records are appended for this path: to a file that begins with these lines, or to the one
  /// that is there, from `end` on.
  void begin(const std::string& path, JournalLines lines);
  void go_on(const std::string& path, uint64_t end);
  /// Nothing is appended for this path, and what stands there stays until the frame's file is whole.
  void leave(const std::string& path);
  void append(const std::string& path, std::span<const std::byte> record);
  /// The frame's file is whole: its journal goes.
  void remove(const std::string& path);
  /// Waits until all that was appended is on disk.
  void sync();
  /// What could not be written since this was last asked, each once with its path.
  std::vector<std::string> take_problems();
  /// True if all that was appended is, or will be, on disk.
  bool is_whole(const std::string& path);

 private:
  struct File {
    Bytes head;        ///< of a file that is to be made
    uint64_t end = 0;  ///< of the part of a file that is there; 0: it is made anew
    Bytes pending;
    int descriptor = -1;
    bool is_over = false;    ///< to be removed
    bool is_broken = false;  ///< could not be written, or is left as it is
    bool is_left = false;    ///< stands there from an earlier run
    bool has_gaps = false;   ///< the disk was too slow for some
  };
  /// More that waits for the disk is not kept, so that the host's memory is bounded.
  static constexpr size_t kMostPendingBytes = size_t{256} << 20;

  void run();
  bool has_work() const;
  void write_all(std::unique_lock<std::mutex>& lock);
  void write(const std::string& path, File& file, const Bytes& pending);
  void tell(const std::string& path, const std::string& problem);

  double every_s_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, File> files_;
  size_t pending_bytes_ = 0;
  std::vector<std::string> problems_;
  std::set<std::string> told_;  ///< all problems there were
  bool is_writing_ = false, is_hurried_ = false, is_ending_ = false;
  std::thread thread_;  // last: it looks at the others
};

}  // namespace rayfarm
