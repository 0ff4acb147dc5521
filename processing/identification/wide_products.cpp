#include "processing/identification/wide_products.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "processing/base/wide.hpp"

namespace kolsky {

namespace {

constexpr Eigen::Index kEight = 8;
constexpr Eigen::Index kAtOnce = 4;

/// Four doubles anywhere in memory: one register, or several of what the machine has.
using Four = double __attribute__((vector_size(32), aligned(8), may_alias));

/// Eight rows of `columns` after each other, column by column; what is beyond the last row is 0.
std::vector<double> panels_of(const Eigen::MatrixXd& columns) {
  const Eigen::Index panels = (columns.rows() + kEight - 1) / kEight;
  std::vector<double> packed(static_cast<std::size_t>(panels * kEight * columns.cols()));
  for (Eigen::Index e = 0; e < columns.cols(); ++e) {
    for (Eigen::Index i = 0; i < columns.rows(); ++i) {
      packed[static_cast<std::size_t>((i / kEight * columns.cols() + e) * kEight + i % kEight)] =
          columns(i, e);
    }
  }
  return packed;
}

/// Products of eight rows with each of four others, over all columns.
KOLSKY_WIDE void multiply(const double* rows, const double* others, Eigen::Index columns,
                          double* products) {
  Four upper0{}, upper1{}, upper2{}, upper3{};
  Four lower0{}, lower1{}, lower2{}, lower3{};
  for (Eigen::Index e = 0; e < columns; ++e) {
    const auto* const row = reinterpret_cast<const Four*>(rows + kEight * e);
    const double* const other = others + kEight * e;
    upper0 += row[0] * other[0];
    lower0 += row[1] * other[0];
    upper1 += row[0] * other[1];
    lower1 += row[1] * other[1];
    upper2 += row[0] * other[2];
    lower2 += row[1] * other[2];
    upper3 += row[0] * other[3];
    lower3 += row[1] * other[3];
  }
  auto* const out = reinterpret_cast<Four*>(products);
  out[0] = upper0;
  out[1] = lower0;
  out[2] = upper1;
  out[3] = lower1;
  out[4] = upper2;
  out[5] = lower2;
  out[6] = upper3;
  out[7] = lower3;
}

/// Solves for eight columns, given and returned row by row.
KOLSKY_WIDE void solve(const double* lower, Eigen::Index size, double* columns) {
  auto* const x = reinterpret_cast<Four*>(columns);
  for (Eigen::Index i = 0; i < size; ++i) {
    const double* const row = lower + i * size;
    // Of even and odd places, so that no sum waits for the one before it.
    Four left0{}, left1{}, right0{}, right1{};
    Eigen::Index k = 0;
    for (; k + 1 < i; k += 2) {
      left0 += x[2 * k] * row[k];
      right0 += x[2 * k + 1] * row[k];
      left1 += x[2 * k + 2] * row[k + 1];
      right1 += x[2 * k + 3] * row[k + 1];
    }
    if (k < i) {
      left0 += x[2 * k] * row[k];
      right0 += x[2 * k + 1] * row[k];
    }
    x[2 * i] = (x[2 * i] - (left0 + left1)) / row[i];
    x[2 * i + 1] = (x[2 * i + 1] - (right0 + right1)) / row[i];
  }
}

}  // namespace

void add_square(const Eigen::MatrixXd& columns, Eigen::MatrixXd& lower) {
  const std::vector<double> packed = panels_of(columns);
  const Eigen::Index rows = columns.rows();
  const Eigen::Index panel = kEight * columns.cols();
  std::array<double, kAtOnce * kEight> products;
  for (Eigen::Index j = 0; j < rows; j += kAtOnce) {
    for (Eigen::Index i = j / kEight * kEight; i < rows; i += kEight) {
      multiply(packed.data() + i / kEight * panel, packed.data() + j / kEight * panel + j % kEight,
               columns.cols(), products.data());
      for (Eigen::Index b = 0; b < std::min(kAtOnce, rows - j); ++b) {
        for (Eigen::Index a = std::max<Eigen::Index>(0, j + b - i); a < std::min(kEight, rows - i);
             ++a) {
          lower(i + a, j + b) += products[static_cast<std::size_t>(b * kEight + a)];
        }
      }
    }
  }
}

LowerTriangle::LowerTriangle(const Eigen::MatrixXd& lower) : rows_(lower) {}

void LowerTriangle::solve_in_place(Eigen::Ref<Eigen::MatrixXd> columns) const {
  Eigen::Matrix<double, Eigen::Dynamic, kEight, Eigen::RowMajor> eight(rows_.rows(), kEight);
  for (Eigen::Index first = 0; first < columns.cols(); first += kEight) {
    const Eigen::Index count = std::min(kEight, columns.cols() - first);
    eight.setZero();
    eight.leftCols(count) = columns.middleCols(first, count);
    solve(rows_.data(), rows_.rows(), eight.data());
    columns.middleCols(first, count) = eight.leftCols(count);
  }
}

}  // namespace kolsky
