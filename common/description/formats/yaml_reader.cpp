#include "common/description/formats/yaml_reader.h"

#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include "common/image/pixel_format.h"

namespace rayfarm {
namespace {

/// The colour that pages of the web write as #rrggbb.
std::optional<Color> color_of_code(const std::string& text) {
  uint32_t bits = 0;
  if (text.size() != 7 || text.front() != '#') return std::nullopt;
  const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), bits, 16);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  const auto channel = [bits](int shift) { return decode_srgb8(static_cast<uint8_t>(bits >> shift & 0xff)); };
  return Color(channel(16), channel(8), channel(0));
}

}  // namespace

YamlValue::YamlValue(const YAML::Node& node, std::string what, const std::string& file, YamlBudget& budget)
    : node_(node),
      place_(budget.outline ? budget.outline->place_in_text(place_in_document()) : place_in_document()),
      what_(std::move(what)),
      file_(&file),
      budget_(&budget) {
  if (budget.nodes_left == 0) fail("the document expands to too many values (do its anchors multiply?)");
  --budget.nodes_left;
  throw_if_stopped(budget.stop);
}

void YamlValue::fail(const std::string& problem) const {
  const Place p = place();
  throw InputError({*file_, p.line, p.column}, problem);
}

Place YamlValue::place() const {
  return {budget_->file, place_.line + 1, place_.column + 1};
}

double YamlValue::number() const {
  if (!node_.IsScalar()) fail(fmt::format("{} must be a number", what_));
  const std::string& s = node_.Scalar();
  const char* begin = s.data() + (!s.empty() && s.front() == '+' ? 1 : 0);
  double value = 0;
  const auto [end, error] = std::from_chars(begin, s.data() + s.size(), value);
  if (error != std::errc{} || end != s.data() + s.size())
    fail(fmt::format("{} must be a number, not '{}'", what_, s.substr(0, 40)));
  if (!std::isfinite(value)) fail(fmt::format("{} must be finite, not '{}'", what_, s.substr(0, 40)));
  if (std::abs(value) > limits::kCoordinate)
    fail(fmt::format("{} is larger than {:g}", what_, limits::kCoordinate));
  return value;
}

double YamlValue::number_in(double least, double most) const {
  const double value = number();
  if (!(value >= least && value <= most))
    fail(fmt::format("{} must be from {:g} to {:g}, not {:g}", what_, least, most, value));
  return value;
}

int YamlValue::whole_number_in(int least, int most) const {
  const double value = number_in(least, most);
  if (value != std::floor(value)) fail(fmt::format("{} must be a whole number, not {:g}", what_, value));
  return static_cast<int>(value);
}

std::string YamlValue::text() const {
  if (!node_.IsScalar() || node_.Scalar().empty()) fail(fmt::format("{} must be a word or a text", what_));
  return node_.Scalar();
}

bool YamlValue::boolean() const {
  return choice({"false", "true"}) == 1;
}

std::vector<double> YamlValue::numbers() const {
  std::vector<double> result;
  for (const YamlValue& item : items()) result.push_back(item.number());
  return result;
}

Vec3 YamlValue::vector() const {
  if (!node_.IsSequence() || node_.size() != 3)
    fail(fmt::format("{} must be three numbers: [x, y, z]", what_));
  const std::vector<double> v = numbers();
  return {v[0], v[1], v[2]};
}

Vec3 YamlValue::direction() const {
  const Vec3 v = vector();
  if (max_magnitude(v) == 0) fail(fmt::format("{} must not be the zero vector", what_));
  return v;
}

Color YamlValue::color() const {
  const auto fail_as_no_color = [this](const std::string& found) {
    fail(fmt::format(
        "{} must be [red, green, blue] in linear light, one number for grey, or '#rrggbb' in sRGB{}", what_,
        found));
  };
  Color c;
  if (node_.IsSequence() && node_.size() == 3) {
    c = vector();
  } else if (node_.IsNull()) {
    fail_as_no_color("; nothing stands here (what follows a # is a comment: put '#rrggbb' in quotes)");
  } else if (node_.IsMap()) {
    fail_as_no_color("; a spectrum can stand in materials, lights, media, `background` and `ambient`");
  } else if (!node_.IsScalar()) {
    fail_as_no_color("");
  } else if (const auto coded = color_of_code(node_.Scalar())) {
    c = *coded;
  } else if (node_.Scalar().find_first_of("0123456789") == std::string::npos) {
    fail_as_no_color(fmt::format(", not '{}'", node_.Scalar().substr(0, 40)));
  } else {
    c = Color(number());
  }
  if (c.x < 0 || c.y < 0 || c.z < 0) fail(fmt::format("{} must not be negative", what_));
  return c;
}

size_t YamlValue::choice(const std::vector<std::string>& choices) const {
  const std::string word = text();
  for (size_t i = 0; i < choices.size(); ++i)
    if (choices[i] == word) return i;
  fail_unknown(what_, choices);
}

