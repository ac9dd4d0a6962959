#include "common/description/part_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>

#include "common/description/scene_description.h"
#include "common/errors/input_error.h"
#include "common/files/regular_file.h"
#include "common/files/sha256.h"
#include "common/files/whole_file.h"

namespace rayfarm {
namespace {

constexpr std::array<char, 8> kMagic{'R', 'A', 'Y', 'P', 'A', 'R', 'T', '\n'};

/// What stands before the block. Text ends with zeros.
struct Head {
  std::array<char, 8> magic = kMagic;
  uint64_t block_bytes = 0;
  std::array<char, 16> records{};   ///< which declarations the records follow
  std::array<char, 64> checksum{};  ///< SHA-256 of the block
  std::array<char, 32> version{};   ///< of the program that wrote it
  std::array<char, 384> source{};   ///< the scene that was compiled
};
static_assert(sizeof(Head) == 512 && std::is_trivially_copyable_v<Head>);

template <size_t N>
void set_text(std::array<char, N>& field, std::string_view text) {
  std::copy_n(text.data(), std::min(N, text.size()), field.data());
}

/// Without what a terminal could take for a command.
template <size_t N>
std::string text_of(const std::array<char, N>& field) {
  std::string text(field.begin(), std::find(field.begin(), field.end(), '\0'));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }, '?');
  return text;
}

Head make_head(std::span<const std::byte> block, const std::string& source) {
  Head head;
  head.block_bytes = block.size();
  set_text(head.records, RAYFARM_RECORDS);
  set_text(head.checksum, sha256(block));
  set_text(head.version, RAYFARM_VERSION);
  set_text(head.source, source);
  return head;
}

}  // namespace

void write_part_file(const std::string& path, const SceneBlock& block, const std::string& source) {
  const Head head = make_head(block.bytes(), source);
  write_whole_file(path, [&](std::FILE* file) {
    if (std::fwrite(&head, sizeof head, 1, file) != 1 ||
        std::fwrite(block.data.get(), block.size, 1, file) != 1)
      throw std::runtime_error(std::strerror(errno));
  });
}

PartFile read_part_file(const std::string& path, const std::stop_token& stop) {
  const RegularFile opened = open_regular_file(path);
  const auto fail = [&path](const std::string& problem) { throw IoError(path + ": " + problem); };
  const auto read = [&](void* to, size_t bytes) {
    if (std::fread(to, 1, bytes, opened.file.get()) == bytes) return true;
    if (std::ferror(opened.file.get())) fail(fmt::format("reading failed: {}", std::strerror(errno)));
    return false;
  };
  Head head;
  if (!read(&head, sizeof head) || head.magic != kMagic)
    fail("is no file of compiled objects; make one: `rayfarm compile part.yaml -o part.rfp`");
  const std::string again =
      fmt::format("compile it again: `rayfarm compile {} -o {}`", text_of(head.source), path);
  if (text_of(head.records) != RAYFARM_RECORDS)
    fail(fmt::format(
        "was compiled by another build of Rayfarm ({}), whose records are not those of this one ({}); {}",
        text_of(head.version), RAYFARM_VERSION, again));
  const auto damaged = [&](const std::string& how) {
    fail(fmt::format("is damaged: {}; copy it again, or {}", how, again));
  };
  if (opened.size_bytes > limits::kFileBytes) damaged("it is larger than any that is written");
  if (head.block_bytes != opened.size_bytes - sizeof head)
    damaged(fmt::format("it has {} bytes where its head tells of {}", opened.size_bytes,
                        head.block_bytes + sizeof head));
  PartFile result;
  result.block.size = head.block_bytes;
  result.block.data.reset(static_cast<std::byte*>(allocate_large(head.block_bytes)));
  constexpr size_t kPiece = 16 << 20;
  for (size_t at = 0; at < result.block.size; at += kPiece) {
    throw_if_stopped(stop);
    if (!read(result.block.data.get() + at, std::min(kPiece, result.block.size - at)))
      damaged("it ends too early");
  }
  if (text_of(head.checksum) != sha256(result.block.bytes())) damaged("its checksum is another");
  throw_if_stopped(stop);
  try {
    result.scene = decode_scene(result.block.bytes());
  } catch (const SceneBlockError& e) {
    damaged(e.what());
  }
  return result;
}

}  // namespace rayfarm
