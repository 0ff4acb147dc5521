#pragma once

namespace kolsky {

struct Bridge;

struct Gauge {
  double gain = 1.0;
};

namespace iio {
struct Channel {};
}  // namespace iio

}  // namespace kolsky
