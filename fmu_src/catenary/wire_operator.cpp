#include "wire_operator.hpp"

namespace zspring::catenary {

WireOperator::WireOperator(const SparseMatrix& matrix) : nodes_(static_cast<size_t>(matrix.rows() / 2)) {
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (SparseMatrix::InnerIterator it(matrix, row); it; ++it) {
      const Eigen::Index ahead = it.col() / 2 - row / 2;  // in nodes; two are a station
      Node& node = nodes_[row / 2];
      Block& block = ahead == 0 ? node.here : ahead > 0 ? node.after : node.before;
      (it.col() % 2 == row % 2 ? block.straight : block.crossed)[row % 2] = it.value();
    }
}

void WireOperator::multiply(const VectorXd& x, VectorXd& y) const {
  const auto n = static_cast<Eigen::Index>(nodes_.size());
  const auto at = [&](Eigen::Index node) -> Eigen::Array2d { return x.segment<2>(2 * node).array(); };
  const auto ends = [&](Eigen::Index i) {
    Eigen::Array2d sum = nodes_[i].here.times(at(i));
    if (i >= 2) sum += nodes_[i].before.times(at(i - 2));
    if (i + 2 < n) sum += nodes_[i].after.times(at(i + 2));
    y.segment<2>(2 * i) = sum.matrix();
  };
  ends(0), ends(1);
  for (Eigen::Index i = 2; i < n - 2; ++i) {
    const Node& node = nodes_[i];
    const Eigen::Array2d sum = node.before.times(at(i - 2)) + node.here.times(at(i)) + node.after.times(at(i + 2));
    y.segment<2>(2 * i) = sum.matrix();
  }
  ends(n - 2), ends(n - 1);
}

}  // namespace zspring::catenary
