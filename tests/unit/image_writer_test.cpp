#include "common/image/image_writer.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "common/errors/input_error.h"
#include "common/files/read_file.h"
#include "common/files/sha256.h"
#include "common/image/image_file.h"
#include "host/farm/frame_writer.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

using Attributes = std::map<std::string, std::string>;
const Attributes kAsked{{"rayfarm/seed", "7"}, {"rayfarm/version", "1"}};

/// Each byte of colour another, so that little of it can be compressed: values in [0, 1).
Image make_noise(int width, int height, const PixelLayout& layout) {
  Image image{width, height, {0, 0, width, height}, layout, {}};
  image.pixels.resize(static_cast<size_t>(image.window.area()) * layout.bytes);
  uint64_t state = 88172645463325252u;
  for (std::byte* pixel = image.pixels.data(); pixel != image.pixels.data() + image.pixels.size();
       pixel += layout.bytes)
    for (const PixelChannel& channel : layout.channels) {
      state ^= state << 13, state ^= state >> 7, state ^= state << 17;  // Marsaglia 2003
      encode_values(channel.format, std::array{static_cast<double>(state >> 40) * 0x1p-24},
                    pixel + channel.offset_bytes);
    }
  return image;
}

/// A channel without colour beside others of another format.
PixelLayout mixed_layout() {
  PixelLayout layout = make_pixel_layout(PixelFormat::half_float);
  layout.channels.push_back({"Z", PixelFormat::float32, layout.bytes});
  layout.bytes += sizeof(float);
  return layout;
}

class ImageWriters : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::vector<std::filesystem::path> files() const {
    std::vector<std::filesystem::path> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) found.push_back(entry.path());
    return found;
  }
  static std::string bytes(const std::string& path) { return read_file(path, 1 << 30); }
  const std::filesystem::path folder_ =
      std::filesystem::path(test::write_temporary("x", "")).parent_path() / "writer";
};

void write_in_pieces(ImageWriter& writer, const Image& image, std::vector<int> pieces) {
  const size_t row = static_cast<size_t>(image.window.width()) * image.layout.bytes;
  std::span<const std::byte> left(image.pixels);
  for (size_t i = 0; !left.empty(); ++i) {
    const size_t count = std::min(left.size(), row * static_cast<size_t>(pieces[i % pieces.size()]));
    writer.write_rows(std::vector<std::byte>(left.begin(), left.begin() + static_cast<ptrdiff_t>(count)));
    left = left.subspan(count);
  }
}

TEST_F(ImageWriters, PiecesMakeTheSameFileAsOneCall) {
  Image crop = make_noise(333, 210, make_pixel_layout(PixelFormat::half_float));
  crop.width_px = 640, crop.height_px = 480;
  crop.window = {100, 90, 433, 300};
  // More than is read back at once: 12 and 8 MB of the file's rows.
  const std::vector<std::pair<const char*, Image>> cases{
      {"half.exr", make_noise(1500, 1000, make_pixel_layout(PixelFormat::half_float))},
      {"float.exr", make_noise(700, 701, make_pixel_layout(PixelFormat::float32))},
      {"rgb8.exr", make_noise(70, 33, make_pixel_layout(PixelFormat::rgb8))},
      {"crop.exr", crop},
      {"mixed.exr", make_noise(130, 47, mixed_layout())},
      {"narrow.exr", make_noise(1, 5000, make_pixel_layout(PixelFormat::half_float))},
      {"rgb8.png", make_noise(1500, 2000, make_pixel_layout(PixelFormat::rgb8))},
      {"half.png", make_noise(300, 200, make_pixel_layout(PixelFormat::half_float))},
      {"crop.png", crop}};
  for (const auto& [name, image] : cases) {
    write_image(file(name), image, kAsked);
    check_image_whole(file(name));
    const std::string whole = bytes(file(name));
    for (const std::vector<int>& pieces : {std::vector{1}, {7, 1, 64, 300}}) {
      ImageWriter writer(file(name), image, kAsked);
      write_in_pieces(writer, image, pieces);
      EXPECT_TRUE(bytes(file(name)) == whole) << "nothing stands there before the end";
      std::filesystem::remove(file(name));
      writer.finish();
      EXPECT_TRUE(bytes(file(name)) == whole) << name;
    }
  }
}

