// Vectors of the pantograph, of a few numbers each.
#pragma once

// Written one by one and read two at once, numbers must first reach the memory: with vector instructions a step takes
// half as long again (measured in pairs of runs).
#define EIGEN_DONT_VECTORIZE
#include <Eigen/Core>

namespace zspring {

using Vector2 = Eigen::Matrix<double, 2, 1>;
using Vector4 = Eigen::Matrix<double, 4, 1>;
using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix4 = Eigen::Matrix<double, 4, 4>;

}  // namespace zspring
