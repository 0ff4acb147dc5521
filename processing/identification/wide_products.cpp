#include "processing/identification/wide_products.hpp"

#include <algorithm>
#include <array>

#include "processing/base/wide.hpp"

namespace kolsky {

namespace {

constexpr Eigen::Index kEight = EightColumns::kEight;

/// Four doubles anywhere in memory: one register, or several of what the machine has.
using Four = double __attribute__((vector_size(32), aligned(8), may_alias));

/// Products of eight columns with each of four others, over all rows.
KOLSKY_WIDE void multiply(const double* columns, const double* others, Eigen::Index rows,
                          double* products) {
  Four upper0{}, upper1{}, upper2{}, upper3{};
  Four lower0{}, lower1{}, lower2{}, lower3{};
  for (Eigen::Index e = 0; e < rows; ++e) {
    const auto* const own = reinterpret_cast<const Four*>(columns + kEight * e);
    const double* const other = others + kEight * e;
    upper0 += own[0] * other[0];
    lower0 += own[1] * other[0];
    upper1 += own[0] * other[1];
    lower1 += own[1] * other[1];
    upper2 += own[0] * other[2];
    lower2 += own[1] * other[2];
    upper3 += own[0] * other[3];
    lower3 += own[1] * other[3];
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

/// Solves for eight columns.
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

/// @param parts  real and imaginary parts of a triangle, row by row
KOLSKY_WIDE void multiply_one(const double* parts, Eigen::Index size, double* columns) {
  for (Eigen::Index half = 0; half < 2; ++half) {
    Four* const re = reinterpret_cast<Four*>(columns) + half;
    Four* const im = re + 2 * size;
    // From the last row up: a row needs those above it as they were.
    for (Eigen::Index j = size; j-- > 0;) {
      const double* const row = parts + j * (j + 1);
      Four sum_re{}, sum_im{};
      for (Eigen::Index l = 0; l <= j; ++l) {
        sum_re += re[2 * l] * row[2 * l] - im[2 * l] * row[2 * l + 1];
        sum_im += re[2 * l] * row[2 * l + 1] + im[2 * l] * row[2 * l];
      }
      re[2 * j] = sum_re;
      im[2 * j] = sum_im;
    }
  }
}

/// Puts products of all columns with all from the one that is meant on, eight by four.
template <typename Put>
void square(const EightColumns& columns, const Put& put) {
  constexpr Eigen::Index kAtOnce = 4;
  std::array<double, kAtOnce * kEight> products;
  for (Eigen::Index q = 0; q < columns.panels(); ++q) {
    for (Eigen::Index half = 0; half < kEight; half += kAtOnce) {
      for (Eigen::Index p = q; p < columns.panels(); ++p) {
        multiply(columns.panel(p), columns.panel(q) + half, columns.rows(), products.data());
        for (Eigen::Index b = 0; b < kAtOnce; ++b) {
          for (Eigen::Index a = 0; a < kEight; ++a) {
            put(p * kEight + a, q * kEight + half + b,
                products[static_cast<std::size_t>(b * kEight + a)]);
          }
        }
      }
    }
  }
}

}  // namespace

EightColumns::EightColumns(Eigen::Index rows, Eigen::Index columns)
    : rows_(rows),
      panels_((columns + kEight - 1) / kEight),
      numbers_(static_cast<std::size_t>(rows_ * panels_ * kEight)) {}

Eigen::MatrixXd square_of(const EightColumns& columns) {
  Eigen::MatrixXd all(columns.panels() * kEight, columns.panels() * kEight);
  square(columns,
         [&](Eigen::Index a, Eigen::Index b, double product) { all(a, b) = all(b, a) = product; });
  return all;
}

void add_square(const EightColumns& columns, Eigen::MatrixXd& lower) {
  square(columns, [&](Eigen::Index a, Eigen::Index b, double product) {
    if (a >= b && a < lower.rows()) {
      lower(a, b) += product;
    }
  });
}

LowerTriangle::LowerTriangle(const Eigen::MatrixXd& lower) : rows_(lower) {}

void LowerTriangle::solve_in_place(EightColumns& columns) const {
  for (Eigen::Index p = 0; p < columns.panels(); ++p) {
    solve(rows_.data(), rows_.rows(), columns.panel(p));
  }
}

void LowerTriangle::solve_transposed_in_place(Eigen::Ref<Eigen::MatrixXd> columns) const {
  rows_.triangularView<Eigen::Lower>().transpose().solveInPlace(columns.topRows(rows_.rows()));
}

void multiply_in_place(std::span<const Complex> triangles, Eigen::Index size, Eigen::Index first,
                       EightColumns& columns) {
  const auto entries = static_cast<std::size_t>(size * (size + 1) / 2);
  // Complex numbers are laid out as pairs of real ones.
  const auto* const parts = reinterpret_cast<const double*>(triangles.data());
  for (Eigen::Index p = 0; p < columns.panels(); ++p) {
    Eigen::Index row = first;
    for (std::size_t at = 0; at < triangles.size(); at += entries) {
      multiply_one(parts + 2 * at, size, columns.panel(p) + kEight * row);
      row += 2 * size;
    }
  }
}

}  // namespace kolsky