TEST_F(ImageWriters, LateAttributesAreReadLikeOthers) {
  for (const char* name : {"late.exr", "late.png"}) {
    const Image image = make_noise(90, 70, make_pixel_layout(natural_format(name)));
    for (const Attributes& late :
         {Attributes{{"rayfarm/rays", "18446744073709551615"}, {"rayfarm/b", "0"}}, Attributes{{"x", "5"}}}) {
      std::vector<std::string> names;
      for (const auto& [of, value] : late) names.insert(names.begin(), of);  // in any order
      ImageWriter writer(file(name), image, kAsked, names);
      writer.write_rows(image.pixels);
      writer.finish(late);
      check_image_whole(file(name));
      Attributes all = kAsked;
      all.insert(late.begin(), late.end());
      Attributes found = read_image_info(file(name)).attributes;
      EXPECT_EQ(found, all) << name;
    }
    // Nothing else of the file is another than where they are known before.
    const auto without_text = [](std::string all, const std::string& text) {
      const size_t at = all.find(text);
      return at == std::string::npos ? all : all.erase(at, text.size());
    };
    ImageWriter writer(file(name), image, {}, {"x"});
    writer.write_rows(image.pixels);
    writer.finish({{"x", "12345"}});
    const std::string late = bytes(file(name));
    if (std::string(name).ends_with("exr")) {
      write_image(file(name), image, {{"x", "12345" + std::string(15, ' ')}});
      EXPECT_TRUE(bytes(file(name)) == late);
    } else {
      write_image(file(name), image, {{"x", "12345"}});
      const std::string chunk = late.substr(late.find("tEXtx") - 4, 12 + 7);
      EXPECT_TRUE(without_text(late, chunk) == without_text(bytes(file(name)), chunk));
    }
  }
}

TEST_F(ImageWriters, AttributesThatAreNotThoseSaidAreRefused) {
  const Image image = make_noise(9, 7, make_pixel_layout(PixelFormat::rgb8));
  for (const Attributes& late :
       {Attributes{}, {{"y", "1"}}, {{"x", "1"}, {"y", "1"}}, {{"x", "123456789012345678901"}}}) {
    ImageWriter writer(file("a.png"), image, {}, {"x"});
    writer.write_rows(image.pixels);
    EXPECT_THROW(writer.finish(late), std::logic_error);
  }
  ImageWriter writer(file("a.png"), image, {});
  writer.write_rows(std::span(image.pixels).first(27));
  EXPECT_THROW(writer.write_rows(std::span(image.pixels).first(26)), std::logic_error);
  EXPECT_THROW(writer.write_rows(image.pixels), std::logic_error);
  EXPECT_THROW(writer.finish(), std::logic_error);
}

TEST_F(ImageWriters, WhatIsNotFinishedLeavesNothing) {
  for (const char* name : {"a.exr", "a.png"}) {
    const Image image = make_noise(90, 70, make_pixel_layout(natural_format(name)));
    ImageWriter writer(file(name), image, kAsked);
    writer.write_rows(std::span(image.pixels).first(90 * 20 * image.layout.bytes));
    ASSERT_EQ(files().size(), 1u);
    EXPECT_TRUE(files()[0].string().ends_with(".part"));
  }
  EXPECT_TRUE(files().empty());
}

/// Turns a bit of the one file there is, in the making.
void damage(const std::filesystem::path& path, uint64_t at) {
  std::fstream part(path, std::ios::in | std::ios::out | std::ios::binary);
  part.seekg(static_cast<std::streamoff>(at));
  const int byte = part.get();
  ASSERT_NE(byte, EOF);
  part.seekp(static_cast<std::streamoff>(at));
  part.put(static_cast<char>(byte ^ 4));
}

TEST_F(ImageWriters, DamageIsFoundInPassing) {
  for (const char* name : {"a.exr", "a.png"}) {
    const Image image = make_noise(2048, 2048, make_pixel_layout(natural_format(name)));
    const size_t row = image.layout.bytes * 2048;
    // Of the rows that were not read back yet: of EXR 256 at once, of PNG 683.
    for (const double part : {0.2, 0.8}) {
      ImageWriter writer(file(name), image, kAsked);
      writer.write_rows(std::span(image.pixels).first(200 * row));
      ASSERT_EQ(files().size(), 1u);
      damage(files()[0],
             static_cast<uint64_t>(part * static_cast<double>(std::filesystem::file_size(files()[0]))));
      try {
        for (size_t at = 200 * row; at < 1000 * row; at += row)
          writer.write_rows(std::span(image.pixels).subspan(at, row));
        FAIL() << name;
      } catch (const IoError& e) {
        EXPECT_NE(std::string(e.what()).find(std::string(name) + ": can't be written: "), std::string::npos)
            << e.what();
      }
      EXPECT_TRUE(files().empty()) << name;
    }
  }
}

