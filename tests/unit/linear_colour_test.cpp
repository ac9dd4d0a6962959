// Colours as lists of nodes (Shirley, Sung and Brown 1991, section 2.1).
#include "host/experiments/colour/linear_colour.h"

#include <gtest/gtest.h>

namespace rayfarm {
namespace {

// "When two colors were combined by an operation, a new color with possibly more nodes was generated."
TEST(LinearColour, OfAnOperationHasTheNodesOfBoth) {
  const LinearColour a{{400, 1}, {500, 3}, {600, 1}}, b{{450, 2}, {500, 4}, {650, 1}};
  const LinearColour product = a * b, sum = a + b;
  const std::vector<double> nodes{400, 450, 500, 600, 650};
  ASSERT_EQ(product.size(), nodes.size());
  ASSERT_EQ(sum.size(), nodes.size());
  for (size_t i = 0; i < nodes.size(); ++i) {
    EXPECT_EQ(product[i].wavelength_nm, nodes[i]);
    EXPECT_NEAR(product[i].value, eval_spectrum(a, nodes[i]) * eval_spectrum(b, nodes[i]), 1e-12);
    EXPECT_NEAR(sum[i].value, eval_spectrum(a, nodes[i]) + eval_spectrum(b, nodes[i]), 1e-12);
  }
}

}  // namespace
}  // namespace rayfarm
