// The 53 smooth problems of More and Wild 2009, Benchmarking derivative-free optimization algorithms
// (SIAM Journal on Optimization 20(1), section 4): 22 least-squares functions in several sizes, from
// the standard start or ten times it. Functions 1 to 18 are those of More, Garbow and Hillstrom
// 1981, Testing unconstrained optimization software; 19 to 22 are from CUTEr: bdqrtic, cube,
// mancino, heart8.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

namespace armwright::more_wild {

using Vector = std::vector<double>;

// One problem: the number of the function (from 1), the number of variables and of residuals, and
// whether the start is ten times the standard one.
struct Instance {
  int function;
  std::size_t n;
  std::size_t m;
  bool is_far;
};

inline constexpr std::array<Instance, 53> kInstances{{
    {1, 9, 45, false},   {1, 9, 45, true},    {2, 7, 35, false},   {2, 7, 35, true},
    {3, 7, 35, false},   {3, 7, 35, true},    {4, 2, 2, false},    {4, 2, 2, true},
    {5, 3, 3, false},    {5, 3, 3, true},     {6, 4, 4, false},    {6, 4, 4, true},
    {7, 2, 2, false},    {7, 2, 2, true},     {8, 3, 15, false},   {8, 3, 15, true},
    {9, 4, 11, false},   {10, 3, 16, false},  {11, 6, 31, false},  {11, 6, 31, true},
    {11, 9, 31, false},  {11, 9, 31, true},   {11, 12, 31, false}, {11, 12, 31, true},
    {12, 3, 10, false},  {13, 2, 10, false},  {14, 4, 20, false},  {14, 4, 20, true},
    {15, 6, 6, false},   {15, 7, 7, false},   {15, 8, 8, false},   {15, 9, 9, false},
    {15, 10, 10, false}, {15, 11, 11, false}, {16, 10, 10, false}, {17, 5, 33, false},
    {18, 11, 65, false}, {18, 11, 65, true},  {19, 8, 8, false},   {19, 10, 12, false},
    {19, 11, 14, false}, {19, 12, 16, false}, {20, 5, 5, false},   {20, 6, 6, false},
    {20, 8, 8, false},   {21, 5, 5, false},   {21, 5, 5, true},    {21, 8, 8, false},
    {21, 10, 10, false}, {21, 12, 12, false}, {21, 12, 12, true},  {22, 8, 8, false},
    {22, 8, 8, true},
}};

inline constexpr std::array<const char*, 22> kNames{"linear, full rank",
                                                    "linear, rank 1",
                                                    "linear, rank 1 with zeros",
                                                    "Rosenbrock",
                                                    "helical valley",
                                                    "Powell singular",
                                                    "Freudenstein and Roth",
                                                    "Bard",
                                                    "Kowalik and Osborne",
                                                    "Meyer",
                                                    "Watson",
                                                    "Box 3-dimensional",
                                                    "Jennrich and Sampson",
                                                    "Brown and Dennis",
                                                    "Chebyquad",
                                                    "Brown almost-linear",
                                                    "Osborne 1",
                                                    "Osborne 2",
                                                    "bdqrtic",
                                                    "cube",
                                                    "mancino",
                                                    "heart8"};

inline const char* get_name(const Instance& instance) {
  return kNames[static_cast<std::size_t>(instance.function - 1)];
}

inline double square(double x) {
  return x * x;
}

inline double calc_sum(const Vector& x) {
  double sum = 0;
  for (const double value : x) {
    sum += value;
  }
  return sum;
}

// The three linear functions.
inline Vector calc_linear(int function, const Vector& x, std::size_t m) {
  const std::size_t n = x.size();
  Vector r(m);
  if (function == 1) {
    const double shared = 2 * calc_sum(x) / static_cast<double>(m) + 1;
    for (std::size_t i = 0; i < m; ++i) {
      r[i] = (i < n ? x[i] : 0) - shared;
    }
    return r;
  }
  const bool has_zeros = function == 3;
  double sum = 0;
  for (std::size_t j = has_zeros ? 1 : 0; j < n - (has_zeros ? 1 : 0); ++j) {
    sum += static_cast<double>(j + 1) * x[j];
  }
  for (std::size_t i = 0; i < m; ++i) {
    r[i] = static_cast<double>(has_zeros ? i : i + 1) * sum - 1;
  }
  if (has_zeros) {
    r[m - 1] = -1;
  }
  return r;
}

inline Vector calc_helical_valley(const Vector& x) {
  double turn = 0.25;
  if (x[0] != 0) {
    turn = std::atan(x[1] / x[0]) / (2 * std::numbers::pi) + (x[0] < 0 ? 0.5 : 0);
  }
  return {10 * (x[2] - 10 * turn), 10 * (std::hypot(x[0], x[1]) - 1), x[2]};
}

inline Vector calc_bard(const Vector& x) {
  constexpr std::array<double, 15> kY{0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39,
                                      0.37, 0.58, 0.73, 0.96, 1.34, 2.1,  4.39};
  Vector r;
  for (std::size_t i = 0; i < kY.size(); ++i) {
    const double u = static_cast<double>(i + 1);
    const double v = 16 - u;
    r.push_back(kY[i] - (x[0] + u / (v * x[1] + std::min(u, v) * x[2])));
  }
  return r;
}

inline Vector calc_kowalik_osborne(const Vector& x) {
  constexpr std::array<double, 11> kY{0.1957, 0.1947, 0.1735, 0.16,   0.0844, 0.0627,
                                      0.0456, 0.0342, 0.0323, 0.0235, 0.0246};
  constexpr std::array<double, 11> kU{4,     2,   1,      0.5,    0.25,  0.167,
                                      0.125, 0.1, 0.0833, 0.0714, 0.0625};
  Vector r;
  for (std::size_t i = 0; i < kY.size(); ++i) {
    const double u = kU[i];
    r.push_back(kY[i] - x[0] * u * (u + x[1]) / (u * (u + x[2]) + x[3]));
  }
  return r;
}

inline Vector calc_meyer(const Vector& x) {
  constexpr std::array<double, 16> kY{34780, 28610, 23650, 19630, 16370, 13720, 11540, 9744,
                                      8261,  7030,  6005,  5147,  4427,  3820,  3307,  2872};
  Vector r;
  for (std::size_t i = 0; i < kY.size(); ++i) {
    const double t = 45 + 5 * static_cast<double>(i + 1);
    r.push_back(x[0] * std::exp(x[1] / (t + x[2])) - kY[i]);
  }
  return r;
}

inline Vector calc_watson(const Vector& x) {
  Vector r;
  for (int i = 1; i <= 29; ++i) {
    const double t = i / 29.0;
    double slope = 0;
    double value = 0;
    double power = 1;  // t to the power of j
    for (std::size_t j = 0; j < x.size(); ++j) {
      value += power * x[j];
      if (j + 1 < x.size()) {
        slope += static_cast<double>(j + 1) * power * x[j + 1];
      }
      power *= t;
    }
    r.push_back(slope - square(value) - 1);
  }
  r.push_back(x[0]);
  r.push_back(x[1] - square(x[0]) - 1);
  return r;
}

// Functions 12 to 14, with any number of residuals.
inline Vector calc_exponentials(int function, const Vector& x, std::size_t m) {
  Vector r;
  for (std::size_t i = 1; i <= m; ++i) {
    const double k = static_cast<double>(i);
    if (function == 12) {
      const double t = k / 10;
      r.push_back(std::exp(-t * x[0]) - std::exp(-t * x[1]) + (std::exp(-k) - std::exp(-t)) * x[2]);
    } else if (function == 13) {
      r.push_back(2 + 2 * k - std::exp(k * x[0]) - std::exp(k * x[1]));
    } else {
      const double t = k / 5;
      r.push_back(square(x[0] + t * x[1] - std::exp(t)) +
                  square(x[2] + std::sin(t) * x[3] - std::cos(t)));
    }
  }
  return r;
}

// The mean of the Chebyshev polynomials on [0, 1] less their integrals.
inline Vector calc_chebyquad(const Vector& x, std::size_t m) {
  Vector r(m, 0.0);
  for (const double value : x) {
    const double y = 2 * value - 1;
    double before = 1;
    double polynomial = y;
    for (double& residual : r) {
      residual += polynomial / static_cast<double>(x.size());
      before = std::exchange(polynomial, 2 * y * polynomial - before);
    }
  }
  for (std::size_t i = 2; i <= m; i += 2) {
    r[i - 1] += 1 / (square(static_cast<double>(i)) - 1);
  }
  return r;
}

inline Vector calc_brown_almost_linear(const Vector& x) {
  const double sum = calc_sum(x) - static_cast<double>(x.size() + 1);
  double product = 1;
  Vector r;
  for (const double value : x) {
    r.push_back(value + sum);
    product *= value;
  }
  r.back() = product - 1;
  return r;
}

inline Vector calc_osborne_1(const Vector& x) {
  constexpr std::array<double, 33> kY{0.844, 0.908, 0.932, 0.936, 0.925, 0.908, 0.881, 0.85,  0.818,
                                      0.784, 0.751, 0.718, 0.685, 0.658, 0.628, 0.603, 0.58,  0.558,
                                      0.538, 0.522, 0.506, 0.49,  0.478, 0.467, 0.457, 0.448, 0.438,
                                      0.431, 0.424, 0.42,  0.414, 0.411, 0.406};
  Vector r;
  for (std::size_t i = 0; i < kY.size(); ++i) {
    const double t = 10 * static_cast<double>(i);
    r.push_back(kY[i] - (x[0] + x[1] * std::exp(-x[3] * t) + x[2] * std::exp(-x[4] * t)));
  }
  return r;
}

inline Vector calc_osborne_2(const Vector& x) {
  constexpr std::array<double, 65> kY{
      1.366, 1.191, 1.112, 1.013, 0.991, 0.885, 0.831, 0.847, 0.786, 0.725, 0.746, 0.679, 0.608,
      0.655, 0.616, 0.606, 0.602, 0.626, 0.651, 0.724, 0.649, 0.649, 0.694, 0.644, 0.624, 0.661,
      0.612, 0.558, 0.533, 0.495, 0.5,   0.423, 0.395, 0.375, 0.372, 0.391, 0.396, 0.405, 0.428,
      0.429, 0.523, 0.562, 0.607, 0.653, 0.672, 0.708, 0.633, 0.668, 0.645, 0.632, 0.591, 0.559,
      0.597, 0.625, 0.739, 0.71,  0.729, 0.72,  0.636, 0.581, 0.428, 0.292, 0.162, 0.098, 0.054};
  Vector r;
  for (std::size_t i = 0; i < kY.size(); ++i) {
    const double t = static_cast<double>(i) / 10;
    double model = x[0] * std::exp(-x[4] * t);
    for (std::size_t k = 1; k <= 3; ++k) {
      model += x[k] * std::exp(-x[4 + k] * square(t - x[7 + k]));
    }
    r.push_back(kY[i] - model);
  }
  return r;
}

inline Vector calc_bdqrtic(const Vector& x) {
  const std::size_t half = x.size() - 4;
  Vector r(2 * half);
  for (std::size_t i = 0; i < half; ++i) {
    r[i] = 3 - 4 * x[i];
    r[half + i] = square(x[i]) + 2 * square(x[i + 1]) + 3 * square(x[i + 2]) +
                  4 * square(x[i + 3]) + 5 * square(x.back());
  }
  return r;
}

inline Vector calc_cube(const Vector& x) {
  Vector r{x[0] - 1};
  for (std::size_t i = 1; i < x.size(); ++i) {
    r.push_back(10 * (x[i] - std::pow(x[i - 1], 3)));
  }
  return r;
}

// The sum over j of v (sin^5 ln v + cos^5 ln v), v = sqrt(x_i^2 + i/j); i counts from 1.
inline double calc_mancino_sum(double x, std::size_t i, std::size_t n) {
  double sum = 0;
  for (std::size_t j = 1; j <= n; ++j) {
    const double v = std::sqrt(x * x + static_cast<double>(i) / static_cast<double>(j));
    sum += v * (std::pow(std::sin(std::log(v)), 5) + std::pow(std::cos(std::log(v)), 5));
  }
  return sum;
}

inline Vector calc_mancino(const Vector& x) {
  Vector r;
  for (std::size_t i = 1; i <= x.size(); ++i) {
    r.push_back(1400 * x[i - 1] + std::pow(static_cast<double>(i) - 50, 3) +
                calc_mancino_sum(x[i - 1], i, x.size()));
  }
  return r;
}

// The moments of two dipoles of a heart: a complex number for every order.
inline Vector calc_heart(const Vector& x) {
  const double a = x[0];
  const double b = x[1];
  const double c = x[2];
  const double d = x[3];
  const double t = x[4];
  const double u = x[5];
  const double v = x[6];
  const double w = x[7];
  return {a + b + 0.69,
          c + d + 0.044,
          t * a + u * b - v * c - w * d + 1.57,
          v * a + w * b + t * c + u * d + 1.31,
          a * (t * t - v * v) - 2 * c * t * v + b * (u * u - w * w) - 2 * d * u * w + 2.65,
          c * (t * t - v * v) + 2 * a * t * v + d * (u * u - w * w) + 2 * b * u * w - 2,
          a * t * (t * t - 3 * v * v) + c * v * (v * v - 3 * t * t) + b * u * (u * u - 3 * w * w) +
              d * w * (w * w - 3 * u * u) + 12.6,
          c * t * (t * t - 3 * v * v) - a * v * (v * v - 3 * t * t) + d * u * (u * u - 3 * w * w) -
              b * w * (w * w - 3 * u * u) - 9.48};
}

inline Vector calc_residuals(const Instance& instance, const Vector& x) {
  switch (instance.function) {
    case 1:
    case 2:
    case 3:
      return calc_linear(instance.function, x, instance.m);
    case 4:
      return {10 * (x[1] - square(x[0])), 1 - x[0]};
    case 5:
      return calc_helical_valley(x);
    case 6:
      return {x[0] + 10 * x[1], std::sqrt(5.0) * (x[2] - x[3]), square(x[1] - 2 * x[2]),
              std::sqrt(10.0) * square(x[0] - x[3])};
    case 7:
      return {-13 + x[0] + ((5 - x[1]) * x[1] - 2) * x[1],
              -29 + x[0] + ((1 + x[1]) * x[1] - 14) * x[1]};
    case 8:
      return calc_bard(x);
    case 9:
      return calc_kowalik_osborne(x);
    case 10:
      return calc_meyer(x);
    case 11:
      return calc_watson(x);
    case 12:
    case 13:
    case 14:
      return calc_exponentials(instance.function, x, instance.m);
    case 15:
      return calc_chebyquad(x, instance.m);
    case 16:
      return calc_brown_almost_linear(x);
    case 17:
      return calc_osborne_1(x);
    case 18:
      return calc_osborne_2(x);
    case 19:
      return calc_bdqrtic(x);
    case 20:
      return calc_cube(x);
    case 21:
      return calc_mancino(x);
    default:
      return calc_heart(x);
  }
}

inline Vector make_standard_start(const Instance& instance) {
  const std::size_t n = instance.n;
  switch (instance.function) {
    case 1:
    case 2:
    case 3:
    case 19:
      return Vector(n, 1.0);
    case 4:
      return {-1.2, 1};
    case 5:
      return {-1, 0, 0};
    case 6:
      return {3, -1, 0, 1};
    case 7:
      return {0.5, -2};
    case 8:
      return {1, 1, 1};
    case 9:
      return {0.25, 0.39, 0.415, 0.39};
    case 10:
      return {0.02, 4000, 250};
    case 12:
      return {0, 10, 20};
    case 13:
      return {0.3, 0.4};
    case 14:
      return {25, 5, -5, -1};
    case 17:
      return {0.5, 1.5, 1, 0.01, 0.02};
    case 18:
      return {1.3, 0.65, 0.65, 0.7, 0.6, 3, 5, 7, 2, 4.5, 5.5};
    case 22:
      return {-0.3, -0.39, 0.3, -0.344, -1.2, 2.69, 1.59, -1.5};
    default:
      break;
  }
  Vector start(n, 0.5);
  for (std::size_t i = 1; i <= n; ++i) {
    const double k = static_cast<double>(i);
    if (instance.function == 15) {
      start[i - 1] = k / static_cast<double>(n + 1);
    } else if (instance.function == 21) {
      start[i - 1] = -8.710996e-4 * (std::pow(k - 50, 3) + calc_mancino_sum(0, i, n));
    }
  }
  return start;
}

inline Vector make_start(const Instance& instance) {
  Vector start = make_standard_start(instance);
  for (double& value : start) {
    value *= instance.is_far ? 10 : 1;
  }
  return start;
}

inline double calc_square_sum(const Vector& residuals) {
  double sum = 0;
  for (const double residual : residuals) {
    sum += residual * residual;
  }
  return sum;
}

}  // namespace armwright::more_wild
