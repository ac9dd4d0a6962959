#include "host/farm/journal.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "common/errors/input_error.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

const JournalLines kLines{{"version", "1"}, {"scene", "with blanks in it"}, {"frame", "7"}};

Bytes record_of(size_t size, int seed) {
  Bytes record(size);
  for (size_t i = 0; i < size; ++i) record[i] = static_cast<std::byte>(seed + static_cast<int>(i) * 7);
  return record;
}

std::vector<Bytes> records_in(const std::string& path, uint64_t* end = nullptr) {
  std::vector<Bytes> records;
  const uint64_t whole = read_journal(path, *read_journal_head(path), [&](std::span<const std::byte> record) {
    records.emplace_back(record.begin(), record.end());
  });
  if (end) *end = whole;
  return records;
}

std::string contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A journal of three records.
std::string written(const std::string& name) {
  const std::string path = test::write_temporary(name, "");
  std::filesystem::remove(path);
  JournalWriter writer(0.01);
  writer.begin(path, kLines);
  for (int i = 0; i < 3; ++i) writer.append(path, record_of(size_t{100} << (4 * i), i));
  return path;  // the writer's end puts all on the disk
}

TEST(Journal, WhatIsAppendedIsReadBack) {
  const std::string path = written("back.journal");
  EXPECT_EQ(read_journal_head(path)->lines, kLines);
  EXPECT_EQ(read_journal_head(path)->value("scene"), "with blanks in it");
  EXPECT_EQ(read_journal_head(path)->value("none"), "");
  const auto records = records_in(path);
  ASSERT_EQ(records.size(), 3u);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(records[static_cast<size_t>(i)], record_of(size_t{100} << (4 * i), i));
}

TEST(Journal, CutAnywhereTheWholeRecordsAreRead) {
  const std::string path = written("cut.journal"), whole = contents(path);
  const uint64_t begin = read_journal_head(path)->bytes;
  const std::vector<uint64_t> ends{begin, begin + 108, begin + 108 + 1608, whole.size()};
  for (uint64_t size = begin; size <= whole.size(); size += 97) {
    std::ofstream(path, std::ios::binary) << whole.substr(0, size);
    uint64_t end = 0;
    const size_t count = records_in(path, &end).size();
    EXPECT_EQ(end, ends[count]);
    EXPECT_TRUE(size >= ends[count] && (count == 3 || size < ends[count + 1])) << size;
  }
}

TEST(Journal, AFlippedBitEndsIt) {
  const std::string path = written("flip.journal"), whole = contents(path);
  const uint64_t begin = read_journal_head(path)->bytes;
  for (uint64_t at = begin; at < begin + 108 + 1608; at += 13) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    std::ofstream(path, std::ios::binary) << damaged;
    EXPECT_EQ(records_in(path).size(), at < begin + 108 ? 0u : 1u) << at;
  }
}

TEST(Journal, GoesOnBehindTheGoodPart) {
  const std::string path = written("on.journal"), whole = contents(path);
  std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() - 5);
  uint64_t end = 0;
  records_in(path, &end);
  {
    JournalWriter writer(10);  // its end writes, not its time
    writer.go_on(path, end);
    writer.append(path, record_of(50, 9));
  }
  const auto records = records_in(path);
  ASSERT_EQ(records.size(), 3u);
  EXPECT_EQ(records[2], record_of(50, 9));
}

TEST(Journal, GoesWhenItsFileIsWhole) {
  const std::string path = written("gone.journal");
  JournalWriter writer(0.01);
  writer.begin(path, kLines);
  writer.append(path, record_of(10, 1));
  writer.sync();
  EXPECT_EQ(records_in(path).size(), 1u);  // the one that was there was begun anew
  writer.remove(path);
  writer.sync();
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_TRUE(writer.take_problems().empty());
}

TEST(Journal, WhatIsNoneIsRefusedAndKept) {
  for (const char* text : {"rayfarm-journal 2\nversion 1\n\n", "P6 3 3"}) {
    const std::string path = test::write_temporary("none.journal", text);
    EXPECT_THROW(read_journal_head(path), IoError) << text;
    EXPECT_FALSE(is_journal(path));
    JournalWriter writer(0.005);
    writer.begin(path, kLines);
    writer.append(path, record_of(10, 0));
    writer.sync();
    EXPECT_EQ(writer.take_problems().size(), 1u);
    EXPECT_FALSE(writer.is_whole(path));
    EXPECT_EQ(contents(path), text);
  }
}

TEST(Journal, OneThatWasOnlyBegunIsBegunAnew) {
  const std::string path = test::write_temporary("begun.journal", "");
  for (const char* text : {"", "rayf", "rayfarm-journal 1\n", "rayfarm-journal 1\nversion 1\n"}) {
    std::ofstream(path, std::ios::binary) << text;
    EXPECT_FALSE(read_journal_head(path)) << text;
    EXPECT_TRUE(is_journal(path));
  }
}

TEST(Journal, NoLinkIsFollowed) {
  const std::string victim = test::write_temporary("victim", "rayfarm-journal 1\n"),
                    path = test::write_temporary("link.journal", "");
  std::filesystem::remove(path);
  std::filesystem::create_symlink(victim, path);
  JournalWriter writer(0.005);
  writer.begin(path, kLines);
  writer.append(path, record_of(10, 0));
  writer.sync();
  EXPECT_EQ(writer.take_problems().size(), 1u);
  EXPECT_EQ(contents(victim), "rayfarm-journal 1\n");
}

TEST(Journal, WhatCannotBeWrittenIsToldOnce) {
  const std::string path = test::write_temporary("file", "") + "/of.journal";
  JournalWriter writer(0.005);
  writer.begin(path, kLines);
  for (int i = 0; i < 5; ++i) {
    writer.append(path, record_of(10, i));
    writer.sync();
  }
  EXPECT_EQ(writer.take_problems().size(), 1u);
  EXPECT_TRUE(writer.take_problems().empty());
}

TEST(Journal, ThatOfAnotherJobIsLeftAlone) {
  const std::string path = test::write_temporary("shared.journal", "");
  std::filesystem::remove(path);
  EXPECT_NE(use_of_journal(path), JournalUse::by_a_job);
  std::string before;
  {
    JournalWriter first(0.005), second(0.005);
    first.begin(path, kLines);
    first.append(path, record_of(10, 0));
    first.sync();
    EXPECT_EQ(use_of_journal(path), JournalUse::by_a_job);
    before = contents(path);
    second.begin(path, kLines);
    second.append(path, record_of(20, 1));
    second.sync();
    const auto problems = second.take_problems();
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_NE(problems[0].find("another job writes it"), std::string::npos) << problems[0];
    EXPECT_EQ(contents(path), before);
    first.append(path, record_of(10, 2));
    first.sync();
    EXPECT_EQ(records_in(path).size(), 2u);
  }
  EXPECT_NE(use_of_journal(path), JournalUse::by_a_job);
}

TEST(Journal, NoneIsKeptWithoutATime) {
  const std::string path = test::write_temporary("never.journal", "");
  std::filesystem::remove(path);
  {
    JournalWriter writer(0);
    writer.begin(path, kLines);
    writer.append(path, record_of(10, 1));
    writer.sync();
    writer.remove(path);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace rayfarm
