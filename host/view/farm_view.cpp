#include "host/view/farm_view.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "common/image/colour_channels.h"
#include "host/view/state_json.h"

namespace rayfarm {
namespace {

/// Of the pictures that are kept; two are in any case.
constexpr size_t kMostPictureBytes = size_t{128} << 20;
constexpr size_t kMostPictures = 16;
/// Of an answer: what a page draws without a stop that is felt.
constexpr size_t kMostAnswerBytes = size_t{4} << 20;
/// Over which speeds are taken.
constexpr double kSpeed_s = 4;

void put(std::string& out, uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>(value >> (8 * i) & 0xff));
}

}  // namespace

FarmView::FarmView(std::string scene, std::string output)
    : scene_(std::move(scene)), output_(std::move(output)) {}

FarmView::~FarmView() {
  queue_.abandon();
  if (thread_.joinable()) thread_.join();
}

void FarmView::begin(const WatchedJob& job) {
  {
    const std::lock_guard lock(mutex_);
    job_ = job;
    const PixelRect& window = job.image.window;
    step_ = std::max(1, (std::max(window.width(), window.height()) + kLongestSide_px - 1) / kLongestSide_px);
    width_px_ = (window.width() + step_ - 1) / step_;
    height_px_ = (window.height() + step_ - 1) / step_;
  }
  channels_ = colour_channels(job_.image.layout);
  if (channels_[0].format == PixelFormat::half_float) {
    srgb8_of_half_.resize(1 << 16);
    for (unsigned bits = 0; bits < srgb8_of_half_.size(); ++bits) {
      const std::array half{static_cast<std::byte>(bits & 0xff), static_cast<std::byte>(bits >> 8)};
      srgb8_of_half_[bits] = encode_srgb8(decode_value({"", PixelFormat::half_float, 0}, half.data()));
    }
  }
  thread_ = std::thread([this] { run(); });
}

void FarmView::hear(FarmStatus status) {
  auto next = std::make_shared<const FarmStatus>(std::move(status));
  const std::lock_guard lock(status_mutex_);
  // One in half a second is enough to know the speed of the last few.
  if (speeds_.empty() || next->now_s - speeds_.back().now_s > 0.5) {
    Speed speed{next->now_s, static_cast<double>(next->rays), {}};
    for (const NodeStatus& node : next->nodes) speed.node_rays.push_back(node.rays);
    speeds_.push_back(std::move(speed));
    while (speeds_.size() > 2 && next->now_s - speeds_[1].now_s > kSpeed_s) speeds_.pop_front();
  }
  status_ = std::move(next);
}

void FarmView::end(const std::string& outcome) {
  queue_.close();
  if (thread_.joinable()) thread_.join();
  const std::lock_guard lock(status_mutex_);
  FarmStatus status = *status_;
  status.stage = FarmStage::ended;
  status.left_s.reset();
  status_ = std::make_shared<const FarmStatus>(std::move(status));
  outcome_ = outcome;
}

void FarmView::run() {
  while (const auto item = queue_.pop()) draw(item->subpolygon);
}

void FarmView::encode_pixel(const std::byte* pixel, uint8_t* rgb) const {
  for (size_t c = 0; c < 3; ++c) {
    const PixelChannel& channel = channels_[c];
    const std::byte* const in = pixel + channel.offset_bytes;
    switch (channel.format) {
      case PixelFormat::rgb8:
        rgb[c] = static_cast<uint8_t>(in[0]);
        break;
      case PixelFormat::half_float:
        rgb[c] = srgb8_of_half_[static_cast<unsigned>(in[0]) | static_cast<unsigned>(in[1]) << 8];
        break;
      case PixelFormat::float32:
        rgb[c] = encode_srgb8(decode_value(channel, pixel));
        break;
    }
  }
}

void FarmView::draw(const SeenSubpolygon& subpolygon) {
  const PixelRect& window = job_.image.window;
  const DisplayPolygon& p = subpolygon.polygon;
  const int left = p.left - window.x0, top = p.top - window.y0;
  const auto first = [this](int edge) { return (edge + step_ - 1) / step_; };
  const int x0 = first(left), x1 = (p.right - window.x0) / step_ + 1;
  const int y0 = first(top), y1 = (p.bottom - window.y0) / step_ + 1;
  const auto width = static_cast<size_t>(std::max(0, x1 - x0));
  const auto height = static_cast<size_t>(std::max(0, y1 - y0));
  std::vector<uint8_t> rgb(3 * width * height);
  const size_t pixel_bytes = job_.image.layout.bytes;
  const auto own_width = static_cast<size_t>(p.right - p.left + 1);
  uint8_t* out = rgb.data();
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x, out += 3)
      encode_pixel(
          subpolygon.pixels.data() + pixel_bytes * (static_cast<size_t>(y * step_ - top) * own_width +
                                                    static_cast<size_t>(x * step_ - left)),
          out);

  const std::lock_guard lock(mutex_);
  Canvas* const canvas = canvas_of(subpolygon);
  if (!canvas) return;
  canvas->pixels_there += own_width * static_cast<size_t>(p.bottom - p.top + 1);
  if (rgb.empty()) return;  // smaller than what is shown of it
  for (size_t row = 0; row < height; ++row)
    std::memcpy(canvas->rgb.data() + 3 * ((static_cast<size_t>(y0) + row) * static_cast<size_t>(width_px_) +
                                          static_cast<size_t>(x0)),
                rgb.data() + 3 * width * row, 3 * width);
  updates_.push_back({++sequence_, subpolygon.frame, static_cast<uint16_t>(subpolygon.node.value()),
                      static_cast<uint16_t>(x0), static_cast<uint16_t>(y0), static_cast<uint16_t>(width),
                      static_cast<uint16_t>(height)});
}

