#pragma once
// Files opened for reading. What is no regular file is refused after it was opened, so that nothing can take
// its place between the check and the reading: a pipe would be waited for, and a device may never end.
#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>

namespace rayfarm {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using OpenFile = std::unique_ptr<std::FILE, CloseFile>;

struct RegularFile {
  OpenFile file;
  uintmax_t size_bytes = 0;
};

/// Opens for reading. Throws IoError: there is no such file, it may not be read, or it is no regular file.
RegularFile open_regular_file(const std::string& path);

/// Reads at a byte of an open file, whose place stays: how many bytes there are, all of `to` but at the
/// file's end. Throws std::runtime_error with what went wrong.
size_t read_at(std::FILE* file, uint64_t position, std::span<std::byte> to);

/// A file without a name that holds these bytes, for readers that want a descriptor. Throws IoError.
RegularFile open_bytes(std::span<const std::byte> bytes);

}  // namespace rayfarm
