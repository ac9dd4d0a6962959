#pragma once
// What the commands about the net are asked for.
#include <string>
#include <vector>

#include "host/net/model.h"
#include "host/net/simulator.h"

namespace rayfarm {

enum class TableFormat { text, csv, json };

struct ModelOptions {
  NetModel model;
  std::vector<double> processors;  ///< rows of the table; empty: powers of two and what the model solves for
  TableFormat format = TableFormat::text;
};

struct SimulateOptions {
  Simulation simulation;
  double pixel_time_s = 0;  ///< what a pixel is to cost on average; 0: what the cost map says
  std::vector<int> processors{1, 2, 4, 8, 16, 32};  ///< one row each
  TableFormat format = TableFormat::text;
};

}  // namespace rayfarm
