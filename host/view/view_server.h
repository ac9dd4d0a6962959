#pragma once
// The page on which a job can be looked at in a browser, below a path that nobody can guess.
#include <atomic>
#include <optional>
#include <string>

#include "host/view/farm_view.h"
#include "host/view/loopback_server.h"

namespace rayfarm {

class ViewServer {
 public:
  /// Serves from now on, at this port of 127.0.0.1; 0: any that is free. `view` must outlive it. Throws
  /// std::runtime_error if that can't be.
  ViewServer(int port, const FarmView& view);

  /// Where a browser finds the page; with the token, without which there is nothing to be found.
  std::string url() const;
  /// A page asks twice a second: where one is open, waits so long that it has seen how the job ended.
  void let_pages_see_the_end() const;

 private:
  HttpAnswer answer(const std::string& path, const std::string& since);

  const FarmView& view_;
  const std::string token_;
  std::atomic<double> asked_s_{-1e9};  ///< when a page last did, see now_s
  std::optional<LoopbackServer> server_;
};

}  // namespace rayfarm
