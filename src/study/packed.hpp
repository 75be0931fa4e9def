#pragma once
// Structs as rows of numbers, which ranks send each other and checkpoints hold.

#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "whirl/core/error.hpp"
#include "whirl/io/record.hpp"

namespace whirl::study {

template <class Archive, class T>
void show(Archive& archive, T& x) {
  if constexpr (requires { x.members(archive); })
    x.members(archive);
  else
    members(archive, x);
}

/// Puts what it is shown at the end of a row; RowReader takes it from there. A struct shows its members to both by one
/// function, so that their order is written once:
///
///     void members(auto& archive) { archive(values, rounding); }
///
/// or, of a struct of another room, members(archive, x) beside it. Members are numbers, enums, texts, complex numbers,
/// arrays, vectors, matrices, pairs, optionals, and structs that have such a function.
class RowWriter {
public:
  void operator()(const auto&... all) { (put(all), ...); }
  std::vector<double> row;

private:
  template <class T>
  void put(const T& x) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      row.push_back(static_cast<double>(x));
    else
      show(*this, const_cast<T&>(x));  // reading alone changes it
  }
  void put(const std::complex<double>& z) { (*this)(z.real(), z.imag()); }
  void put(const std::string& text) { put(std::vector<char>(text.begin(), text.end())); }
  template <class T>
  void put(const std::vector<T>& all) {
    put(all.size());
    for (const T& x : all) put(x);
  }
  template <int rows, int columns>
  void put(const Eigen::Matrix<double, rows, columns>& m) {
    (*this)(m.rows(), m.cols());
    row.insert(row.end(), m.data(), m.data() + m.size());
  }
  template <class T, std::size_t n>
  void put(const std::array<T, n>& all) {
    for (const T& x : all) put(x);
  }
  template <class A, class B>
  void put(const std::pair<A, B>& both) {
    (*this)(both.first, both.second);
  }
  template <class T>
  void put(const std::optional<T>& x) {
    put(x.has_value());
    if (x) put(*x);
  }
};

class RowReader {
public:
  explicit RowReader(const std::vector<double>& row) : at_(row.begin()), end_(row.end()) {}
  void operator()(auto&... all) { (take(all), ...); }
  [[nodiscard]] bool at_end() const { return at_ == end_; }

private:
  template <class T>
  void take(T& x) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
      core::require(!at_end(), "a row has fewer numbers than what is read from it");
      x = static_cast<T>(*at_++);
    } else {
      show(*this, x);
    }
  }
  void take(std::complex<double>& z) {
    double re = 0, im = 0;
    (*this)(re, im);
    z = {re, im};
  }
  void take(std::string& text) {
    std::vector<char> letters;
    take(letters);
    text.assign(letters.begin(), letters.end());
  }
  template <class T>
  void take(std::vector<T>& all) {
    std::size_t n = 0;
    take(n);
    all.resize(n);
    for (T& x : all) take(x);
  }
  template <int rows, int columns>
  void take(Eigen::Matrix<double, rows, columns>& m) {
    Eigen::Index down = 0, across = 0;
    (*this)(down, across);
    m.resize(down, across);
    for (Eigen::Index k = 0; k < m.size(); ++k) take(m.data()[k]);
  }
  template <class T, std::size_t n>
  void take(std::array<T, n>& all) {
    for (T& x : all) take(x);
  }
  template <class A, class B>
  void take(std::pair<A, B>& both) {
    (*this)(both.first, both.second);
  }
  template <class T>
  void take(std::optional<T>& x) {
    bool any = false;
    take(any);
    x.reset();
    if (any) take(x.emplace());
  }

  std::vector<double>::const_iterator at_, end_;
};

template <class T>
[[nodiscard]] std::vector<double> pack(const T& x) {
  RowWriter out;
  out(x);
  return std::move(out.row);
}

/// What pack() made, by the same program.
template <class T>
void unpack(const std::vector<double>& row, T& x) {
  RowReader in(row);
  in(x);
  core::require(in.at_end(), "a row has more numbers than what is read from it");
}
template <class T>
[[nodiscard]] T unpack(const std::vector<double>& row) {
  T x{};
  unpack(row, x);
  return x;
}

template <class T>
void put_packed(io::Group& group, const std::string& name, const T& x, const std::string& description) {
  group.put(name, pack(x), "1", description + ", its members one after another");
}
template <class T>
[[nodiscard]] T take_packed(const io::Group& group, const std::string& name) {
  return unpack<T>(group.reals(name));
}

}  // namespace whirl::study
