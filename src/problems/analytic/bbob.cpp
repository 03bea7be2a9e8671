#include "problems/analytic/bbob.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace armwright {
namespace {

using Numbers = std::vector<double>;

// Draws uniform numbers in (0, 1) as the reference code does: with the minimal standard generator
// (Park and Miller 1988), shuffled through a table of 32 numbers (Bays and Durham 1976).
Numbers draw_uniform(std::size_t count, std::int64_t seed) {
  constexpr std::int64_t kModulus = 2147483647;  // 2^31 - 1
  constexpr std::int64_t kMultiplier = 16807;
  constexpr std::int64_t kSlotWidth = 67108865;  // 2^26 + 1: the slots are 0 to 31
  constexpr int kDiscarded = 8;
  assert(seed > 0 && seed < kModulus);
  std::int64_t state = seed;
  const auto step = [&state] { return state = kMultiplier * state % kModulus; };
  for (int i = 0; i < kDiscarded; ++i) {
    step();
  }
  std::array<std::int64_t, 32> table{};
  for (auto slot = table.rbegin(); slot != table.rend(); ++slot) {
    *slot = step();
  }
  Numbers numbers;
  std::int64_t last = table[0];
  for (std::size_t i = 0; i < count; ++i) {
    std::int64_t& slot = table[static_cast<std::size_t>(last / kSlotWidth)];
    last = std::exchange(slot, step());
    numbers.push_back(static_cast<double>(last) / static_cast<double>(kModulus));
  }
  return numbers;
}

// Draws normal numbers with the method of Box and Muller: the first `count` uniform numbers give
// the radii, the others the angles.
Numbers draw_normal(std::size_t count, std::int64_t seed) {
  constexpr double kInPlaceOfZero = 1e-99;
  const Numbers uniform = draw_uniform(2 * count, seed);
  Numbers numbers;
  for (std::size_t i = 0; i < count; ++i) {
    const double number =
        std::sqrt(-2 * std::log(uniform[i])) * std::cos(2 * std::numbers::pi * uniform[count + i]);
    numbers.push_back(number == 0 ? kInPlaceOfZero : number);
  }
  return numbers;
}

Numbers draw_x_opt(std::size_t dimension, std::int64_t seed) {
  constexpr double kInPlaceOfZero = -1e-5;
  Numbers x_opt = draw_uniform(dimension, seed);
  for (double& xi : x_opt) {
    xi = 8 * std::floor(1e4 * xi) / 1e4 - 4;
    xi = xi == 0 ? kInPlaceOfZero : xi;
  }
  return x_opt;
}

// Draws the quotient of two normal numbers, which has a Cauchy distribution, with two decimals.
double draw_f_opt(std::int64_t seed) {
  const double quotient = 1e4 * draw_normal(1, seed)[0] / draw_normal(1, seed + 1)[0];
  return std::clamp(std::floor(quotient + 0.5) / 100, -1000.0, 1000.0);
}

// A random orthogonal matrix: normal numbers, column by column, made orthonormal by the modified
// method of Gram and Schmidt.
class Matrix {
 public:
  Matrix(std::size_t dimension, std::int64_t seed)
      : columns_(draw_normal(dimension * dimension, seed)) {
    for (std::size_t j = 0; j < dimension; ++j) {
      const auto own = get_column(j, dimension);
      for (std::size_t earlier = 0; earlier < j; ++earlier) {
        const auto other = get_column(earlier, dimension);
        const double product = calc_product(own, other);
        for (std::size_t i = 0; i < dimension; ++i) {
          own[i] -= product * other[i];
        }
      }
      const double norm = std::sqrt(calc_product(own, own));
      for (double& number : own) {
        number /= norm;
      }
    }
  }

  Numbers multiply(std::span<const double> x) const {
    Numbers y(x.size());
    for (std::size_t j = 0; j < x.size(); ++j) {
      for (std::size_t i = 0; i < x.size(); ++i) {
        y[i] += columns_[j * x.size() + i] * x[j];
      }
    }
    return y;
  }

