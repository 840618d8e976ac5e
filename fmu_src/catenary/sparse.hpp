// Vectors and matrices of the whole line.
#pragma once

#include <Eigen/SparseCore>

namespace zspring::catenary {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

}  // namespace zspring::catenary
