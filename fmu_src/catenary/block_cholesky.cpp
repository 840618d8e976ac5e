#include "block_cholesky.hpp"

#include <Eigen/Cholesky>

#include "common/failure.hpp"

namespace zspring::catenary {
namespace {

using Eigen::Matrix4d;

Matrix4d block(const SparseMatrix& m, Eigen::Index row, Eigen::Index column) {
  Matrix4d b = Matrix4d::Zero();
  for (int i = 0; i < 4; ++i)
    for (SparseMatrix::InnerIterator it(m, 4 * row + i); it; ++it)
      if (it.col() / 4 == column) b(i, it.col() % 4) = it.value();
  return b;
}

FactorBlock stored(const Matrix4d& m) {
  FactorBlock b;
  Eigen::Map<Matrix4d>(b.column[0]) = m;
  return b;
}

}  // namespace

BlockCholesky::BlockCholesky(const SparseMatrix& matrix) {
  const Eigen::Index n = matrix.rows() / 4;
  Matrix4d inverse;
  for (Eigen::Index i = 0; i < n; ++i) {
    Matrix4d diagonal = block(matrix, i, i), forward = Matrix4d::Zero();
    if (i > 0) {
      const Matrix4d below = block(matrix, i, i - 1);
      forward = below * inverse;
      diagonal -= forward * below.transpose();
      backward_.push_back(stored(forward.transpose()));
    }
    const Eigen::LLT<Matrix4d> factor(diagonal);
    if (factor.info() != Eigen::Success || !diagonal.allFinite())
      refuse(
          "the line's matrices are not positive definite to rounding: its masses, tensions, stiffnesses "
          "and lengths must be of less different orders of magnitude");
    inverse = factor.solve(Matrix4d::Identity());
    inverse = (0.5 * (inverse + inverse.transpose())).eval();
    inverse_.push_back(stored(inverse));
    forward_.push_back(stored(forward));
  }
  backward_.push_back(stored(Matrix4d::Zero()));
}

}  // namespace zspring::catenary
