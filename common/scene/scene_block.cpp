#include "common/scene/scene_block.h"

#include <fmt/core.h>

#include <cereal/archives/portable_binary.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/vector.hpp>
#include <cstring>
#include <new>
#include <sstream>

#include "common/scene/animation.h"
#include "common/scene/scene_checks.h"

namespace rayfarm {
namespace {

constexpr size_t kAlignment = 64;
constexpr uint64_t kMagic = 0x31304d5241465952ULL;  // "RYFARM01" in memory

struct Prefix {
  uint64_t magic = kMagic;
  uint64_t total_bytes = 0;
  uint64_t table_offset = 0;
  uint64_t table_bytes = 0;
};

struct ArrayEntry {
  std::string name;
  uint64_t offset = 0, count = 0, stride = 0;
  template <typename Archive>
  void serialize(Archive& archive) {
    archive(name, offset, count, stride);
  }
};

size_t aligned(size_t n) {
  return (n + kAlignment - 1) / kAlignment * kAlignment;
}

[[noreturn]] void damaged(const std::string& what) {
  throw SceneBlockError(what);
}

bool range_fits(uint64_t first, uint64_t count, size_t size) {
  return first <= size && count <= size - first;
}

}  // namespace

Vec4 Scene::eval(uint32_t curve, double frame) const {
  const CurveRecord& c = curves[curve];
  return eval_curve(static_cast<Interpolation>(c.interpolation), key_frames.subspan(c.first_key, c.key_count),
                    key_values.subspan(c.first_key, c.key_count), frame);
}

SceneBlock encode_scene(const Scene& scene) {
  std::vector<ArrayEntry> table;
  size_t end = aligned(sizeof(Prefix));
  for_each_array(scene, [&]<typename T>(const char* name, std::span<const T> array) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAlignment);
    table.push_back({name, end, array.size(), sizeof(T)});
    end = aligned(end + array.size_bytes());
  });
  std::ostringstream out;
  {
    cereal::PortableBinaryOutputArchive archive(out);
    archive(table);
  }
  const std::string table_bytes = out.str();
  const Prefix prefix{kMagic, aligned(end + table_bytes.size()), end, table_bytes.size()};
  SceneBlock block;
  block.size = prefix.total_bytes;
  block.data.reset(static_cast<std::byte*>(allocate_large(block.size)));
  std::memset(block.data.get(), 0, block.size);  // gaps too: equal scenes are equal bytes
  std::memcpy(block.data.get(), &prefix, sizeof prefix);
  size_t i = 0;
  for_each_array(scene, [&]<typename T>(const char*, std::span<const T> array) {
    if (!array.empty()) std::memcpy(block.data.get() + table[i].offset, array.data(), array.size_bytes());
    ++i;
  });
  std::memcpy(block.data.get() + prefix.table_offset, table_bytes.data(), table_bytes.size());
  return block;
}

Scene decode_scene(std::span<const std::byte> bytes) {
  Prefix prefix;
  if (bytes.size() < sizeof prefix) damaged("it is too short");
  std::memcpy(&prefix, bytes.data(), sizeof prefix);
  if (prefix.magic != kMagic) damaged("it doesn't begin with Rayfarm's mark");
  if (prefix.total_bytes != bytes.size()) damaged("its size is not what it says");
  if (reinterpret_cast<uintptr_t>(bytes.data()) % kAlignment != 0) damaged("it is not aligned");
  if (!range_fits(prefix.table_offset, prefix.table_bytes, bytes.size())) damaged("its table is outside");
  constexpr uint64_t kMostTableBytes = 1 << 16;
  if (prefix.table_bytes > kMostTableBytes) damaged("its table is too long");

  std::vector<ArrayEntry> table;
  try {
    std::istringstream in(
        std::string(reinterpret_cast<const char*>(bytes.data() + prefix.table_offset), prefix.table_bytes));
    cereal::PortableBinaryInputArchive archive(in);
    // Counts are checked before cereal allocates for them: a damaged length must not ask for all memory.
    cereal::size_type count = 0;
    archive(cereal::make_size_tag(count));
    if (count > 1000) damaged("its table has too many entries");
    for (cereal::size_type i = 0; i < count; ++i) {
      ArrayEntry entry;
      cereal::size_type length = 0;
      archive(cereal::make_size_tag(length));
      if (length > 100) damaged("a name in its table is too long");
      entry.name.resize(length);
      archive(cereal::binary_data(entry.name.data(), length));
      archive(entry.offset, entry.count, entry.stride);
      table.push_back(entry);
    }
  } catch (const cereal::Exception& e) {
    damaged(fmt::format("its table can't be read ({})", e.what()));
  }

  Scene scene;
  size_t i = 0;
  for_each_array(scene, [&]<typename T>(const char* name, std::span<const T>& array) {
    if (i >= table.size() || table[i].name != name) damaged(fmt::format("the array '{}' is missing", name));
    const ArrayEntry& entry = table[i++];
    if (entry.stride != sizeof(T) || entry.offset % kAlignment != 0 || entry.count > bytes.size() ||
        !range_fits(entry.offset, entry.count * sizeof(T), bytes.size()))
      damaged(fmt::format("the array '{}' lies outside", name));
    array = {reinterpret_cast<const T*>(bytes.data() + entry.offset), entry.count};
  });
  check_scene(scene);
  return scene;
}

}  // namespace rayfarm
