#include "common/scene/scene_block.h"

#include <fmt/core.h>

#include <algorithm>
#include <cereal/archives/portable_binary.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/vector.hpp>
#include <cstring>
#include <sstream>

#include "common/scene/animation.h"
#include "common/scene/scene_checks.h"
#include "common/scene/tracing_state.h"

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

/// A block of the arrays; copy(to, array) copies the elements of each.
template <typename Arrays, typename Copy>
SceneBlock encode(Arrays& arrays, Copy copy) {
  std::vector<ArrayEntry> table;
  size_t end = aligned(sizeof(Prefix));
  for_each_array(arrays, [&](const char* name, const auto& array) {
    using T = std::remove_cvref_t<decltype(array[0])>;
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAlignment);
    table.push_back({name, end, array.size(), sizeof(T)});
    end = aligned(end + array.size() * sizeof(T));
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
  std::byte* const data = block.data.get();
  size_t written = 0;
  const auto go_to = [&](size_t at) {  // gaps are zero: equal scenes are equal bytes
    std::memset(data + written, 0, at - written);
    written = at;
  };
  std::memcpy(data, &prefix, sizeof prefix);
  written = sizeof prefix;
  size_t i = 0;
  for_each_array(arrays, [&](const char*, auto& array) {
    const ArrayEntry& entry = table[i++];
    go_to(entry.offset);
    copy(data + entry.offset, array);
    written += entry.count * entry.stride;
  });
  go_to(prefix.table_offset);
  std::memcpy(data + prefix.table_offset, table_bytes.data(), table_bytes.size());
  written += table_bytes.size();
  go_to(block.size);
  return block;
}

bool range_fits(uint64_t first, uint64_t count, size_t size) {
  return first <= size && count <= size - first;
}

}  // namespace

Vec4 Scene::eval(uint32_t curve, double frame) const {
  const CurveRecord& c = curves[curve];
  return eval_curve(static_cast<Interpolation>(c.interpolation), key_frames.subspan(c.first_key, c.key_count),
                    key_values.subspan(c.first_value, c.value_count()), frame);
}

Affine Scene::eval_steps(uint32_t first, uint32_t count, double frame) const {
  Affine all;
  for (const TransformStepRecord& step : steps.subspan(first, count))
    all = eval_transform(static_cast<TransformKind>(step.kind), eval(step.curve, frame), step.axis,
                         step.matrix) *
          all;
  return all;
}

SceneBlock encode_scene(const Scene& scene) {
  return encode(scene, [](std::byte* to, const auto& array) {
    if (!array.empty()) std::memcpy(to, array.data(), array.size_bytes());
  });
}

SceneBlock encode_scene(SceneArrays<GrowingArray>&& arrays) {
  return encode(arrays, []<typename T>(std::byte* to, GrowingArray<T>& array) {
    constexpr size_t kPiece = 16 << 20;
    auto* const from = reinterpret_cast<std::byte*>(array.data());
    const size_t bytes = array.size() * sizeof(T);
    for (size_t at = 0; at < bytes; at += kPiece) {
      const size_t length = std::min(kPiece, bytes - at);
      std::memcpy(to + at, from + at, length);
      if (bytes > kPiece) release_pages(from + at, length);
    }
    array = GrowingArray<T>();  // {} would keep the room
  });
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
  scene.tracing = make_tracing_state(scene);
  return scene;
}

}  // namespace rayfarm
