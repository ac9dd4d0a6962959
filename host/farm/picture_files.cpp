#include "host/farm/picture_files.h"

#include <fmt/core.h>

#include <chrono>
#include <thread>
#include <utility>

#include "common/lighting/render_pass.h"
#include "host/farm/preview.h"
#include "host/process/interrupt.h"

namespace rayfarm {
namespace {

/// Known when a picture is whole, and not when its file begins.
constexpr const char* kRays = "rayfarm/rays";

double pixels_of_frame(const FarmHostOptions& o) {
  return static_cast<double>(o.image.window.area()) * o.plan.pictures.passes;
}

}  // namespace

PictureFiles::PictureFiles(const FarmHostOptions& options, JobResult& result, const Tell& tell)
    : options_(options), result_(result), tell_(tell), frames_(options.plan.pictures.frames.size()) {}

void PictureFiles::begin(FrameIndex frame) {
  Frame& f = frames_[frame.place()];
  if (f.buffer) return;
  const SubpolygonGrid& grid = options_.plan.pictures.grid;
  f.buffer = std::make_unique<FrameBuffer>(options_.image.window, options_.image.layout.bytes, grid,
                                           options_.frame_bytes);
  if (options_.plan.pictures.passes > 1) f.running.resize(static_cast<size_t>(grid.count()));
}

SubpolygonId PictureFiles::end_of_room(FrameIndex frame) const {
  return frames_[frame.place()].buffer->end_of_room();
}

bool PictureFiles::comes_to_have_room(FrameIndex frame, SubpolygonId subpolygon,
                                      const std::function<void()>& turn) {
  const Frame& f = frames_[frame.place()];
  while (subpolygon >= f.buffer->end_of_room() && f.bands_in_writing > 0 && interrupted_by() == 0) {
    turn();
    take_bands();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return subpolygon < f.buffer->end_of_room();
}

FrameWriter::Job PictureFiles::job_of(FrameIndex frame) const {
  FrameWriter::Job job;
  job.frame = frame;
  job.path = options_.files[frame.place()];
  job.image = options_.image;
  job.attributes = options_.attributes;
  job.attributes["rayfarm/frame"] = fmt::format("{}", result_.frames[frame.place()].frame.value());
  return job;
}

void PictureFiles::store(FrameIndex frame, const BlockResult& result) {
  Frame& f = frames_[frame.place()];
  const SubpolygonId subpolygon = result.report.subpolygon;
  const bool is_final = is_last_pass(result.pass);
  f.buffer->store(subpolygon, result.pixels, is_final);
  if (!f.running.empty()) f.running[subpolygon.place()].assign(result.running.begin(), result.running.end());
  f.pixels_there += area_of(f.buffer->grid().polygon(subpolygon));
  if (!is_final) return;
  while (FrameBuffer::Band band = f.buffer->take_band()) {
    if (!f.writing) {
      FrameWriter::Job job = job_of(frame);
      job.late = {kRays};
      f.writing = writer_.begin(std::move(job));
    }
    writer_.write(*f.writing, std::move(band));
    ++f.bands_in_writing;
  }
}

void PictureFiles::write_pass(FrameIndex frame, int pass) {
  Frame& f = frames_[frame.place()];
  // A disk slower than the nodes gets the picture of a later pass in place of this one.
  if (!std::exchange(f.is_pass_in_writing, true)) {
    FrameWriter::Job job = job_of(frame);
    const auto passes = static_cast<uint32_t>(options_.plan.pictures.passes);
    job.is_last_pass = false;
    job.attributes["rayfarm/pass"] = fmt::format("{} of {}", pass + 1, passes);
    const RenderPass of_samples{static_cast<uint32_t>(pass), passes, {}};
    job.attributes["rayfarm/samples"] = fmt::format("{}", of_samples.end(options_.passes.samples));
    const PictureInWriting writing = writer_.begin(std::move(job));
    for (FrameBuffer::Band& band : f.buffer->lend()) writer_.write(writing, std::move(band));
    writer_.end(writing, {});
  }
}

void PictureFiles::complete(FrameIndex frame) {
  Frame& f = frames_[frame.place()];
  f.running = std::vector<Bytes>();
  f.is_complete = true;
  writer_.end(*f.writing, {{kRays, fmt::format("{}", result_.frames[frame.place()].rays.total())}});
}

void PictureFiles::drop(FrameIndex frame) {
  Frame& f = frames_[frame.place()];
  if (f.writing) writer_.drop(*std::exchange(f.writing, std::nullopt));
  f.buffer.reset();
  f.running = std::vector<Bytes>();
}

void PictureFiles::take_bands() {
  while (const auto band = writer_.try_take_band()) {
    Frame& f = frames_[band->frame.place()];
    if (!f.writing || *f.writing != band->picture) continue;  // of a pass, or it was dropped
    --f.bands_in_writing;
    f.buffer->let_go_band();
  }
}

std::vector<FrameIndex> PictureFiles::take_written() {
  std::vector<FrameIndex> over;
  take_bands();
  while (const auto written = writer_.try_take()) {
    FrameResult& frame = result_.frames[written->frame.place()];
    Frame& f = frames_[written->frame.place()];
    result_.times.write_s += written->seconds;
    if (!written->is_last_pass) {
      f.is_pass_in_writing = false;
      if (f.buffer) f.buffer->end_lending();
      if (!written->problem.empty())
        tell_(fmt::format("frame {}: a pass's picture could not be written: {}", frame.frame.value(),
                          written->problem));
      continue;
    }
    if (f.writing != written->picture) continue;  // it was dropped, and failed before that
    frame.problem = written->problem;
    frame.sha256 = written->sha256;
    frame.is_written = written->problem.empty();
    frame.is_black = written->is_black;
    if (!f.is_complete) writer_.drop(*f.writing);  // it failed
    f.writing.reset();
    f.buffer.reset();
    f.running = std::vector<Bytes>();
    if (!frame.is_written) tell_(fmt::format("frame {} failed: {}", frame.frame.value(), frame.problem));
    over.push_back(written->frame);
  }
  return over;
}

void PictureFiles::finish() {
  for (FrameIndex i; i.place() < frames_.size(); ++i) {
    Frame& f = frames_[i.place()];
    if (f.writing && !f.is_complete) writer_.drop(*std::exchange(f.writing, std::nullopt));
  }
  writer_.finish();
}

double PictureFiles::share_there(FrameIndex frame) const {
  return static_cast<double>(frames_[frame.place()].pixels_there) / pixels_of_frame(options_);
}

std::string PictureFiles::write_preview(FrameIndex frame) {
  const Frame& f = frames_[frame.place()];
  if (!f.buffer || f.buffer->is_streamed()) return {};
  const std::string path = preview_of(options_.files[frame.place()]);
  rayfarm::write_preview(path, options_.image, *f.buffer);
  return path;
}

}  // namespace rayfarm
