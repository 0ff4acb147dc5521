#pragma once

namespace kolsky {

// struct Channel { is no type where it is said in a comment or "struct Bar {" in a text.
constexpr const char* kText = "struct Channel {";

enum class Bridge { quarter, half };

class Gauge final {
 public:
  struct Channel {};

 private:
  double position_m_ = 0.0;
};

namespace {
struct Channel {};
}  // namespace

}  // namespace kolsky