// What is not pixels: the header of an EXR file, and what comes after the rows.
TEST_F(ImageWriters, DamageBesidePixelsIsFoundAtTheEnd) {
  const Image image = make_noise(64, 64, make_pixel_layout(PixelFormat::half_float));
  write_image(file("a.exr"), image, kAsked);
  const size_t of_seed = bytes(file("a.exr")).find("rayfarm/seed") + 12 + 1 + 7 + 4;  // its value
  std::filesystem::remove(file("a.exr"));
  ImageWriter writer(file("a.exr"), image, kAsked);
  writer.write_rows(std::span(image.pixels).first(32 * 64 * image.layout.bytes));
  ASSERT_EQ(files().size(), 1u);
  damage(files()[0], of_seed);
  writer.write_rows(std::span(image.pixels).subspan(32 * 64 * image.layout.bytes));
  try {
    writer.finish();
    FAIL();
  } catch (const IoError& e) {
    EXPECT_NE(std::string(e.what()).find("what was read back differs"), std::string::npos) << e.what();
  }
  EXPECT_TRUE(files().empty());
}

/// Ends the process well if `work` returns true. It is one begun anew, and not a fork of this one, whose
/// limits can be set: OpenImageIO has given OpenEXR threads, which a fork would wait for and not have.
template <typename Work>
[[noreturn]] void exit_if(Work work) {
  bool is_good = false;
  try {
    is_good = work();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
  }
  std::error_code ignored;
  std::filesystem::remove_all(std::filesystem::path(test::write_temporary("x", "")).parent_path(), ignored);
  _exit(is_good ? 0 : 1);
}

TEST_F(ImageWriters, AFullDiskIsNamedAndLeavesNothing) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const char* name : {"a.exr", "a.png"})
    EXPECT_EXIT(exit_if([&] {
                  const Image image = make_noise(1000, 1000, make_pixel_layout(natural_format(name)));
                  signal(SIGXFSZ, SIG_IGN);
                  const rlimit limit{1 << 20, 1 << 20};
                  setrlimit(RLIMIT_FSIZE, &limit);
                  try {
                    write_image(file(name), image, kAsked);
                  } catch (const IoError& e) {
                    return std::string(e.what()).find(std::strerror(EFBIG)) != std::string::npos &&
                           files().empty();
                  }
                  return false;
                }),
                testing::ExitedWithCode(0), "")
        << name;
}

#ifndef __SANITIZE_ADDRESS__  // which takes address space of its own
// A plain picture is the worst for PNG: its compressor holds back millions of pixels.
TEST_F(ImageWriters, MemoryIsThatOfSomeRows) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const char* name : {"plain.exr", "plain.png"})
    EXPECT_EXIT(exit_if([&] {
                  const int width = 16384, height = 1536;
                  const Image image{
                      width, height, {0, 0, width, height}, make_pixel_layout(natural_format(name)), {}};
                  const std::vector<std::byte> row(width * image.layout.bytes);
                  std::ifstream statm("/proc/self/statm");
                  uint64_t pages = 0;
                  statm >> pages;
                  // Of the rows there are 72 and 144 MiB.
                  const uint64_t bytes = pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE)) + (48 << 20);
                  const rlimit limit{bytes, bytes};
                  setrlimit(RLIMIT_AS, &limit);
                  ImageWriter writer(file(name), image, {});
                  for (int y = 0; y < height; ++y) writer.write_rows(row);
                  writer.finish();
                  return true;
                }),
                testing::ExitedWithCode(0), "")
        << name;
}
#endif

TEST(Sha256, OfPiecesIsThatOfTheWhole) {
  // FIPS 180-4's example, "abc".
  const std::string abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
  const std::string text = "abc";
  EXPECT_EQ(sha256(std::as_bytes(std::span(text))), abc);
  Sha256 sum;
  for (const char& c : text) sum.update(std::as_bytes(std::span(&c, 1)));
  EXPECT_EQ(sum.digest(), abc);
}

