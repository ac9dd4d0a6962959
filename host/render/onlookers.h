#pragma once
// Who looks at pictures while they grow: a page in a browser, a viewer.
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "host/render/render_options.h"
#include "host/view/view_server.h"

namespace rayfarm {

class Onlookers {
 public:
  /// Says on stderr where the page is. `tell` may be called by any thread. Throws JobError if the page's port
  /// can't be had, or there is no host of the viewer's name.
  Onlookers(const RenderOptions& options, std::function<void(const std::string&)> tell);

  std::vector<Watcher*> watchers() const;
  /// The job is over. A page that is open gets a second to see it, a viewer some to take what is on its way.
  void end(int exit_code);

 private:
  std::unique_ptr<FarmView> view_;
  std::optional<ViewServer> server_;  // after what it reads
  std::unique_ptr<TevDisplay> tev_;
};

}  // namespace rayfarm
