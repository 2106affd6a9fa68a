#pragma once

namespace camera_self_calibration {

/// Upper quantile of the chi-square distribution: the value exceeded with this probability.
double chiSquareQuantile(double degrees_of_freedom, double exceed_probability);

/// Probability that a chi-square variable exceeds `value`; degrees of freedom need not be whole.
double chiSquareExceedance(double value, double degrees_of_freedom);

/// Probability that a variable of Fisher's F distribution exceeds `value`.
double fExceedance(double value, double numerator_freedom, double denominator_freedom);

/// Probability that chance puts a value so far beyond `limit`, one-sided: Student's with `freedom`
/// degrees, normal where that is 0. 1 for a value that is not known.
double chanceBeyond(double value, double sigma, double limit, double freedom);

/// Number of false alarms (Desolneux, Moisan & Morel 2000): how many of `tests` would find `found`
/// or more of `candidates` by chance alone, where each of these is found by chance with probability
/// `by_chance`, independently.
double falseAlarms(double tests, int found, int candidates, double by_chance);

/// Logarithm of the integral of `u^(a-1) e^(-b u)` over u from 0 to 1; a, b > 0.
double logIncompleteGamma(double a, double b);

}  // namespace camera_self_calibration
