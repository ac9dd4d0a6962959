#include "host/instrument/simulator.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <queue>
#include <stdexcept>

namespace rayfarm {
namespace {

/// Command, form and report of a block, most of them numbers of variable length.
constexpr double kBlockHeaderBytes = 16;

void check(const Simulation& s) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(what);
  };
  require(s.processors >= 1 && s.processors <= kMostProcessors, "a net has 1 to 16,383 processors");
  require(s.frames >= 1, "there must be a frame");
  require(s.subpolygons_per_processor >= 1, "a processor has at least one subpolygon");
  require(s.rate_bit_per_s > 0, "the net's rate must be above 0");
  require(s.pixels_per_message >= 1 && s.nets >= 1 && s.frame_buffers >= 1 && s.frames_open >= 1 &&
              s.assigned_ahead >= 1 && s.messages_held >= 0,
          "counts begin at 1");
  require(s.cost.columns >= 1 && s.cost.rows >= 1 && s.cost.frames >= 1 &&
              s.cost.width_px >= s.cost.columns && s.cost.height_px >= s.cost.rows &&
              s.cost.width_px <= 65536 && s.cost.height_px <= 65536,
          "the cost map's size");
  const size_t cells = static_cast<size_t>(s.cost.columns) * static_cast<size_t>(s.cost.rows) *
                       static_cast<size_t>(s.cost.frames);
  require(s.cost.pixel_s.size() == cells && s.cost.pixel_bytes.size() == cells,
          "the cost map's cells are not as many as it says");
  for (const double factor : s.time_factors) require(factor > 0, "time factors must be above 0");
}

/// Something that does one thing after the other.
class Server {
 public:
  /// The end of a task that is there at `ready` and takes `duration`.
  double serve(double ready, double duration) {
    free_ = std::max(ready, free_) + duration;
    busy_ += duration;
    return free_;
  }
  double busy() const { return busy_; }

 private:
  double free_ = 0, busy_ = 0;
};

class Simulator {
 public:
  explicit Simulator(const Simulation& s)
      : s_(s),
        grid_(grid_of(s)),
        processors_(static_cast<size_t>(s.processors)),
        nets_(static_cast<size_t>(s.nets)),
        host_out_(nets_.size()),
        ports_(s.net == NetShape::ports ? processors_.size() : 0),
        frame_buffers_(static_cast<size_t>(s.frame_buffers)),
        left_(static_cast<size_t>(s.frames), int64_t{s.cost.width_px} * s.cost.height_px),
        ends_(left_.size(), 0) {
    for (size_t i = 0; i < processors_.size(); ++i)
      if (!s.time_factors.empty()) processors_[i].factor = s.time_factors[i % s.time_factors.size()];
    cell_x_.resize(static_cast<size_t>(s.cost.width_px));
    cell_y_.resize(static_cast<size_t>(s.cost.height_px));
    const SubpolygonGrid cells{0, 0, s.cost.width_px, s.cost.height_px, s.cost.columns, s.cost.rows};
    for (int i = 0; i < cells.count(); ++i) {
      const DisplayPolygon cell = cells.polygon(SubpolygonId(i));
      std::fill(&cell_x_[cell.left], &cell_x_[cell.right] + 1, i % cells.columns);
      std::fill(&cell_y_[cell.top], &cell_y_[cell.bottom] + 1, i / cells.columns * cells.columns);
    }
  }