class FrameWriters : public ImageWriters {
 protected:
  using Rows = std::shared_ptr<const std::vector<std::byte>>;
  FrameWriter::Job job(int frame, const std::string& name) const {
    return {FrameIndex(frame),
            file(name),
            {image_.width_px, image_.height_px, image_.window, image_.layout, {}},
            kAsked};
  }
  /// Rows [y, y + count).
  Rows band(size_t y, size_t count) const {
    const size_t row = image_.layout.bytes * static_cast<size_t>(image_.width_px);
    const auto begin = image_.pixels.begin() + static_cast<ptrdiff_t>(y * row);
    return std::make_shared<std::vector<std::byte>>(begin, begin + static_cast<ptrdiff_t>(count * row));
  }
  const Image image_ = make_noise(64, 64, make_pixel_layout(PixelFormat::rgb8));
};

TEST_F(FrameWriters, WriteAllThatIsQueuedBeforeTheyEnd) {
  FrameWriter writer;
  std::vector<PictureInWriting> pictures;
  for (int i = 0; i < 20; ++i) {
    FrameWriter::Job of = job(i, fmt::format("queued{}.png", i));
    of.late = {"rayfarm/rays"};
    pictures.push_back(writer.begin(std::move(of)));
  }
  for (const size_t y : {0u, 24u})  // band by band, of all at once
    for (const PictureInWriting picture : pictures) writer.write(picture, band(y, y == 0 ? 24 : 40));
  for (const PictureInWriting picture : pictures) writer.end(picture, {{"rayfarm/rays", "12"}});
  writer.finish();
  int taken = 0;
  while (const auto written = writer.try_take()) {
    EXPECT_EQ(written->problem, "");
    EXPECT_EQ(written->sha256, sha256(image_.pixels));
    EXPECT_FALSE(written->is_black);
    EXPECT_EQ(written->frame.value(), taken);
    EXPECT_EQ(written->picture, pictures[static_cast<size_t>(taken)]);
    ++taken;
  }
  EXPECT_EQ(taken, 20);
  std::map<PictureInWriting, int> rows;
  while (const auto written = writer.try_take_band()) rows[written->picture] += written->rows;
  for (const PictureInWriting picture : pictures) EXPECT_EQ(rows[picture], 64);
  write_image(file("whole.png"), image_, kAsked);
  for (int i = 0; i < 20; ++i)
    EXPECT_EQ(read_image_info(file(fmt::format("queued{}.png", i))).attributes.at("rayfarm/rays"), "12");
}

TEST_F(FrameWriters, TellBlackPictures) {
  FrameWriter writer;
  const std::vector<std::byte> black(image_.pixels.size());
  std::vector<std::byte> nearly = black;
  nearly[black.size() - 1] = std::byte{1};
  for (const auto& of : {black, nearly}) {
    const PictureInWriting picture = writer.begin(job(0, "black.png"));
    writer.write(picture, std::make_shared<std::vector<std::byte>>(of));
    writer.end(picture);
  }
  writer.finish();
  EXPECT_TRUE(writer.try_take()->is_black);
  EXPECT_FALSE(writer.try_take()->is_black);
}

TEST_F(FrameWriters, LeaveNothingOfWhatIsDroppedOrFails) {
  {
    FrameWriter writer;
    const PictureInWriting dropped = writer.begin(job(0, "dropped.png")),
                           left = writer.begin(job(1, "left.png")),
                           failed = writer.begin(job(2, "none/failed.png")),
                           good = writer.begin(job(3, "good.png"));
    for (const PictureInWriting picture : {dropped, left, failed}) writer.write(picture, band(0, 32));
    writer.drop(dropped);
    writer.write(failed, band(32, 32));  // swallowed
    writer.end(failed);
    writer.write(good, band(0, 64));
    writer.end(good);
    writer.finish();
    const auto first = writer.try_take(), second = writer.try_take();
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->picture, failed);
    EXPECT_NE(first->problem.find("none/failed.png: can't be written: "), std::string::npos)
        << first->problem;
    EXPECT_EQ(second->picture, good);
    EXPECT_EQ(second->problem, "");
    EXPECT_FALSE(writer.try_take());
    int rows = 0;
    while (const auto band = writer.try_take_band()) rows += band->rows;
    // What waits of one that is dropped is not told.
    EXPECT_TRUE(rows == 32 + 64 + 64 || rows == 32 + 32 + 64 + 64) << rows;
  }
  ASSERT_EQ(files().size(), 1u);
  EXPECT_EQ(files()[0].filename(), "good.png");
}

}  // namespace
}  // namespace rayfarm
