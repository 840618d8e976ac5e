// Vectors and matrices of the whole line.
#pragma once

// clang-format off: the first tells the second what to be
#include "common/eigen.hpp"
#include <Eigen/SparseCore>
// clang-format on

namespace zspring::catenary {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

}  // namespace zspring::catenary