  SimulationResult run() {
    const double loaded = transmission_s(s_.load_bytes);
    for (Server& net : nets_) net.serve(0, loaded);
    for (Server& out : host_out_) out.serve(0, loaded);
    const bool is_on_demand = s_.policy == AssignmentPolicy::on_demand;
    if (!is_on_demand) lay_out_sets();
    for (int ahead = 0; ahead < (is_on_demand ? s_.assigned_ahead : 1); ++ahead)
      for (int p = 0; p < s_.processors; ++p) {
        if (is_on_demand)
          push(loaded, EventKind::wants_work, p);
        else
          start_next(p, loaded);
      }
    while (!events_.empty()) {
      const Event event = events_.top();
      events_.pop();
      switch (event.kind) {
        case EventKind::traced:
          send_result(event.processor, event.time);
          break;
        case EventKind::wants_work:
          assign(event.processor, event.time);
          break;
        case EventKind::has_work:
          take_work(event.processor, event.time);
          break;
        case EventKind::frame_over:
          open_frame(event.time);
          break;
      }
    }
    return result(loaded);
  }

 private:
  enum class EventKind : uint8_t { traced, wants_work, has_work, frame_over };
  struct Event {
    double time;
    uint64_t order;  ///< among events of one time: first come, first served
    EventKind kind;
    int processor;
    bool operator>(const Event& e) const { return time != e.time ? time > e.time : order > e.order; }
  };
  struct Work {
    int frame = 0;
    SubpolygonId subpolygon;
  };
  struct Processor {
    double factor = 1;
    // The subpolygon at hand, and which of its pixels comes next.
    bool has_work = false;
    Work work;
    DisplayPolygon polygon;
    int64_t next_pixel = 0;
    // The message being traced.
    int64_t message_pixels = 0;
    double message_bytes = 0;
    std::deque<double> sent;                ///< when the messages end that may still be on their way
    std::deque<Work> on_its_way, assigned;  ///< on demand
    double idle_since = 0;
    bool is_idle = true;
    int frame = 0;  ///< interleaved
    size_t next_of_set = 0;
  };
  /// Interleaved: who traces what in the first frame, processor by processor.
  struct Sets {
    std::vector<SubpolygonId> subpolygons;
    std::vector<size_t> begin;
  };

  void push(double time, EventKind kind, int processor) { events_.push({time, order_++, kind, processor}); }

  double transmission_s(double bytes) const {
    const double packets = s_.packet_bytes > 0 ? std::max(1.0, std::ceil(bytes / s_.packet_bytes)) : 1;
    return bytes > 0 ? 8 * (bytes + packets * s_.message_bytes) / s_.rate_bit_per_s : 0;
  }
  size_t net_of(int processor) const { return static_cast<size_t>(processor) % nets_.size(); }

  /// From a processor to the host: the time at which the processor has sent it. Sets the time of arrival.
  double to_host(int processor, double ready, double bytes, double& arrival) {
    count(bytes);
    const double duration = transmission_s(bytes);
    double sent;
    if (s_.net == NetShape::bus) {
      sent = arrival = nets_[net_of(processor)].serve(ready, duration);
    } else {
      sent = ports_[static_cast<size_t>(processor)].serve(ready, duration);
      // The switch passes packets on as they come.
      arrival = std::max(sent, nets_[net_of(processor)].serve(sent - duration, duration));
    }
    arrival += s_.latency_s;
    return sent;
  }

  double to_processor(int processor, double ready, double bytes) {
    count(bytes);
    Server& net = s_.net == NetShape::bus ? nets_[net_of(processor)] : host_out_[net_of(processor)];
    return net.serve(ready, transmission_s(bytes)) + s_.latency_s;
  }

  void count(double bytes) {
    bytes_ += bytes + s_.message_bytes *
                          (s_.packet_bytes > 0 ? std::max(1.0, std::ceil(bytes / s_.packet_bytes)) : 1);
    ++messages_;
  }

  void lay_out_sets() {
    sets_.begin.assign(processors_.size() + 1, 0);
    std::vector<size_t> owners;
    for (SubpolygonId i; i.value() < grid_.count(); ++i)
      owners.push_back(
          static_cast<size_t>(interleaved_owner(grid_, s_.sets, s_.processors, FrameIndex(0), i)));
    for (const size_t owner : owners) ++sets_.begin[owner + 1];
    for (size_t p = 0; p < processors_.size(); ++p) sets_.begin[p + 1] += sets_.begin[p];
    std::vector<size_t> next = sets_.begin;
    sets_.subpolygons.resize(owners.size());
    for (SubpolygonId i; i.value() < grid_.count(); ++i) sets_.subpolygons[next[owners[i.place()]]++] = i;
  }

