#include "common/description/formats/gltf/animation.h"

#include <fmt/core.h>

#include "common/description/formats/gltf/accessor.h"

namespace rayfarm {
namespace {

constexpr double kLeastScale = 1e-6;
constexpr double kMostFrame = 9'999'999;

/// Which clip the options ask for; none if the file has none of that name, as another may have it.
std::optional<size_t> clip_index(const GltfFile& file, SceneDescription& scene) {
  const std::string& wanted = file.options().clip;
  const size_t count = file.count("animations");
  if (wanted.empty()) return count > 0 ? std::optional<size_t>(0) : std::nullopt;
  std::vector<std::string> names;
  for (size_t i = 0; i < count; ++i) names.push_back(file.item("animations", i).text("name", ""));
  try {
    const size_t index = file.find_choice("clip", wanted, names);
    scene.clip.is_found = true;
    return index;
  } catch (const InputError& e) {
    scene.clip.missing.emplace_back(e.what());
    if (count > 0)
      scene.notes.add({file.path()},
                      fmt::format("it has no clip '{}', and stands as it does without one", wanted));
    return std::nullopt;
  }
}

/// The time of a clip's last key, by what accessors say of themselves, as clips that are not played need not
/// be read. None if one says nothing, or the clip is damaged.
std::optional<double> last_time_s(const GltfFile& file, const GltfValue& clip) try {
  double last = 0;
  const GltfValue samplers = clip.at("samplers");
  for (size_t i = 0; i < samplers.size(); ++i) {
    throw_if_stopped(file.options().stop);
    const uint32_t input = samplers[i].index("input", file.count("accessors"));
    if (input == kNone) return std::nullopt;
    last = std::max(last, file.item("accessors", input).at("max").numbers(1)[0]);
  }
  return last;
} catch (const InputError&) {
  return std::nullopt;
}

/// Lists the file's clips, of which `played` is.
void list_clips(const GltfFile& file, std::optional<size_t> played, double played_s,
                SceneDescription& scene) {
  const auto is_of_file = [&](const ClipDescription& clip) { return clip.file == file.path(); };
  if (std::any_of(scene.clips.begin(), scene.clips.end(), is_of_file)) return;  // it is used twice
  for (size_t i = 0; i < file.count("animations"); ++i) {
    const GltfValue clip = file.item("animations", i);
    const bool is_played = i == played;
    scene.clips.push_back({file.path(), i, clip.text("name", ""),
                           is_played ? std::optional(played_s) : last_time_s(file, clip), is_played});
  }
}

}  // namespace

int last_frame_of(double frame) {
  return static_cast<int>(std::clamp(std::ceil(frame - 1e-3), 0.0, kMostFrame));
}

Vec4 nonzero_scale(Vec4 s) {
  for (int c = 0; c < 3; ++c)
    if (std::abs(s[c]) < kLeastScale) s[c] = std::copysign(kLeastScale, s[c]);
  return s;
}

Vec4 unit_quaternion(const Vec4& q) {
  const double length = std::sqrt(glm::dot(q, q));
  return length > 0 ? q / length : Vec4(0, 0, 0, 1);
}

GltfAnimation::GltfAnimation(const GltfFile& file, SceneDescription& scene) : file_(file) {
  const std::optional<size_t> clip = clip_index(file, scene);
  if (clip) {
    read(file.item("animations", *clip), scene.notes);
    frames_ = {0, last_frame_of(last_frame_)};
  }
  list_clips(file, clip, last_frame_ / file.options().fps, scene);
}

const GltfMotion* GltfAnimation::find(uint32_t node) const {
  const auto found = motions_.find(node);
  return found == motions_.end() ? nullptr : &found->second;
}

void GltfAnimation::read(const GltfValue& clip, Notes& notes) {
  const GltfValue channels = clip.at("channels");
  for (size_t i = 0; i < channels.size(); ++i) {
    throw_if_stopped(file_.options().stop);
    read_channel(clip, channels[i], notes);
  }
}

std::vector<double> GltfAnimation::read_times(const GltfValue& sampler, std::vector<size_t>& kept,
                                              Notes& notes) {
  const uint32_t input = sampler.index("input", file_.count("accessors"));
  if (input == kNone) sampler.at("input");
  const GltfAccessor accessor(file_, input);
  accessor.expect_components({1});
  if (accessor.count() > limits::kKeys) sampler.at("input").fail("the clip has too many keys");
  std::vector<double> frames;
  bool is_doubled = false;
  const LargeVector<float> times = accessor.all<float>();
  for (size_t i = 0; i < times.size(); ++i) {
    const double frame = double{times[i]} * file_.options().fps;
    if (!std::isfinite(frame) || std::abs(frame) > kMostFrame)
      sampler.at("input").fail(fmt::format("its {}. time, {} s, is no time of a clip", i + 1, times[i]));
    if (!frames.empty() && frame < frames.back())
      sampler.at("input").fail(fmt::format("its times don't rise: the {}. is before the one before", i + 1));
    if (!frames.empty() && frame == frames.back()) {
      is_doubled = true;
      kept.back() = i;
      continue;
    }
    frames.push_back(frame);
    kept.push_back(i);
  }
  if (is_doubled)
    notes.add(sampler.place(),
              "of several keys at the same time the last is used, as a curve has one value there");
  last_frame_ = std::max(last_frame_, frames.back());
  return frames;
}

size_t GltfAnimation::morph_targets_of(uint32_t node) const {
  const uint32_t mesh = file_.item("nodes", node).index("mesh", file_.count("meshes"));
  return mesh == kNone ? 0 : file_.morph_targets(mesh);
}

void GltfAnimation::read_channel(const GltfValue& clip, const GltfValue& channel, Notes& notes) {
  const GltfValue samplers = clip.at("samplers"), target = channel.at("target");
  const uint32_t sampler_index = channel.index("sampler", samplers.size()),
                 node = target.index("node", file_.count("nodes"));
  if (sampler_index == kNone) channel.at("sampler");
  if (node == kNone) {
    notes.add(clip.place(), "a channel of the clip moves no node, and is left out");
    return;
  }
  const GltfValue sampler = samplers[sampler_index];
  const std::string path = target.at("path").text(), way = sampler.text("interpolation", "LINEAR");
  const bool is_cubic = way == "CUBICSPLINE", is_step = way == "STEP";
  if (!is_cubic && !is_step && way != "LINEAR")
    sampler.at("interpolation").fail("LINEAR, STEP or CUBICSPLINE was expected");
  const bool is_rotation = path == "rotation", is_scale = path == "scale", is_weights = path == "weights";
  if (!is_rotation && !is_scale && !is_weights && path != "translation") {
    notes.add(clip.place(),
              fmt::format("the clip changes '{}' of a node, which is not read", path.substr(0, 30)));
    return;
  }
  const size_t targets = is_weights ? morph_targets_of(node) : 1, parts = is_weights    ? 1
                                                                          : is_rotation ? 4
                                                                                        : 3;
  const GltfValue moved = file_.item("nodes", node);
  if (targets == 0) {
    notes.add(
        clip.place(),
        fmt::format("{}: the clip changes weights of its morph targets, but it has none; the channel is "
                    "left out",
                    moved.where()));
    return;
  }
  if (!is_weights && moved.has("matrix"))
    notes.add(clip.place(),
              fmt::format("{}: its `matrix` is not used, as the clip changes its {}: glTF allows such a node "
                          "translation, rotation and scale alone",
                          moved.where(), path));
  std::vector<size_t> kept;
  const std::vector<double> frames = read_times(sampler, kept, notes);
  const uint32_t output = sampler.index("output", file_.count("accessors"));
  if (output == kNone) sampler.at("output");
  const GltfAccessor accessor(file_, output);
  accessor.expect_components({parts});
  const size_t keys = GltfAccessor(file_, sampler.index("input", file_.count("accessors"))).count();
  const size_t per_key = is_cubic ? 3 : 1;
  if (accessor.count() != keys * per_key * targets)
    sampler.at("output").fail(fmt::format("{} values were expected for {} keys, not {}",
                                          keys * per_key * targets, keys, accessor.count()));
  file_.take_elements(sampler, accessor.count());  // many channels may name one sampler
  const LargeVector<float> values = accessor.all<float>();
  GltfMotion& motion = motions_[node];
  if (is_weights) motion.weights.clear();
  for (size_t t = 0; t < targets; ++t) {
    Curve curve;
    curve.interpolation = is_cubic && is_rotation ? Interpolation::cubic_rotation
                          : is_cubic              ? Interpolation::cubic
                          : is_step               ? Interpolation::step
                          : is_rotation           ? Interpolation::spherical_rotation
                                                  : Interpolation::linear;
    curve.frames = frames;
    for (const size_t key : kept)
      for (size_t k = 0; k < per_key; ++k) {
        Vec4 value(0);
        for (size_t c = 0; c < parts; ++c)
          value[static_cast<int>(c)] =
              static_cast<double>(values[((key * per_key + k) * targets + t) * parts + c]);
        if (!is_finite(Vec3(value)) || !std::isfinite(value.w))
          sampler.at("output").fail(fmt::format("the values of its {}. key are not all numbers", key + 1));
        if (max_magnitude(Vec3(value)) > limits::kCoordinate)
          sampler.at("output").fail(fmt::format("the values of its {}. key are too large", key + 1));
        if (is_cubic && k != 1)
          value /= file_.options().fps;  // slopes are per second
        else if (is_rotation)
          value = unit_quaternion(value);
        else if (is_scale)
          value = nonzero_scale(value);
        curve.values.push_back(value);
      }
    if (is_weights)
      motion.weights.push_back(std::move(curve));
    else
      (is_rotation ? motion.rotation : is_scale ? motion.scale : motion.translation) = std::move(curve);
  }
}

std::vector<TransformStep> GltfAnimation::transform_of(uint32_t node) const {
  const GltfValue value = file_.item("nodes", node);
  const GltfMotion* const motion = find(node);
  std::vector<TransformStep> steps;
  const bool is_moved = motion && (motion->translation || motion->rotation || motion->scale);
  if (const auto matrix = value.find("matrix"); matrix && !is_moved) {
    const std::vector<double> m = matrix->numbers(16);
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
      matrix->fail("its last row must be 0, 0, 0, 1: nodes are moved without perspective");
    TransformStep step{TransformKind::matrix, constant_curve(Vec4(0)), {}, {}};
    for (int column = 0; column < 3; ++column)
      for (int row = 0; row < 3; ++row)
        step.matrix.linear[column][row] = m[static_cast<size_t>(4 * column + row)];
    step.matrix.translation = {m[12], m[13], m[14]};
    if (std::any_of(m.begin(), m.end(), [](double v) { return !(std::abs(v) <= limits::kCoordinate); }))
      matrix->fail("its numbers are too large");
    if (const double size = glm::determinant(step.matrix.linear); size == 0 || !std::isfinite(size))
      step.matrix.linear += Mat3(kLeastScale);  // it flattens what is there
    if (!step.matrix.is_identity()) steps.push_back(std::move(step));
    return steps;
  }
  const auto add = [&](TransformKind kind, const char* key, const std::optional<Curve>* curve,
                       const Vec4& usual) {
    if (curve && *curve) {
      steps.push_back({kind, **curve, {}, {}});
      return;
    }
    const auto v = value.find(key);
    if (!v) return;
    Vec4 constant(0);
    if (kind == TransformKind::orient) {
      const std::vector<double> q = v->numbers(4);
      constant = unit_quaternion({q[0], q[1], q[2], q[3]});
    } else {
      constant = {v->vector3(), 0};
      if (max_magnitude(Vec3(constant)) > limits::kCoordinate) v->fail("its numbers are too large");
    }
    if (kind == TransformKind::scale) constant = nonzero_scale(constant);
    if (constant != usual) steps.push_back({kind, constant_curve(constant), {}, {}});
  };
  add(TransformKind::scale, "scale", motion ? &motion->scale : nullptr, Vec4(1, 1, 1, 0));
  add(TransformKind::orient, "rotation", motion ? &motion->rotation : nullptr, Vec4(0, 0, 0, 1));
  add(TransformKind::translate, "translation", motion ? &motion->translation : nullptr, Vec4(0));
  return steps;
}

std::vector<Curve> GltfAnimation::weights_of(uint32_t node, size_t count) const {
  if (const GltfMotion* const motion = find(node); motion && motion->weights.size() == count)
    return motion->weights;
  const GltfValue value = file_.item("nodes", node);
  std::optional<GltfValue> own = value.find("weights");
  if (const uint32_t mesh = value.index("mesh", file_.count("meshes")); !own && mesh != kNone)
    own = file_.item("meshes", mesh).find("weights");
  std::vector<Curve> weights(count, constant_curve(Vec4(0)));
  if (!own) return weights;
  const std::vector<double> numbers = own->numbers(count);
  for (size_t t = 0; t < count; ++t) weights[t] = constant_curve(Vec4(numbers[t], 0, 0, 0));
  return weights;
}

}  // namespace rayfarm
