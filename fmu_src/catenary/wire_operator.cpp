#include "wire_operator.hpp"

namespace zspring::catenary {

WireOperator::WireOperator(const SparseMatrix& matrix) : rows_(static_cast<size_t>(matrix.rows() / 4)) {
  for (Eigen::Index row = 0; row < matrix.rows(); ++row)
    for (SparseMatrix::InnerIterator it(matrix, row); it; ++it) {
      const Eigen::Index ahead = it.col() / 4 - row / 4;  // in stations
      StationRow& of = rows_[row / 4];
      StationRow::Block& block = ahead == 0 ? of.here : ahead > 0 ? of.after : of.before;
      double* part = it.col() % 2 == row % 2 ? block.straight : block.crossed;
      part[row % 4] = it.value();
    }
}

}  // namespace zspring::catenary
