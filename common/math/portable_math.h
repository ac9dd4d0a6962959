#pragma once
// Elementary functions whose result is the same to the last bit on every machine: only IEEE additions,
// multiplications, divisions, square roots and roundings are used, without fused operations. glibc chooses
// other code by the CPU it finds, so its sin, cos, exp and pow must never reach a pixel. The error is below 4
// units in the last place of the result (pow: relative error below 1e-13 for results between 1e-30 and 1e30),
// which the tests compare with long double.

namespace rayfarm {

double portable_sin(double radians);  ///< |radians| <= 1e6
double portable_cos(double radians);  ///< |radians| <= 1e6
/// Both at once, at the price of one and a half.
struct SineCosine {
  double sine, cosine;
};
SineCosine portable_sine_cosine(double radians);    ///< |radians| <= 1e6
double portable_tan(double radians);                ///< |radians| < pi/2
double portable_acos(double x);                     ///< x is clamped to [-1, 1]; radians in [0, pi]
double portable_exp(double x);                      ///< 0 below -745, infinity above 709
double portable_log(double x);                      ///< natural logarithm of a positive, finite number
double portable_exp2(double x);                     ///< |x| <= 1000; exact for whole numbers
double portable_pow(double base, double exponent);  ///< base >= 0; 0 to any positive power is 0

}  // namespace rayfarm
