#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <climits>
#include <filesystem>
#include <fstream>

#include "common/errors/input_error.h"
#include "common/files/whole_file.h"
#include "common/image/half_float.h"
#include "common/image/image_file.h"
#include "common/textures/image_texture.h"
#include "test_scene.h"

namespace rayfarm {
namespace {

const std::map<std::string, std::string> kAttributes{{"rayfarm/seed", "7"}, {"rayfarm/version", "1"}};

/// A crop of 50 × 70 pixels, whose rows are more than what is written at once, each pixel different.
Image make_crop(PixelFormat format) {
  Image image{640, 480, {100, 90, 150, 160}, make_pixel_layout(format), {}};
  image.pixels.resize(static_cast<size_t>(image.window.area()) * image.layout.bytes);
  std::byte* out = image.pixels.data();
  for (int64_t i = 0; i < image.window.area(); ++i, out += image.layout.bytes) {
    const double x = static_cast<double>(i * 7919 % 3500) / 3500;
    encode_values(image.layout.channels[0].format, std::array{x, 1 - x, x * x}, out);
  }
  return image;
}

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(PixelFormat, SrgbThereAndBack) {
  for (int i = 0; i < 256; ++i) EXPECT_EQ(encode_srgb8(decode_srgb8(static_cast<uint8_t>(i))), i);
  EXPECT_EQ(encode_srgb8(-1), 0);
  EXPECT_EQ(encode_srgb8(7), 255);
  EXPECT_EQ(encode_srgb8(std::nan("")), 0);
  EXPECT_EQ(encode_srgb8(0.5), 188);  // IEC 61966-2-1: 1.055 · 0.5^(1/2.4) - 0.055 = 0.7354
}

// Between the values that begin a byte and those that begin a step of the table nothing can change: so both
// sides of all of them are all there is to test.
TEST(PixelFormat, BytesChangeWhereTheyRoundAndNowhereElse) {
  std::vector<double> begins;  // [i]: of byte i + 1
  for (int i = 0; i < 255; ++i) begins.push_back(decode_srgb((i + 0.5) / 255));
  const auto expect_byte = [&](double linear) {
    EXPECT_EQ(encode_srgb8(linear), std::upper_bound(begins.begin(), begins.end(), linear) - begins.begin())
        << linear;
  };
  for (const double end : begins)
    for (const double side : {-1.0, 0.0, 2.0}) expect_byte(side == 0 ? end : std::nextafter(end, side));
  for (int step = 0; step <= 8192; ++step)
    for (const double side : {-1.0, 0.0, 2.0})
      expect_byte(side == 0 ? step / 8192.0 : std::nextafter(step / 8192.0, side));
  for (const double linear : {-0.0, 5e-324, -1e300, 1e300, HUGE_VAL, -HUGE_VAL}) expect_byte(linear);
}

TEST(ImageFiles, SayWhatTheyHold) {
  for (const PixelFormat format : {PixelFormat::rgb8, PixelFormat::half_float, PixelFormat::float32}) {
    const Image image = make_crop(format);
    const std::string path = test::write_temporary(format == PixelFormat::rgb8 ? "a.png" : "a.exr", "");
    write_image(path, image, kAttributes);
    check_image_whole(path);
    const ImageInfo info = read_image_info(path);
    EXPECT_EQ(info.format, format);
    for (const auto& [name, value] : kAttributes) {
      ASSERT_TRUE(info.attributes.contains(name));
      EXPECT_EQ(info.attributes.at(name), value);
    }
    if (format == PixelFormat::rgb8) {
      EXPECT_EQ(info.width_px, 50);
      EXPECT_EQ(info.height_px, 70);
      EXPECT_EQ(info.window, (PixelRect{0, 0, 50, 70}));
    } else {
      EXPECT_EQ(info.width_px, 640);
      EXPECT_EQ(info.height_px, 480);
      EXPECT_EQ(info.window, image.window);
    }
    // And the pixels are where they belong, whatever module reads them.
    const std::vector<float> back = test::read_pixels(path);
    ASSERT_EQ(back.size(), 3u * 50 * 70);
    for (const size_t pixel : {size_t{0}, size_t{49}, size_t{50 * 64}, size_t{3499}})
      for (size_t c = 0; c < 3; ++c) {
        const double read = static_cast<double>(back[3 * pixel + c]);
        EXPECT_NEAR(format == PixelFormat::rgb8 ? decode_srgb(read) : read, channel_value(image, pixel, c),
                    1e-6);
      }
  }
}

TEST(ImageFiles, DamagedPngEndsInOurWordsAlone) {
  const std::string path = test::write_temporary("damaged.png", "");
  write_image(path, make_crop(PixelFormat::rgb8), kAttributes);
  const std::string whole = bytes_of(path);
  const auto problem_of = [&](const std::string& bytes) {
    write_bytes(path, bytes);
    testing::internal::CaptureStderr();
    std::string problem;
    try {
      test::read_pixels(path);
    } catch (const IoError& e) {
      problem = e.what();
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    return problem;
  };
  EXPECT_EQ(problem_of(whole), "");
  EXPECT_NE(problem_of(whole.substr(0, whole.size() / 2)).find("the file is cut off"), std::string::npos);
  std::string bytes = whole;
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  EXPECT_NE(problem_of(bytes).find("the checksum of its chunk at byte"), std::string::npos);
}

TEST(ImageFiles, WhatIsNotWholeIsFound) {
  for (const char* name : {"damaged.png", "damaged.exr"}) {
    const std::string path = test::write_temporary(name, "");
    write_image(path, make_crop(natural_format(path)), kAttributes);
    const std::string whole = bytes_of(path);
    for (size_t length = 0; length < whole.size(); length += 1 + length / 20) {
      write_bytes(path, whole.substr(0, length));
      EXPECT_THROW(check_image_whole(path), IoError) << name << " cut to " << length;
    }
    write_bytes(path, whole.substr(0, whole.size() - 1));
    EXPECT_THROW(check_image_whole(path), IoError) << name;
    // In the middle of the pixels' data, which both formats hold with a sum to check it by.
    for (size_t at = whole.size() / 2; at < whole.size() / 2 + 40; ++at) {
      std::string bytes = whole;
      bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
      write_bytes(path, bytes);
      EXPECT_THROW(check_image_whole(path), IoError) << name << " at " << at;
    }
    write_bytes(path, "no picture at all");
    EXPECT_THROW(read_image_info(path), IoError);
  }
  EXPECT_THROW(check_image_whole("/nowhere/a.png"), IoError);
}

TEST(ImageFiles, HeadersAreNotBelieved) {
  // A PNG whose header claims other sizes: four bytes each, and their sum to check them by.
  const std::string path = test::write_temporary("claims.png", "");
  write_image(path, make_crop(PixelFormat::rgb8), {});
  const std::string whole = bytes_of(path);
  const auto claim = [&](uint32_t width, uint32_t height) {
    std::string bytes = whole;
    const auto put = [&bytes](size_t at, uint32_t value) {
      for (size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(value >> (24 - 8 * i));
    };
    put(16, width);
    put(20, height);
    uint32_t crc = ~0u;
    for (size_t i = 12; i < 29; ++i) {
      crc ^= static_cast<uint8_t>(bytes[i]);
      for (int k = 0; k < 8; ++k) crc = crc & 1 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
    }
    put(29, ~crc);
    write_bytes(path, bytes);
  };
  const auto error = [&] {
    Texture texture;
    try {
      load_texels(path, texture, limits::kTexturePixels);
    } catch (const IoError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  claim(50, 70);
  EXPECT_EQ(error(), "");
  claim(30000, 20000);  // 7 GB as floats
  EXPECT_NE(error().find("30000 × 20000 pixels"), std::string::npos) << error();
  EXPECT_NE(error().find(fmt::format("{} bytes", whole.size())), std::string::npos) << error();
  claim(50, 700);  // could be, but is not
  EXPECT_NE(error(), "");
  write_bytes(path, whole);
  try {
    ImageReader(path, 3499);
    FAIL() << "3500 pixels were read";
  } catch (const IoError& e) {
    EXPECT_NE(std::string(e.what()).find("more than the 3499"), std::string::npos) << e.what();
  }
}

TEST(ImageFiles, LoadingThemStops) {
  const std::string path = test::write_temporary("stop.png", "");
  write_image(path, make_crop(PixelFormat::rgb8), {});
  std::stop_source stop;
  stop.request_stop();
  Texture texture;
  EXPECT_THROW(load_texels(path, texture, limits::kTexturePixels, stop.get_token()), Stopped);
}

class WholeFiles : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  static void write(const std::filesystem::path& path, const std::string& text) {
    write_whole_file(path.string(), [&](std::FILE* file) { std::fputs(text.c_str(), file); });
  }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      found.push_back(entry.path().filename().string());
    std::sort(found.begin(), found.end());
    return found;
  }
  const std::filesystem::path folder_ =
      std::filesystem::path(test::write_temporary("x", "")).parent_path() / "whole";
};

TEST_F(WholeFiles, LeaveNothingWhenTheyFail) {
  write(folder_ / "a.txt", "before");
  EXPECT_THROW(write_whole_file((folder_ / "a.txt").string(),
                                [](std::FILE* file) {
                                  std::fputs("half", file);
                                  throw std::runtime_error("no more");
                                }),
               IoError);
  EXPECT_EQ(bytes_of((folder_ / "a.txt").string()), "before");
  EXPECT_EQ(names(), std::vector<std::string>{"a.txt"});
  EXPECT_THROW(write(folder_ / "none" / "a.txt", ""), IoError);
  const std::string longest(NAME_MAX, 'n');
  write(folder_ / longest, "long");
  EXPECT_EQ(bytes_of((folder_ / longest).string()), "long");
}

TEST_F(WholeFiles, DoNotFollowLinksOrReplaceDevices) {
  write_bytes((folder_ / "victim").string(), "untouched");
  for (const std::string& name : {fmt::format(".a.exr.{}.part", getpid()), std::string("a.txt.part")})
    std::filesystem::create_symlink(folder_ / "victim", folder_ / name);
  write(folder_ / "a.txt", "text");
  const std::string picture = (folder_ / "a.exr").string();
  write_image(picture, make_crop(PixelFormat::half_float), {});
  EXPECT_EQ(bytes_of((folder_ / "victim").string()), "untouched");
  std::filesystem::create_directory(folder_ / "taken");
  EXPECT_THROW(write(folder_ / "taken", "text"), IoError);
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(write(folder_ / "pipe", "text"), IoError);
  EXPECT_TRUE(std::filesystem::is_fifo(folder_ / "pipe"));
}

TEST_F(WholeFiles, RemoveWhatDeadProcessesOfThisMachineLeft) {
  const pid_t dead = fork();
  if (dead == 0) _exit(0);
  ASSERT_EQ(waitpid(dead, nullptr, 0), dead);
  const pid_t not_asked = fork();  // how it ended: its number is still taken
  if (not_asked == 0) _exit(0);
  siginfo_t info;
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(not_asked), &info, WEXITED | WNOWAIT), 0);
  char host[HOST_NAME_MAX + 1] = "";
  gethostname(host, sizeof host - 1);
  const std::string random = "0123456789abcdef0";
  const auto part = [&](const std::string& of, const std::string& on, pid_t process) {
    return fmt::format(".{}.{}.{}.{}.part", of, on, process, random);
  };
  const std::vector<std::string> gone{part("a.txt", host, dead), part("a.txt", host, not_asked),
                                      part("a.txt", host, getpid())};  // of a process that had our number
  std::vector<std::string> kept{part("a.txt", host, getppid()), part("a.txt", "elsewhere", dead),
                                part("b.txt", host, dead), fmt::format(".a.txt.{}.{}.part", host, dead)};
  for (const auto& all : {gone, kept})
    for (const std::string& name : all) write_bytes((folder_ / name).string(), "");
  write(folder_ / "a.txt", "text");
  kept.push_back("a.txt");
  std::sort(kept.begin(), kept.end());
  EXPECT_EQ(names(), kept);
  waitpid(not_asked, nullptr, 0);
}

}  // namespace
}  // namespace rayfarm