 private:
  std::span<double> get_column(std::size_t j, std::size_t dimension) {
    return std::span(columns_).subspan(j * dimension, dimension);
  }
  static double calc_product(std::span<const double> a, std::span<const double> b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      sum += a[i] * b[i];
    }
    return sum;
  }

  Numbers columns_;  // column-major
};

// Returns (i-1)/(n-1) of the coordinate with the index i-1.
double calc_fraction(std::size_t index, std::size_t dimension) {
  return static_cast<double>(index) / static_cast<double>(dimension - 1);
}

// T_osz: makes the function uneven without a change of its order of magnitude.
void oscillate(std::span<double> z) {
  for (double& zi : z) {
    if (zi != 0) {
      const double log = std::log(std::abs(zi));
      const double first = zi > 0 ? 10 : 5.5;
      const double second = zi > 0 ? 7.9 : 3.1;
      const double size = std::exp(log + 0.049 * (std::sin(first * log) + std::sin(second * log)));
      zi = std::copysign(size, zi);
    }
  }
}

// T_asy with beta = 0.2: stretches the positive half of each axis.
void skew(std::span<double> z) {
  constexpr double kBeta = 0.2;
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (z[i] > 0) {
      z[i] = std::pow(z[i], 1 + kBeta * calc_fraction(i, z.size()) * std::sqrt(z[i]));
    }
  }
}

// L, with the condition number sqrt(10).
void stretch(std::span<double> z) {
  for (std::size_t i = 0; i < z.size(); ++i) {
    z[i] *= std::pow(10, calc_fraction(i, z.size()) / 2);
  }
}

}  // namespace

FunctionInstance make_bbob_instance(int function, std::size_t dimension, int number) {
  const std::int64_t seed = function + std::int64_t{10000} * number;
  constexpr std::int64_t kSeedOfR = 1000000;  // is added to the seed; Q has the seed itself
  FunctionInstance instance;
  instance.f_opt = draw_f_opt(seed);
  instance.minimiser = draw_x_opt(dimension, seed);
  if (function == 8) {
    for (double& xi : instance.minimiser) {
      xi *= 0.75;
    }
  }
  const auto subtract = [x_opt = instance.minimiser](std::span<const double> x,
                                                     std::span<double> z) {
    for (std::size_t i = 0; i < z.size(); ++i) {
      z[i] = x[i] - x_opt[i];
    }
  };
  switch (function) {
    case 1:
      instance.calc_z = subtract;
      break;
    case 2:
      instance.calc_z = [subtract](std::span<const double> x, std::span<double> z) {
        subtract(x, z);
        oscillate(z);
      };
      break;
    case 3:
      instance.calc_z = [subtract](std::span<const double> x, std::span<double> z) {
        subtract(x, z);
        oscillate(z);
        skew(z);
        stretch(z);
      };
      break;
    case 8:
      instance.calc_z = [subtract](std::span<const double> x, std::span<double> z) {
        subtract(x, z);
        const double factor = std::max(1.0, std::sqrt(static_cast<double>(z.size())) / 8);
        for (double& zi : z) {
          zi *= factor;
        }
      };
      break;
    case 10:
      instance.calc_z = [subtract, r = Matrix(dimension, seed + kSeedOfR)](
                            std::span<const double> x, std::span<double> z) {
        subtract(x, z);
        std::ranges::copy(r.multiply(z), z.begin());
        oscillate(z);
      };
      break;
    default:
      assert(function == 15);
      instance.calc_z = [subtract, r = Matrix(dimension, seed + kSeedOfR),
                         q = Matrix(dimension, seed)](std::span<const double> x,
                                                      std::span<double> z) {
        subtract(x, z);
        std::ranges::copy(r.multiply(z), z.begin());
        oscillate(z);
        skew(z);
        std::ranges::copy(q.multiply(z), z.begin());
        stretch(z);
        std::ranges::copy(r.multiply(z), z.begin());
      };
  }
  return instance;
}

}  // namespace armwright
