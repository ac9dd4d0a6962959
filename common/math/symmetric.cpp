#include "common/math/symmetric.h"

#include <cmath>

namespace rayfarm {

Mat3 diagonalize(Mat3& m, double noise) {
  Mat3 vectors(1);
  for (int sweep = 0; sweep < 30; ++sweep)
    for (int i = 0; i < 2; ++i)
      for (int j = i + 1; j < 3; ++j) {
        if (std::abs(m[i][j]) <= std::max(1e-300, noise * (std::abs(m[i][i]) + std::abs(m[j][j])))) continue;
        const double theta = (m[j][j] - m[i][i]) / (2 * m[i][j]);
        const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double cosine = 1 / std::sqrt(t * t + 1), sine = t * cosine;
        Mat3 turn(1);
        turn[i][i] = turn[j][j] = cosine;
        turn[j][i] = sine;
        turn[i][j] = -sine;
        m = glm::transpose(turn) * m * turn;
        vectors = vectors * turn;
      }
  return vectors;
}

}  // namespace rayfarm
