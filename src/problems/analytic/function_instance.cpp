#include "problems/analytic/function_instance.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "base/random.hpp"

namespace armwright {
namespace {

// As in BBOB: the minimiser keeps a distance of 1 from the bounds.
constexpr double kLargestShift = 4;

double calc_plain_shift(std::size_t index) {
  const double multiple = static_cast<double>(index + 1) * (std::numbers::phi - 1);
  return 4 * (multiple - std::floor(multiple) - 0.5);
}

// Returns a number that is close to standard normal: the sum of 12 uniform numbers has the variance
// 1. Unlike RandomStream::normal() it needs no logarithm, whose last bit depends on the machine.
double draw_nearly_normal(RandomStream& random) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) {
    sum += random.uniform();
  }
  return sum;
}

// A random orthogonal matrix as a product of n reflections I - c v v^T, of which reflection k
// changes the coordinates k..n-1 only. Each v = g - |g| e_1 of a random g: its reflection turns the
// first axis into the direction of g. (Stewart 1980, The efficient generation of random orthogonal
// matrices with an application to condition estimators.)
class Rotation {
 public:
  Rotation(std::size_t dimension, RandomStream& random) {
    vectors_.reserve(dimension * (dimension + 1) / 2);
    for (std::size_t length = dimension; length > 0; --length) {
      const std::size_t first = vectors_.size();
      double square = 0;
      for (std::size_t i = 0; i < length; ++i) {
        vectors_.push_back(draw_nearly_normal(random));
        square += vectors_.back() * vectors_.back();
      }
      vectors_[first] -= std::sqrt(square);
      square = 0;
      for (std::size_t i = first; i < vectors_.size(); ++i) {
        square += vectors_[i] * vectors_[i];
      }
      factors_.push_back(square > 0 ? 2 / square : 0);  // 0 if g has the direction of the axis
    }
  }

  void turn(std::span<double> z) const {
    auto vector = vectors_.begin();
    for (std::size_t k = 0; k < z.size(); ++k) {
      const auto part = z.subspan(k);
      double product = 0;
      for (std::size_t i = 0; i < part.size(); ++i) {
        product += vector[static_cast<std::ptrdiff_t>(i)] * part[i];
      }
      product *= factors_[k];
      for (double& zi : part) {
        zi -= product * *vector++;
      }
    }
  }

 private:
  std::vector<double> vectors_;  // n numbers of the first reflection, then n - 1, ..., then 1
  std::vector<double> factors_;  // c, one per reflection
};

void subtract(std::span<const double> x, std::span<const double> shift, std::span<double> z) {
  for (std::size_t i = 0; i < z.size(); ++i) {
    z[i] = x[i] - shift[i];
  }
}

}  // namespace

FunctionInstance make_plain_instance(const AnalyticFunction& function, std::size_t dimension) {
  FunctionInstance instance;
  const bool is_shifted = function.minimiser.empty();
  std::vector<double> shift(dimension);
  const std::size_t first_integer = dimension - count_integers(function, dimension);
  for (std::size_t i = 0; i < dimension && is_shifted; ++i) {
    const double s = calc_plain_shift(i);
    shift[i] = i < first_integer ? s : std::copysign(std::ceil(std::abs(s)), s);
  }
  instance.minimiser = is_shifted ? shift : function.minimiser;
  instance.minimiser.resize(dimension, instance.minimiser.back());
  instance.calc_z = [shift = std::move(shift)](std::span<const double> x, std::span<double> z) {
    subtract(x, shift, z);
  };
  return instance;
}

FunctionInstance make_random_instance(const AnalyticFunction& function, std::size_t dimension,
                                      int number) {
  RandomStream random(fmt::format("function/{}/{}", function.name, dimension),
                      static_cast<std::uint64_t>(number));
  FunctionInstance instance;
  const std::size_t first_integer = dimension - count_integers(function, dimension);
  for (std::size_t i = 0; i < dimension; ++i) {
    const double s = random.uniform(-kLargestShift, kLargestShift);
    instance.minimiser.push_back(i < first_integer ? s : std::floor(s + 0.5));
  }
  if (function.is_rotated) {
    instance.calc_z = [shift = instance.minimiser, rotation = Rotation(dimension, random)](
                          std::span<const double> x, std::span<double> z) {
      subtract(x, shift, z);
      rotation.turn(z);
    };
  } else {
    instance.calc_z = [shift = instance.minimiser](std::span<const double> x, std::span<double> z) {
      subtract(x, shift, z);
    };
  }
  return instance;
}

}  // namespace armwright