  bool is_open(int frame) const { return frame < s_.frames && frame < whole_frames_ + s_.frames_open; }

  /// The processor's next subpolygon. False: there is none now.
  bool find_work(Processor& p, size_t index) {
    if (s_.policy == AssignmentPolicy::on_demand) {
      if (p.assigned.empty()) return false;
      p.work = p.assigned.front();
      p.assigned.pop_front();
      return true;
    }
    while (true) {
      if (!is_open(p.frame)) return false;
      if (const size_t next = sets_.begin[index] + p.next_of_set; next < sets_.begin[index + 1]) {
        ++p.next_of_set;
        const FrameIndex moves(s_.rotates ? p.frame : 0);
        p.work = {p.frame, moved_right(grid_, sets_.subpolygons[next], moves)};
        return true;
      }
      ++p.frame;
      p.next_of_set = 0;
    }
  }

  /// Begins to trace the next message at `time`.
  void start_next(int processor, double time) {
    Processor& p = processors_[static_cast<size_t>(processor)];
    if (!p.has_work) {
      if (!find_work(p, static_cast<size_t>(processor))) {
        p.is_idle = true;
        p.idle_since = time;
        return;
      }
      p.has_work = true;
      p.polygon = grid_.polygon(p.work.subpolygon);
      p.next_pixel = 0;
    }
    p.is_idle = false;
    const int64_t width = p.polygon.right - p.polygon.left + 1;
    const int64_t pixels = width * (p.polygon.bottom - p.polygon.top + 1);
    p.message_pixels = s_.form == ResultForm::pixels
                           ? std::min<int64_t>(s_.pixels_per_message, pixels - p.next_pixel)
                           : pixels;
    double cost = 0, bytes = 0;
    const size_t of_frame = static_cast<size_t>(p.work.frame % s_.cost.frames) *
                            static_cast<size_t>(s_.cost.columns * s_.cost.rows);
    for (int64_t i = p.next_pixel; i < p.next_pixel + p.message_pixels; ++i) {
      const size_t cell =
          of_frame + static_cast<size_t>(cell_x_[static_cast<size_t>(p.polygon.left + i % width)] +
                                         cell_y_[static_cast<size_t>(p.polygon.top + i / width)]);
      cost += s_.cost.pixel_s[cell];
      bytes += s_.cost.pixel_bytes[cell];
    }
    p.next_pixel += p.message_pixels;
    p.has_work = p.next_pixel < pixels;
    const auto n = static_cast<double>(p.message_pixels);
    p.message_bytes = s_.form == ResultForm::pixels   ? kPixelBytes * n
                      : s_.form == ResultForm::blocks ? kBlockHeaderBytes + 3 * n
                                                      : kBlockHeaderBytes + bytes;
    cost *= p.factor;
    busy_ += cost;
    work_ += cost / p.factor;
    push(time + cost, EventKind::traced, processor);
  }

  void send_result(int processor, double time) {
    Processor& p = processors_[static_cast<size_t>(processor)];
    double arrival = 0;
    const double sent = to_host(processor, time, p.message_bytes, arrival);
    const double taken = host_.serve(arrival, s_.host_message_s);
    Server& buffer = frame_buffers_[p.work.subpolygon.place() % frame_buffers_.size()];
    const double stored = buffer.serve(taken, static_cast<double>(p.message_pixels) * s_.frame_buffer_s);
    store(p.work.frame, p.message_pixels, stored);
    if (!p.has_work && s_.policy == AssignmentPolicy::on_demand)
      push(taken, EventKind::wants_work, processor);
    double next = time;
    if (s_.messages_held > 0) {
      p.sent.push_back(sent);
      if (static_cast<int>(p.sent.size()) >= s_.messages_held) {
        next = std::max(next, p.sent.front());
        p.sent.pop_front();
      }
    }
    waited_ += next - time;
    start_next(processor, next);
  }