void YamlValue::fail_unknown(const std::string& kind, const std::vector<std::string>& names,
                             const std::string& otherwise) const {
  constexpr size_t kMostNames = 24;
  const std::string word = text();
  const std::vector<std::string> shown(
      names.begin(), names.begin() + static_cast<ptrdiff_t>(std::min(names.size(), kMostNames)));
  fail(
      fmt::format("unknown {} '{}' (known: {}{}){}{}", kind, word.substr(0, 40),
                  names.empty() ? "none, as none is defined here" : fmt::format("{}", fmt::join(shown, ", ")),
                  names.size() > kMostNames ? ", …" : "", suggestion(word, names), otherwise));
}

std::vector<YamlValue> YamlValue::items() const {
  if (!node_.IsSequence()) fail(fmt::format("{} must be a list", what_));
  if (list_apart()) fail(fmt::format("{} must not be a list of numbers", what_));
  std::vector<YamlValue> result;
  result.reserve(node_.size());
  for (const YAML::Node& item : node_) result.emplace_back(item, what_, *file_, *budget_);
  return result;
}

std::optional<NumberList> YamlValue::items_apart() const {
  constexpr size_t kLongList = 20'000;
  std::optional<NumberList> list = list_apart();
  if (!list && node_.IsSequence() && node_.size() >= kLongList && !budget_->slow_list)
    budget_->slow_list = {place(), node_.size()};
  return list;
}

std::optional<NumberList> YamlValue::list_apart() const {
  if (!budget_->outline) return std::nullopt;
  const auto inside = budget_->outline->read_list(place_in_document());
  if (!inside || !node_.IsSequence()) return std::nullopt;
  return NumberList(*inside, budget_->stop, budget_->progress);
}

void YamlValue::take_all(const NumberList& list, const NumberList::Take& take) const {
  const size_t values = list.for_each(take);
  if (values > budget_->nodes_left) fail("the document holds too many values");
  budget_->nodes_left -= values;
}

std::vector<std::pair<YamlValue, YamlValue>> YamlValue::entries() const {
  if (!node_.IsMap()) fail(fmt::format("{} must be a map of `key: value`", what_));
  std::vector<std::pair<YamlValue, YamlValue>> result;
  result.reserve(node_.size());
  for (const auto& entry : node_) {
    YamlValue key(entry.first, "a key", *file_, *budget_);
    if (!entry.first.IsScalar()) key.fail("a key must be a word");
    result.emplace_back(key, YamlValue(entry.second, entry.first.Scalar(), *file_, *budget_));
    // Nothing stands nowhere: the library gives it the place of what comes next.
    if (entry.second.IsNull()) result.back().second.place_ = key.place_;
  }
  return result;
}

YamlMap::YamlMap(const YamlValue& value) : value_(value), entries_(value.entries()) {
  std::set<std::string> seen;
  for (const auto& [key, v] : entries_) {
    names_.push_back(key.text());
    if (!seen.insert(names_.back()).second)
      key.fail(
          fmt::format("key '{}' stands twice in {}; remove one", names_.back().substr(0, 40), value.what()));
  }
}

bool YamlMap::has(const std::string& key) {
  return find(key).has_value();
}

std::optional<YamlValue> YamlMap::find(const std::string& key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
  for (size_t i = 0; i < names_.size(); ++i)
    if (names_[i] == key) return entries_[i].second;
  return std::nullopt;
}

void YamlMap::know(std::initializer_list<const char*> keys) {
  known_.insert(known_.end(), keys.begin(), keys.end());
}

YamlValue YamlMap::require(const std::string& key) {
  if (auto v = find(key)) return *v;
  // A near miss is more likely a typing error than a forgotten key.
  for (size_t i = 0; i < names_.size(); ++i)
    if (!suggestion(names_[i], {key}).empty())
      entries_[i].first.fail(
          fmt::format("unknown key '{}' in {}; did you mean '{}'?", names_[i], value_.what(), key));
  value_.fail(fmt::format("{} needs the key '{}'", value_.what(), key));
}

void YamlMap::refuse(const std::string& key, const std::string& advice) const {
  for (size_t i = 0; i < names_.size(); ++i)
    if (names_[i] == key)
      entries_[i].first.fail(fmt::format("unknown key '{}' in {}: {}", key, value_.what(), advice));
}

void YamlMap::finish() const {
  for (size_t i = 0; i < names_.size(); ++i) {
    if (std::find(known_.begin(), known_.end(), names_[i]) != known_.end()) continue;
    std::string list;
    for (const std::string& k : known_) list += (list.empty() ? "" : ", ") + k;
    entries_[i].first.fail(fmt::format("unknown key '{}' in {} (known: {}){}", names_[i].substr(0, 40),
                                       value_.what(), list, suggestion(names_[i], known_)));
  }
}

}  // namespace rayfarm
