#include "block_cholesky.hpp"

#include <Eigen/Cholesky>

#include "common/failure.hpp"

namespace zspring::catenary {
namespace {

Eigen::Matrix4d block(const SparseMatrix& m, Eigen::Index row, Eigen::Index column) {
  Eigen::Matrix4d b = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 4; ++i)
    for (SparseMatrix::InnerIterator it(m, 4 * row + i); it; ++it)
      if (it.col() / 4 == column) b(i, it.col() % 4) = it.value();
  return b;
}

}  // namespace

BlockCholesky::BlockCholesky(const SparseMatrix& matrix) : blocks_(static_cast<size_t>(matrix.rows() / 4)) {
  const auto n = static_cast<Eigen::Index>(blocks_.size());
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::Matrix4d diagonal = block(matrix, i, i), below = Eigen::Matrix4d::Zero();
    if (i > 0) {
      below = block(matrix, i, i - 1) * blocks_[i - 1].inverse.transpose();
      diagonal -= below * below.transpose();
    }
    const Eigen::LLT<Eigen::Matrix4d> factor(diagonal);
    if (factor.info() != Eigen::Success || !diagonal.allFinite())
      refuse(
          "the line's matrices are not positive definite to rounding: its masses, tensions, stiffnesses "
          "and lengths must be of less different orders of magnitude");
    blocks_[i].inverse = factor.matrixL().solve(Eigen::Matrix4d::Identity());
    blocks_[i].forward = blocks_[i].inverse * below;
    blocks_[i].backward.setZero();
    if (i > 0) blocks_[i - 1].backward = blocks_[i - 1].inverse.transpose() * below.transpose();
  }
}

void BlockCholesky::solve(VectorXd& x) const {
  const auto n = static_cast<Eigen::Index>(blocks_.size());
  Eigen::Vector4d last = Eigen::Vector4d::Zero();
  for (Eigen::Index i = 0; i < n; ++i) {
    auto here = x.segment<4>(4 * i);
    last = blocks_[i].inverse * Eigen::Vector4d(here) - blocks_[i].forward * last;
    here = last;
  }
  last.setZero();
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    auto here = x.segment<4>(4 * i);
    last = blocks_[i].inverse.transpose() * Eigen::Vector4d(here) - blocks_[i].backward * last;
    here = last;
  }
}

}  // namespace zspring::catenary
