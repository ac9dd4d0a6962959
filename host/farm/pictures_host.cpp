#include "host/farm/pictures_host.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "common/lighting/render_pass.h"
#include "host/farm/preview.h"
#include "protocol/block_codec.h"

namespace rayfarm {

namespace {

size_t area_of(const DisplayPolygon& p) {
  return static_cast<size_t>(p.right - p.left + 1) * static_cast<size_t>(p.bottom - p.top + 1);
}

}  // namespace

PicturesHost::PicturesHost(Transport& transport, const FarmHostOptions& options, JobResult& result,
                           const Tell& tell, Assignment& assignment)
    : transport_(transport),
      options_(options),
      result_(result),
      tell_(tell),
      assignment_(assignment),
      phase_(PicturesPhase{{}, options.plan.pictures.grid, {}}),
      journal_(options.journals.every_s),
      frames_(options.plan.pictures.frames.size()),
      pixels_of_node_(static_cast<size_t>(options.plan.processors) + 1),
      step_of_node_(pixels_of_node_.size()) {
  const PicturesPhase& all = options.plan.pictures;
  for (FrameIndex i; i.place() < all.frames.size(); ++i) {
    FrameResult frame;
    frame.frame = all.frames[i.place()];
    index_of_frame_[frame.frame] = i;
    frame.file = options.files[i.place()];
    result_.frames.push_back(frame);
  }
}

void PicturesHost::begin(const FrameGroup& group) {
  phase_ = phase_of(options_.plan,
                    {0, PhaseKind::pictures, group.first.value(), static_cast<uint64_t>(group.count), 1, 0});
  is_at_work_ = true;
  std::fill(step_of_node_.begin(), step_of_node_.end(), std::nullopt);
  resumed_.clear();
  for (const auto& [frame, head] : options_.journals.found)
    if (frame >= group.first && frame.value() < group.first.value() + group.count) resume(frame, head);
}

void PicturesHost::resume(FrameIndex frame, const JournalHead& head) {
  const std::string path = journal_of(options_.files[frame.place()]);
  begin_frame(frame);
  const uint64_t end = read_journal(path, head, [&](std::span<const std::byte> record) {
    try {
      BlockResult block = decode_block(record);
      check(block.report);
      const std::optional<ItemIndex> item = item_of(block.report, block.pass);
      if (!item || of_job(pictures().step_of(*item)) != frame || resumed_.contains(*item)) return;
      const Bytes unpacked = block.is_compressed ? pixels_of(block) : Bytes();
      if (block.is_compressed) block.pixels = unpacked;
      check_size(block);
      store(block);
      resumed_.insert(*item);
      show(NodeId(), block);
    } catch (const ProtocolError&) {  // whole, but no result of this frame: it is traced again
    }
  });
  result_.pixels_resumed += static_cast<uint64_t>(frames_[frame.place()].pixels_there);
  result_.frames[frame.place()].is_resumed = frames_[frame.place()].pixels_there > 0;
  journal_.go_on(path, end);
}

PhaseWork PicturesHost::work() const {
  PhaseWork work;
  work.steps = pictures().steps();
  work.items_per_step = pictures().items_per_step();
  const bool has_passes = pictures().passes > 1;
  // A pass goes on from the whole of the one before.
  work.window_steps = has_passes ? 1 : options_.window_frames;
  if (!resumed_.empty() || has_passes)
    work.is_done = [this](ItemIndex item) {
      // Of a frame that failed in an earlier pass there is nothing to go on from.
      return resumed_.contains(item) ||
             !result_.frames[of_job(pictures().step_of(item)).place()].problem.empty();
    };
  if (options_.plan.policy == AssignmentPolicy::interleaved)
    work.owner_of = [this](ItemIndex item) { return owner_of(options_.plan, pictures(), item); };
  return work;
}

void PicturesHost::assign(const AssignItem& assign) {
  const StepIndex step = pictures().step_of(assign.item);
  std::optional<StepIndex>& selected = step_of_node_[assign.node.place()];
  if (selected != step) transport_.send(assign.node, SelectStep{step});
  selected = step;
  if (pictures().pass_of(step) > 0)
    transport_.send(
        assign.node,
        GoOnFrom{frames_[of_job(step).place()].running[pictures().subpolygon_of(assign.item).place()]});
  transport_.send(assign.node, Channel::command,
                  encode_display_polygon(processor_of(assign.node), pictures().polygon_of(assign.item)));
}

std::string PicturesHost::name_of(ItemIndex item) const {
  return fmt::format("subpolygon {} of frame {}{}", pictures().subpolygon_of(item).value(),
                     pictures().number_of(item).value(),
                     pictures().passes > 1
                         ? fmt::format(" in pass {}", pictures().pass_of(pictures().step_of(item)) + 1)
                         : "");
}

void PicturesHost::write_pass(StepIndex step) {
  const FrameIndex frame = of_job(step);
  FrameBuffer& buffer = frames_[frame.place()];
  // A disk slower than the nodes gets the picture of a later pass in place of this one.
  if (std::exchange(buffer.is_pass_in_writing, true)) return;
  const int pass = pictures().pass_of(step), passes = pictures().passes;
  FrameWriter::Job job{frame, options_.files[frame.place()], options_.image, options_.attributes, false};
  job.attributes["rayfarm/frame"] = fmt::format("{}", result_.frames[frame.place()].frame.value());
  job.attributes["rayfarm/pass"] = fmt::format("{} of {}", pass + 1, passes);
  const RenderPass of_samples{static_cast<uint32_t>(pass), static_cast<uint32_t>(passes), {}};
  job.attributes["rayfarm/samples"] = fmt::format("{}", of_samples.end(options_.passes.samples));
  const PictureInWriting picture = writer_.begin(std::move(job));
  writer_.write(picture, std::make_shared<std::vector<std::byte>>(buffer.pixels));
  writer_.end(picture);
}

void PicturesHost::complete(StepIndex step, double now) {
  const FrameIndex frame = of_job(step);
  const size_t i = frame.place();
  if (!result_.frames[i].problem.empty()) {  // failed in an earlier pass
    assignment_.release(step, now);
    return;
  }
  if (!is_last_pass(step)) {
    write_pass(step);
    assignment_.release(step, now);
    return;
  }
  frames_[i].running = {};
  FrameWriter::Job job{frame, options_.files[i], options_.image, options_.attributes};
  job.attributes["rayfarm/frame"] = fmt::format("{}", result_.frames[i].frame.value());
  job.attributes["rayfarm/rays"] = fmt::format("{}", result_.frames[i].rays.total());
  const PictureInWriting picture = writer_.begin(std::move(job));
  writer_.write(picture, std::make_shared<std::vector<std::byte>>(std::move(frames_[i].pixels)));
  writer_.end(picture);
}

void PicturesHost::fail(const StepFailed& failed, double now) {
  const size_t i = of_job(failed.step).place();
  FrameResult& frame = result_.frames[i];
  frames_[i].pixels = {};
  frames_[i].running = {};
  frame.problem = fmt::format("a subpolygon failed three times: {}", failed.problem);
  tell_(fmt::format("frame {} failed: {}", frame.frame.value(), frame.problem));
  assignment_.release(failed.step, now);
}

void PicturesHost::forget(NodeId node) {
  pixels_of_node_[node.place()] = {};
  step_of_node_[node.place()].reset();
}

void PicturesHost::check(const SubpolygonReport& report) const {
  if (!index_of_frame_.contains(report.frame)) throw ProtocolError("a frame that was not asked for");
  if (report.subpolygon < SubpolygonId() || report.subpolygon.value() >= pictures().items_per_step())
    throw ProtocolError("a subpolygon that does not exist");
}

std::optional<ItemIndex> PicturesHost::item_of(const SubpolygonReport& report, int pass) const {
  const int frame = index_of_frame_.at(report.frame).value() - pictures().first.value();
  if (frame < 0 || static_cast<size_t>(frame) >= pictures().frames.size() || pass >= pictures().passes)
    return std::nullopt;
  return pictures().item_of(pictures().step_of(FrameIndex(frame), pass), report.subpolygon);
}

Bytes PicturesHost::pixels_of(const BlockResult& block) const {
  const DisplayPolygon p = pictures().grid.polygon(block.report.subpolygon);
  return decompress_rgb8(block.pixels, p.right - p.left + 1, p.bottom - p.top + 1);
}

void PicturesHost::receive_block(NodeId node, std::span<const std::byte> bytes, double now) {
  BlockResult block = decode_block(bytes);
  check(block.report);
  const size_t pixel_bytes = block.pixels.size();
  const Bytes unpacked = block.is_compressed ? pixels_of(block) : Bytes();
  if (block.is_compressed) block.pixels = unpacked;
  if (keep_result(node, block, pixel_bytes, now))
    journal_.append(journal_of(file_of(block.report.frame)), bytes);
}

void PicturesHost::receive_pixels(NodeId node, std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  auto& pixels = pixels_of_node_[node.place()];
  if (pixels.size() > static_cast<size_t>(options_.image.window.area()))
    throw ProtocolError("more pixels than the image has");
  while (!reader.at_end()) pixels.push_back(read_pixel(reader));
}

void PicturesHost::end_of_pixels(NodeId node, const SubpolygonReport& report, double now) {
  const auto pixels = std::exchange(pixels_of_node_[node.place()], {});
  check(report);
  const DisplayPolygon p = pictures().grid.polygon(report.subpolygon);
  const auto width = static_cast<size_t>(p.right - p.left + 1),
             height = static_cast<size_t>(p.bottom - p.top + 1);
  if (pixels.size() != width * height) throw ProtocolError("a subpolygon with pixels missing");
  std::vector<std::byte> block(3 * pixels.size());
  std::vector<bool> seen(pixels.size());
  for (const PixelResult& pixel : pixels) {
    if (pixel.x < p.left || pixel.x > p.right || pixel.y < p.top || pixel.y > p.bottom)
      throw ProtocolError("a pixel outside of its subpolygon");
    const size_t i = static_cast<size_t>(pixel.y - p.top) * width + static_cast<size_t>(pixel.x - p.left);
    if (seen[i]) throw ProtocolError("a pixel that came twice");
    seen[i] = true;
    for (size_t c = 0; c < 3; ++c) block[3 * i + c] = static_cast<std::byte>(pixel.rgb[c]);
  }
  if (keep_result(node, {report, false, block}, kPixelBytes * pixels.size(), now) && journal_.keeps_any())
    journal_.append(journal_of(file_of(report.frame)),
                    encode_block(processor_of(node), {report, false, block}));
}

void PicturesHost::check_size(const BlockResult& result) const {
  const size_t area = area_of(pictures().grid.polygon(result.report.subpolygon));
  const int passes = pictures().passes;
  if (result.pixels.size() != area * options_.image.layout.bytes)
    throw ProtocolError("a block of another size than its subpolygon");
  if (result.pass >= passes) throw ProtocolError("a pass that was not asked for");
  if (result.running.size() != (result.pass + 1 < passes ? area * options_.passes.running_bytes : 0))
    throw ProtocolError("a block with more or less to go on from than its pass");
}

bool PicturesHost::keep_result(NodeId node, const BlockResult& result, size_t bytes, double now) {
  const SubpolygonReport& report = result.report;
  check(report);
  check_size(result);
  NodeResult& node_result = result_.node(node);
  ++node_result.subpolygons;
  node_result.rays += RayCounts{report.rays, report.ray_tallies}.total();
  node_result.busy_s += static_cast<double>(report.busy_us) * 1e-6;
  result_.pixels_received += area_of(pictures().grid.polygon(report.subpolygon));
  const std::optional<ItemIndex> item = is_at_work_ ? item_of(report, result.pass) : std::nullopt;
  if (!item || !assignment_.accept(node, *item, now)) {
    ++result_.duplicates;
    return false;
  }
  const FrameIndex frame = index_of_frame_.at(report.frame);
  if (frames_[frame.place()].is_there.empty()) {
    begin_frame(frame);
    JournalLines lines = options_.journals.lines;
    lines.emplace_back("frame", fmt::format("{}", report.frame.value()));
    const SubpolygonGrid& grid = pictures().grid;
    lines.emplace_back("columns", fmt::format("{}", grid.columns));
    lines.emplace_back("rows", fmt::format("{}", grid.rows));
    if (grid.small_height > 0) {
      lines.emplace_back("small_height", fmt::format("{}", grid.small_height));
      lines.emplace_back("small_columns", fmt::format("{}", grid.small_columns));
      lines.emplace_back("small_rows", fmt::format("{}", grid.small_rows));
    }
    journal_.begin(journal_of(file_of(report.frame)), std::move(lines));
  }
  store(result);
  result_.rays += RayCounts{report.rays, report.ray_tallies};
  show(node, result);
  FrameResult& frame_result = result_.frames[frame.place()];
  const auto subpolygons = static_cast<size_t>(pictures().items_per_step());
  if (options_.keeps_traced_by) {
    frame_result.traced_by.resize(subpolygons);
    frame_result.traced_by[report.subpolygon.place()] = node;
  }
  if (options_.keeps_costs) {
    frame_result.costs.resize(subpolygons);
    frame_result.costs[report.subpolygon.place()] = {static_cast<double>(report.busy_us) * 1e-6, bytes};
  }
  return true;
}

void PicturesHost::begin_frame(FrameIndex frame) {
  FrameBuffer& buffer = frames_[frame.place()];
  buffer.pixels.resize(static_cast<size_t>(options_.image.window.area()) * options_.image.layout.bytes);
  buffer.is_there.resize(static_cast<size_t>(pictures().items_per_step()));
  if (pictures().passes > 1) buffer.running.resize(buffer.is_there.size());
}

void PicturesHost::store(const BlockResult& result) {
  const SubpolygonReport& report = result.report;
  const DisplayPolygon p = pictures().grid.polygon(report.subpolygon);
  const PixelRect& window = options_.image.window;
  const size_t pixel_bytes = options_.image.layout.bytes;
  FrameBuffer& frame = frames_[index_of_frame_.at(report.frame).place()];
  const size_t row_bytes = static_cast<size_t>(window.width()) * pixel_bytes;
  const size_t own_row_bytes = static_cast<size_t>(p.right - p.left + 1) * pixel_bytes;
  for (int y = p.top; y <= p.bottom; ++y)
    std::memcpy(frame.pixels.data() + static_cast<size_t>(y - window.y0) * row_bytes +
                    static_cast<size_t>(p.left - window.x0) * pixel_bytes,
                result.pixels.data() + static_cast<size_t>(y - p.top) * own_row_bytes, own_row_bytes);
  frame.is_there[report.subpolygon.place()] = true;
  if (!frame.running.empty())
    frame.running[report.subpolygon.place()].assign(result.running.begin(), result.running.end());
  frame.pixels_there += static_cast<int64_t>(area_of(p));
  const RayCounts rays{report.rays, report.ray_tallies};
  FrameResult& frame_result = result_.frames[index_of_frame_.at(report.frame).place()];
  frame_result.sees_anything |= report.sees_anything;
  if (result.pass + 1 == pictures().passes) frame_result.not_finite += report.not_finite;
  frame_result.rays += rays;
  result_.pixels_kept += area_of(p);
}

void PicturesHost::show(NodeId node, const BlockResult& result) const {
  const SubpolygonReport& report = result.report;
  for (Watcher* const watcher : options_.watchers)
    watcher->see({index_of_frame_.at(report.frame), report.frame, node,
                  pictures().grid.polygon(report.subpolygon), result.pixels});
}

void PicturesHost::tell_what_is_odd(const FrameResult& frame) const {
  if (frame.not_finite > 0)
    tell_(
        fmt::format("frame {}: {} pixels are infinite or not a number; the scene asks for light beyond all "
                    "bounds",
                    frame.frame.value(), frame.not_finite));
  if (!frame.is_black && frame.sees_anything) return;
  const Image& image = options_.image;
  if (!frame.sees_anything && image.window != PixelRect{0, 0, image.width_px, image.height_px})
    tell_(fmt::format("frame {}: no object is seen in the part that --crop asks for", frame.frame.value()));
  else if (!frame.sees_anything)
    tell_(
        fmt::format("frame {}: the camera sees nothing of the scene; check the view's location and "
                    "direction (rayfarm info prints the scene's bounds)",
                    frame.frame.value()));
  else
    tell_(
        fmt::format("frame {}: every pixel is black: no light reaches what the camera sees; rayfarm check "
                    "names lights that can't shine",
                    frame.frame.value()));
}

void PicturesHost::take_written(double now) {
  while (writer_.try_take_band()) {  // whole pictures, which are let go of with their ends
  }
  while (const auto written = writer_.try_take()) {
    FrameResult& frame = result_.frames[written->frame.place()];
    if (!written->is_last_pass) {
      frames_[written->frame.place()].is_pass_in_writing = false;
      result_.times.write_s += written->seconds;
      if (!written->problem.empty())
        tell_(fmt::format("frame {}: a pass's picture could not be written: {}", frame.frame.value(),
                          written->problem));
      continue;
    }
    frame.problem = written->problem;
    frame.sha256 = written->sha256;
    frame.is_written = written->problem.empty();
    if (frame.is_written) journal_.remove(journal_of(frame.file));
    frame.is_black = written->is_black;
    result_.times.write_s += written->seconds;
    if (!written->problem.empty())
      tell_(fmt::format("frame {} failed: {}", frame.frame.value(), written->problem));
    tell_what_is_odd(frame);
    // None of an earlier phase is left: that was over when all were written.
    const FrameIndex of_phase(written->frame.value() - pictures().first.value());
    assignment_.release(pictures().step_of(of_phase, pictures().passes - 1), now);
  }
  for (const std::string& problem : journal_.take_problems()) tell_(problem);
}

void PicturesHost::finish(double now, bool with_previews) {
  writer_.finish();
  take_written(now);
  journal_.sync();
  for (const std::string& problem : journal_.take_problems()) tell_(problem);
  tell_of_unfinished(with_previews);
}

void PicturesHost::tell_of_unfinished(bool with_previews) {
  for (FrameIndex i; i.place() < frames_.size(); ++i) {
    const FrameBuffer& frame = frames_[i.place()];
    const FrameResult& of = result_.frames[i.place()];
    if (frame.is_there.empty() || of.is_written) continue;
    UnfinishedFrame unfinished{of.frame,
                               static_cast<double>(frame.pixels_there) /
                                   static_cast<double>(options_.image.window.area() * pictures().passes),
                               journal_.keeps_any() ? journal_of(of.file) : "",
                               {}};
    if (with_previews && !frame.pixels.empty()) {
      const std::string path = preview_of(of.file);
      try {
        write_preview(path, options_.image, frame.pixels, pictures().grid, frame.is_there);
        unfinished.preview = path;
      } catch (const std::exception& e) {
        tell_(fmt::format("there is no preview of frame {}: {}", of.frame.value(), e.what()));
      }
    }
    result_.unfinished.push_back(std::move(unfinished));
  }
}

}  // namespace rayfarm
