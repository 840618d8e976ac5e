// Vectors of the pantograph, of a few numbers each.
#pragma once

#include "common/eigen.hpp"

namespace zspring {

using Vector2 = Eigen::Matrix<double, 2, 1>;
using Vector4 = Eigen::Matrix<double, 4, 1>;
using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix4 = Eigen::Matrix<double, 4, 4>;

}  // namespace zspring
