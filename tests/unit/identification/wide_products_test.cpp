#include "processing/identification/wide_products.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>

namespace kolsky {
namespace {

EightColumns in_eights(const Eigen::MatrixXd& matrix) {
  EightColumns columns(matrix.rows(), matrix.cols());
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
      columns(i, j) = matrix(i, j);
    }
  }
  return columns;
}

Eigen::MatrixXd plain(const EightColumns& columns, Eigen::Index count) {
  Eigen::MatrixXd matrix(columns.rows(), count);
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    for (Eigen::Index j = 0; j < count; ++j) {
      matrix(i, j) = columns(i, j);
    }
  }
  return matrix;
}

TEST(WideProducts, SquaresAddToTheLowerTriangleOfAnySize) {
  for (const Eigen::Index count : {1, 4, 7, 8, 9, 22}) {
    const Eigen::MatrixXd columns = Eigen::MatrixXd::Random(13, count);
    const Eigen::MatrixXd before = Eigen::MatrixXd::Random(count, count);
    Eigen::MatrixXd sum = before;
    add_square(in_eights(columns), sum);
    const Eigen::MatrixXd whole = before + columns.transpose() * columns;
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = 0; j < count; ++j) {
        EXPECT_NEAR(sum(i, j), j <= i ? whole(i, j) : before(i, j), 1e-14) << count;
      }
    }
  }
}

TEST(WideProducts, SquareOfColumnsIsWholeAndZeroBeyondThem) {
  for (const Eigen::Index count : {1, 8, 11, 17}) {
    const Eigen::MatrixXd columns = Eigen::MatrixXd::Random(13, count);
    Eigen::MatrixXd square = square_of(in_eights(columns));
    square.topLeftCorner(count, count) -= columns.transpose() * columns;
    EXPECT_LT(square.cwiseAbs().maxCoeff(), 1e-14) << count;
  }
}

TEST(WideProducts, ATriangleIsSolvedForAnyNumberOfColumnsAndRowsBeyondItStay) {
  constexpr Eigen::Index kBeyond = 3;
  for (const Eigen::Index size : {1, 2, 5, 16}) {
    Eigen::MatrixXd factor = Eigen::MatrixXd::Random(size, size);
    factor.diagonal().array() += 3.0;  // what lies above the diagonal must not matter
    for (const Eigen::Index count : {1, 8, 11}) {
      const Eigen::MatrixXd right = Eigen::MatrixXd::Random(size + kBeyond, count);
      EightColumns columns = in_eights(right);
      LowerTriangle(factor).solve_in_place(columns);
      Eigen::MatrixXd back = plain(columns, count);
      back.topRows(size) = (factor.triangularView<Eigen::Lower>() * back.topRows(size)).eval();
      EXPECT_LT((back - right).cwiseAbs().maxCoeff(), 1e-14) << size << " " << count;
    }
  }
}

TEST(WideProducts, StretchesOfRowsAreMultipliedEachByItsComplexTriangle) {
  constexpr Eigen::Index kFirst = 2;
  for (const Eigen::Index size : {1, 3}) {
    const Eigen::MatrixXd given = Eigen::MatrixXd::Random(kFirst + 2 * (2 * size), 9);
    Eigen::MatrixXd expected = given;
    std::vector<Complex> triangles;
    for (Eigen::Index stretch = 0; stretch < 2; ++stretch) {
      const Eigen::MatrixXcd triangle =
          Eigen::MatrixXcd::Random(size, size).triangularView<Eigen::Lower>();
      for (Eigen::Index i = 0; i < size; ++i) {
        for (Eigen::Index j = 0; j <= i; ++j) {
          triangles.push_back(triangle(i, j));
        }
      }
      const Eigen::Index row = kFirst + 2 * size * stretch;
      const Eigen::MatrixXcd numbers =
          given.middleRows(row, size) + Complex(0.0, 1.0) * given.middleRows(row + size, size);
      const Eigen::MatrixXcd product = triangle * numbers;
      expected.middleRows(row, size) = product.real();
      expected.middleRows(row + size, size) = product.imag();
    }
    EightColumns columns = in_eights(given);
    multiply_in_place(triangles, size, kFirst, columns);
    EXPECT_LT((plain(columns, 9) - expected).cwiseAbs().maxCoeff(), 1e-14) << size;
  }
}

}  // namespace
}  // namespace kolsky
