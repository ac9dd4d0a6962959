#pragma once
// OpenEXR's own streams open files by their names; these use one that is open.
#include <ImfIO.h>

#include <cstdio>
#include <span>
#include <vector>

namespace rayfarm {

class ExrOutput : public Imf::OStream {
 public:
  explicit ExrOutput(std::FILE* file) : OStream("the file"), file_(file) {}
  void write(const char bytes[], int count) override;
  uint64_t tellp() override;
  void seekp(uint64_t position) override;

 private:
  std::FILE* file_;
};

/// Bytes that are read in place of those of the file.
struct Overlay {
  uint64_t begin = 0;  ///< their place in the file
  std::span<const std::byte> bytes;
};

/// Leaves the file's place where it is: it may be written to meanwhile, and flushed, up to what was there
/// when this was made.
class ExrInput : public Imf::IStream {
 public:
  explicit ExrInput(std::FILE* file, Overlay overlay = {});
  bool read(char bytes[], int count) override;
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }

 private:
  /// Throws if the file is shorter.
  void read_through(uint64_t from, std::span<std::byte> to) const;

  std::FILE* file_;
  Overlay overlay_;
  uint64_t end_;  ///< of the file
  uint64_t position_ = 0;
  /// OpenEXR reads headers and tables by a few bytes at a time.
  std::vector<std::byte> ahead_;
  uint64_t ahead_begin_ = 0;
};

}  // namespace rayfarm