  void store(int frame, int64_t pixels, double time) {
    auto& left = left_[static_cast<size_t>(frame)];
    auto& end = ends_[static_cast<size_t>(frame)];
    left -= pixels;
    end = std::max(end, time);
    if (left == 0) push(end, EventKind::frame_over, 0);
  }

  void open_frame(double time) {
    ++whole_frames_;
    if (s_.policy == AssignmentPolicy::on_demand) {
      std::deque<int> waiting;
      waiting.swap(waiting_);
      for (const int processor : waiting) assign(processor, time);
      return;
    }
    for (int i = 0; i < s_.processors; ++i) {
      const Processor& p = processors_[static_cast<size_t>(i)];
      if (p.is_idle) start_next(i, std::max(time, p.idle_since));
    }
  }

  /// On demand: the next subpolygon of the sequence goes to a processor.
  void assign(int processor, double time) {
    if (next_work_.frame == s_.frames) return;
    if (!is_open(next_work_.frame)) {
      waiting_.push_back(processor);
      return;
    }
    processors_[static_cast<size_t>(processor)].on_its_way.push_back(next_work_);
    if ((++next_work_.subpolygon).value() == grid_.count()) next_work_ = {next_work_.frame + 1, {}};
    push(to_processor(processor, time, kDisplayPolygonBytes), EventKind::has_work, processor);
  }

  void take_work(int processor, double time) {
    Processor& p = processors_[static_cast<size_t>(processor)];
    p.assigned.push_back(p.on_its_way.front());
    p.on_its_way.pop_front();
    if (p.is_idle) start_next(processor, std::max(time, p.idle_since));
  }

  SimulationResult result(double loaded) const {
    SimulationResult r;
    for (const double end : ends_) r.frames.push_back({end});
    r.total_s = *std::max_element(ends_.begin(), ends_.end());
    r.first_frame_s = ends_.front();
    const double after = r.total_s - loaded;
    r.frame_s = after / static_cast<double>(ends_.size());
    r.busy_s = busy_;
    double speed = 0;
    for (const Processor& p : processors_) speed += 1 / p.factor;
    r.efficiency = after > 0 ? work_ / (speed * after) : 0;
    double net_busy = 0;
    for (const Server& net : nets_) net_busy += net.busy() - loaded;
    r.net_use = after > 0 ? net_busy / (after * static_cast<double>(nets_.size())) : 0;
    r.waited_s = waited_;
    r.bytes = bytes_;
    r.messages = messages_;
    return r;
  }

  const Simulation& s_;
  SubpolygonGrid grid_;
  std::vector<Processor> processors_;
  std::vector<Server> nets_, host_out_, ports_, frame_buffers_;
  Server host_;
  std::vector<int> cell_x_, cell_y_;
  Sets sets_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  uint64_t order_ = 0;
  std::vector<int64_t> left_;
  std::vector<double> ends_;
  int whole_frames_ = 0;
  Work next_work_;           ///< on demand
  std::deque<int> waiting_;  ///< on demand: for a frame to be opened
  double busy_ = 0, work_ = 0, waited_ = 0, bytes_ = 0;
  uint64_t messages_ = 0;
};

}  // namespace

SubpolygonGrid grid_of(const Simulation& s) {
  return make_grid(0, 0, s.cost.width_px, s.cost.height_px, s.processors, s.subpolygons_per_processor,
                   s.least_side_px);
}

SimulationResult simulate(const Simulation& simulation) {
  check(simulation);
  return Simulator(simulation).run();
}

}  // namespace rayfarm