FarmView::Canvas* FarmView::canvas_of(const SeenSubpolygon& subpolygon) {
  if (subpolygon.frame < first_kept_) return nullptr;
  const auto found = std::find_if(canvases_.begin(), canvases_.end(),
                                  [&](const Canvas& c) { return c.frame >= subpolygon.frame; });
  if (found != canvases_.end() && found->frame == subpolygon.frame) return &*found;
  const size_t bytes = 3 * static_cast<size_t>(width_px_) * static_cast<size_t>(height_px_);
  canvases_.insert(found, Canvas{subpolygon.frame, subpolygon.number, 0, std::vector<uint8_t>(bytes)});
  while (canvases_.size() > 2 &&
         (canvases_.size() > kMostPictures || canvases_.size() * bytes > kMostPictureBytes)) {
    canvases_.pop_front();
    first_kept_ = canvases_.front().frame;
  }
  std::erase_if(updates_, [this](const Update& u) { return u.frame < first_kept_; });
  return const_cast<Canvas*>(find(subpolygon.frame));
}

const FarmView::Canvas* FarmView::find(FrameIndex frame) const {
  for (const Canvas& canvas : canvases_)
    if (canvas.frame == frame) return &canvas;
  return nullptr;
}

std::string FarmView::updates(uint64_t since) const {
  std::string records;
  uint32_t count = 0;
  const std::lock_guard lock(mutex_);
  uint64_t last = sequence_;
  auto update = std::upper_bound(updates_.begin(), updates_.end(), since,
                                 [](uint64_t s, const Update& u) { return s < u.sequence; });
  for (; update != updates_.end(); ++update) {
    if (records.size() > kMostAnswerBytes) {
      last = update->sequence - 1;
      break;
    }
    const Canvas& canvas = *find(update->frame);
    put(records, static_cast<uint32_t>(canvas.number.value()), 4);
    for (const uint16_t value : {update->node, update->x, update->y, update->width, update->height})
      put(records, value, 2);
    for (size_t y = update->y; y < size_t{update->y} + update->height; ++y)
      records.append(reinterpret_cast<const char*>(canvas.rgb.data()) +
                         3 * (y * static_cast<size_t>(width_px_) + update->x),
                     3 * size_t{update->width});
    ++count;
  }
  std::string answer;
  put(answer, last, 8);
  put(answer, static_cast<uint64_t>(width_px_), 2);
  put(answer, static_cast<uint64_t>(height_px_), 2);
  put(answer, count, 4);
  return answer + records;
}

std::string FarmView::state() const {
  StateOfJob state;
  state.scene = scene_;
  state.output = output_;
  state.dropped = queue_.dropped();
  {  // before the pictures: who hears of the end has heard of the last update, too
    const std::lock_guard lock(status_mutex_);
    state.status = status_;
    state.outcome = outcome_;
    if (!speeds_.empty() && status_->now_s > speeds_.front().now_s) {
      const Speed& then = speeds_.front();
      const double seconds = status_->now_s - then.now_s;
      state.rays_per_s = (static_cast<double>(status_->rays) - then.rays) / seconds;
      for (size_t i = 0; i < status_->nodes.size() && i < then.node_rays.size(); ++i)
        state.node_rays_per_s.push_back(static_cast<double>(status_->nodes[i].rays - then.node_rays[i]) /
                                        seconds);
    }
  }
  {
    const std::lock_guard lock(mutex_);
    state.updates = sequence_;
    state.image_px = {job_.image.width_px, job_.image.height_px};
    state.window = job_.image.window;
    state.shown_px = {width_px_, height_px_};
    state.frames_total = job_.files.size();
    for (const Canvas& canvas : canvases_)
      state.frames.push_back({canvas.number, static_cast<double>(canvas.pixels_there) /
                                                 static_cast<double>(job_.image.window.area())});
  }
  return to_json(state);
}

}  // namespace rayfarm
