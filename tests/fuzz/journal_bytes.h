#pragma once
// Journals of frames in the making, whole and damaged.
#include <filesystem>
#include <string>

#include "common/errors/input_error.h"
#include "common/files/read_file.h"
#include "host/process/exit_code.h"
#include "host/render/journals.h"
#include "protocol/block_codec.h"
#include "tests/fuzz/folder.h"

namespace rayfarm::fuzz {

inline std::string journal_seed(const Folder& folder) {
  const std::string path = folder.path + "/seed.journal";
  {
    JournalWriter writer(10);
    writer.begin(path, {{"version", "1"}, {"frame", "3"}, {"columns", "2"}, {"rows", "1"}});
    const Bytes pixels = compress_rgb8(Bytes(3 * 4 * 8), 4, 8);
    for (SubpolygonId i; i.value() < 2; ++i)
      writer.append(
          path,
          encode_block(
              1, {{FrameNumber(3), i, {1, 2, 3, 4, 5}, 1000, true, 2, {6, 7, 8, 9, 10}}, true, pixels}));
  }
  return read_file(path, 1 << 20);
}

inline void read_journal_bytes(const Folder& folder, const std::string& bytes) {
  const std::string journal = folder.write("a.png.journal", bytes);
  const std::optional<JournalHead> head = read_journal_head(journal);
  if (!head) return;
  read_journal(journal, *head, [](std::span<const std::byte> record) {
    const BlockResult block = decode_block(record);
    if (block.is_compressed) decompress_rgb8(block.pixels, 4, 8);
  });
  try {
    grid_of(*head, {0, 0, 8, 8}, folder.path + "/a.png");
  } catch (const JobError& e) {  // which users are told
    throw IoError(e.what());
  }
}

}  // namespace rayfarm::fuzz
