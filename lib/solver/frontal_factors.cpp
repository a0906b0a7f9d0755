#include "lib/solver/frontal_factors.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "lib/execution/dispatch.hpp"

namespace apothem {

// A dense matrix, column by column.
struct DenseColumns {
  double* first;
  int height;
  [[nodiscard]] APOTHEM_INLINE double* at(int row, int column) const {
    return first + row + static_cast<std::ptrdiff_t>(column) * height;
  }
};

namespace {

// Columns of a front that are eliminated before the others follow.
constexpr int kPanel = 32;
// c(i, j) -= SUM over k of a(i, k) b(j, k), for `packs` packs of rows and `wide` columns.
template <int lanes, int packs, int wide>
APOTHEM_INLINE void subtract_tile(const DenseColumns& c, const DenseColumns& a,
                                  const DenseColumns& b, int i, int j, int depth) {
  using Real = PackOf<lanes>;
  Real sum[packs][wide];
  for (int p = 0; p < packs; ++p) {
    for (int w = 0; w < wide; ++w) sum[p][w] = Real::load(c.at(i + p * lanes, j + w));
  }
  for (int k = 0; k < depth; ++k) {
    Real rows[packs];
    for (int p = 0; p < packs; ++p) rows[p] = Real::load(a.at(i + p * lanes, k));
    for (int w = 0; w < wide; ++w) {
      const Real column(*b.at(j + w, k));
      for (int p = 0; p < packs; ++p) sum[p][w] = sum[p][w] - rows[p] * column;
    }
  }
  for (int p = 0; p < packs; ++p) {
    for (int w = 0; w < wide; ++w) sum[p][w].store(c.at(i + p * lanes, j + w));
  }
}

template <int lanes, int wide>
APOTHEM_INLINE void subtract_strip(const DenseColumns& c, const DenseColumns& a,
                                   const DenseColumns& b, int from, int end, int j, int depth) {
  int i = from;
  for (; i + 2 * lanes <= end; i += 2 * lanes) {
    subtract_tile<lanes, 2, wide>(c, a, b, i, j, depth);
  }
  for (; i + lanes <= end; i += lanes) subtract_tile<lanes, 1, wide>(c, a, b, i, j, depth);
  if constexpr (lanes > 4) {
    for (; i + 4 <= end; i += 4) subtract_tile<4, 1, wide>(c, a, b, i, j, depth);
  }
  for (; i < end; ++i) {
    for (int w = 0; w < wide; ++w) {
      double sum = *c.at(i, j + w);
      for (int k = 0; k < depth; ++k) sum = sum - *a.at(i, k) * *b.at(j + w, k);
      *c.at(i, j + w) = sum;
    }
  }
}

// c(i, j) -= SUM over k of a(i, k) b(j, k) for columns j in [first, last) and rows i in [from,
// end); with `triangle` only for i >= j, and for some of those above. Each sum begins with c and
// runs through k in ascending order, whatever the registers are.
void subtract_product(const DenseColumns& c, const DenseColumns& a, const DenseColumns& b, int from,
                      int end, int first, int last, int depth, bool triangle) {
  with_widest([&](auto width) APOTHEM_LAMBDA {
    constexpr int lanes = decltype(width)::value;
    int j = first;
    for (; j + 4 <= last; j += 4) {
      subtract_strip<lanes, 4>(c, a, b, triangle ? std::max(from, j) : from, end, j, depth);
    }
    for (; j < last; ++j) {
      subtract_strip<lanes, 1>(c, a, b, triangle ? std::max(from, j) : from, end, j, depth);
    }
    return 0.;
  });
}

}  // namespace

template <int B>
void FrontalFactors<B>::analyse(int size, std::vector<std::pair<int, int>> pairs) {
  order_ = Elimination(size, std::move(pairs), B);
  const Elimination::Room& room = order_.room();
  lower_.resize(kBlock * room.factors);
  upper_.clear();
  front_.resize(kBlock * room.height * room.height);
  across_.resize(kBlock * room.columns);
  left_.resize(kBlock * room.left);
  local_.assign(nth(size), 0);
  for (std::vector<Block>* blocks : {&pivot_, &inverse_, &diagonal_}) blocks->resize(nth(size));
  for (std::vector<Block>* blocks : {&below_, &above_}) blocks->resize(order_.entries());
}

template <int B>
typename FrontalFactors<B>::Block& FrontalFactors<B>::at(int row, int column) {
  const int r = order_.place(row), c = order_.place(column);
  if (r == c) return diagonal_[nth(r)];
  const std::span<const int> rows = order_.rows_of_column(nth(std::min(r, c)));
  const auto found = std::ranges::lower_bound(rows, std::max(r, c));
  const size_t i =
      order_.first_entry(nth(std::min(r, c))) + static_cast<size_t>(found - rows.begin());
  return r < c ? above_[i] : below_[i];
}

template <int B>
void FrontalFactors<B>::set_zero() {
  for (std::vector<Block>* blocks : {&above_, &below_, &diagonal_}) {
    std::ranges::fill(*blocks, Block::Zero());
  }
}

template <int B>
bool FrontalFactors<B>::is_symmetric(double tolerance) const {
  double largest = 0, skew = 0;
  const auto compare = [&](const Block& a, const Block& b) {
    largest = std::max({largest, a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff()});
    skew = std::max(skew, (a - b.transpose()).cwiseAbs().maxCoeff());
  };
  for (const Block& d : diagonal_) compare(d, d);
  for (size_t p = 0; p < above_.size(); ++p) compare(above_[p], below_[p]);
  return skew <= tolerance * largest;
}

template <int B>
bool FrontalFactors<B>::is_finite() const {
  const auto finite = [](const Block& block) { return block.allFinite(); };
  return std::ranges::all_of(diagonal_, finite) && std::ranges::all_of(above_, finite) &&
         std::ranges::all_of(below_, finite);
}

template <int B>
bool FrontalFactors<B>::factorise(bool symmetric) {
  symmetric_ = symmetric;
  if (!symmetric) upper_.resize(lower_.size());
  top_ = 0;
  for (const Front& front : order_.fronts()) {
    assemble(front, symmetric);
    if (!eliminate(front, symmetric)) return false;
    keep_factors(front, symmetric);
  }
  return true;
}

// The entries of the matrix in the columns of a front, and what the fronts below it have left.
template <int B>
void FrontalFactors<B>::assemble(const Front& front, bool symmetric) {
  const int height = B * front.size();
  const DenseColumns to{front_.data(), height};
  std::fill_n(front_.begin(), nth(height) * nth(height), 0.);
  for (int c = 0; c < front.count; ++c) local_[nth(front.first + c)] = B * c;
  const std::span<const int> rows = order_.rows_of(front);
  for (int r = 0; r < front.below; ++r) {
    local_[nth(rows[nth(r)])] = B * (front.count + r);
  }
  const auto put = [&](const Block& block, int row, int column) {
    for (int j = 0; j < B; ++j) {
      for (int i = 0; i < B; ++i) *to.at(row + i, column + j) = block(i, j);
    }
  };
  for (int c = 0; c < front.count; ++c) {
    const auto k = nth(front.first + c);
    put(diagonal_[k], B * c, B * c);
    size_t entry = order_.first_entry(k);
    for (const int below : order_.rows_of_column(k)) {
      const int row = local_[nth(below)];
      put(below_[entry], row, B * c);
      if (!symmetric) put(above_[entry], B * c, row);
      ++entry;
    }
  }
  take_left(front, symmetric);
}

// The last front below it has left its part at the end.
template <int B>
void FrontalFactors<B>::take_left(const Front& front, bool symmetric) {
  const DenseColumns to{front_.data(), B * front.size()};
  for (int f = front.child; f >= 0; f = order_.fronts()[nth(f)].sibling) {
    const Front& child = order_.fronts()[nth(f)];
    const int height = B * child.below;
    top_ -= nth(height) * nth(height);
    const DenseColumns from{&left_[top_], height};
    const std::span<const int> rows = order_.rows_of(child);
    for (int c = 0; c < child.below; ++c) {
      const int column = local_[nth(rows[nth(c)])];
      for (int r = symmetric ? c : 0; r < child.below; ++r) {
        const int row = local_[nth(rows[nth(r)])];
        for (int j = 0; j < B; ++j) {
          for (int i = 0; i < B; ++i) {
            *to.at(row + i, column + j) += *from.at(B * r + i, B * c + j);
          }
        }
      }
    }
  }
}

// Eliminates the columns of a front: a panel of them at a time, and then from all others what that
// changes there. Of symmetric fronts only what is below the diagonal is known.
template <int B>
bool FrontalFactors<B>::eliminate(const Front& front, bool symmetric) {
  const int height = B * front.size(), columns = B * front.count;
  const DenseColumns f{front_.data(), height}, across{across_.data(), height};
  constexpr int kWide = kPanel / B * B;
  for (int begin = 0; begin < columns; begin += kWide) {
    const int end = std::min(begin + kWide, columns);
    for (int k = begin; k < end; k += B) {
      if (!eliminate_block(front, k, end, symmetric)) return false;
    }
    const DenseColumns l{f.at(0, begin), height}, u{across.at(0, begin), height};
    subtract_product(f, l, u, end, height, end, height, end - begin, symmetric);
  }
  return true;
}

// The columns from k on of one block, with what that changes in the columns before `end`, and
// without symmetry in the rows before it.
template <int B>
bool FrontalFactors<B>::eliminate_block(const Front& front, int k, int end, bool symmetric) {
  const int height = B * front.size();
  const DenseColumns f{front_.data(), height}, across{across_.data(), height};
  const auto number = nth(front.first + k / B);
  Block& pivot = pivot_[number];
  for (int j = 0; j < B; ++j) {
    for (int i = 0; i < B; ++i) {
      const bool swaps = symmetric && i < j;
      pivot(i, j) = *f.at(k + (swaps ? j : i), k + (swaps ? i : j));
    }
  }
  const Block inverse = pivot.inverse();
  if (!inverse.allFinite()) return false;
  inverse_[number] = inverse;
  for (int row = k + B; row < height; ++row) {
    std::array<double, B> below;
    for (int j = 0; j < B; ++j) {
      below[nth(j)] = *f.at(row, k + j);
      *across.at(row, k + j) = symmetric ? below[nth(j)] : *f.at(k + j, row);
    }
    for (int j = 0; j < B; ++j) {
      double sum = 0;
      for (int i = 0; i < B; ++i) sum += below[nth(i)] * inverse(i, j);
      *f.at(row, k + j) = sum;
    }
  }
  const DenseColumns l{f.at(0, k), height}, u{across.at(0, k), height};
  subtract_product(f, l, u, k + B, height, k + B, end, B, symmetric);
  if (!symmetric) subtract_product(f, l, u, k + B, end, end, height, B, false);
  return true;
}

// Puts the columns of L and the rows of U away, and what is left for the front above.
template <int B>
void FrontalFactors<B>::keep_factors(const Front& front, bool symmetric) {
  const auto height = nth(B * front.size());
  const auto columns = nth(B * front.count), below = height - columns;
  const size_t count = height * columns;
  std::copy_n(front_.data(), count, &lower_[kBlock * front.factor]);
  if (!symmetric) std::copy_n(across_.data(), count, &upper_[kBlock * front.factor]);
  for (size_t c = 0; c < below; ++c) {
    std::copy_n(&front_[(columns + c) * height + columns], below, &left_[top_ + c * below]);
  }
  top_ += below * below;
}

template <int B>
void FrontalFactors<B>::solve(std::span<double> x) const {
  const auto n = nth(order_.size());
  const std::span<const Front> fronts = order_.fronts();
  std::vector<double> y(B * n), here(B * order_.room().height);
  for (size_t i = 0; i < n; ++i) {
    std::copy_n(&x[B * i], B, &y[B * nth(order_.place(static_cast<int>(i)))]);
  }
  for (const Front& front : fronts) solve_down(front, y, here);
  for (size_t f = fronts.size(); f-- > 0;) solve_up(fronts[f], y, here);
  for (size_t i = 0; i < n; ++i) {
    std::copy_n(&y[B * nth(order_.place(static_cast<int>(i)))], B, &x[B * i]);
  }
}

// The entries of y in the rows of a front.
template <int B>
void FrontalFactors<B>::gather(const Front& front, std::span<const double> y,
                               std::span<double> here) const {
  std::copy_n(&y[nth(B * front.first)], B * front.count, here.begin());
  double* to = here.data() + nth(B * front.count);
  for (const int row : order_.rows_of(front)) to = std::copy_n(&y[nth(B * row)], B, to);
}

// y := L^-1 y, for the columns of a front.
template <int B>
void FrontalFactors<B>::solve_down(const Front& front, std::span<double> y,
                                   std::span<double> here) const {
  gather(front, y, here);
  const int columns = B * front.count, height = B * front.size();
  const double* column = &lower_[kBlock * front.factor];
  for (int k = 0; k < columns; ++k, column += height) {
    const double value = here[nth(k)];
    for (int row = (k / B + 1) * B; row < height; ++row) {
      here[nth(row)] -= column[row] * value;
    }
  }
  std::copy_n(here.begin(), columns, &y[nth(B * front.first)]);
  auto from = here.begin() + columns;
  for (const int row : order_.rows_of(front)) {
    std::copy_n(from, B, &y[nth(B * row)]);
    from += B;
  }
}

// y := (D U)^-1 y, likewise, when the rows below are known.
template <int B>
void FrontalFactors<B>::solve_up(const Front& front, std::span<double> y,
                                 std::span<double> here) const {
  gather(front, y, here);
  const int height = B * front.size();
  const std::vector<double>& across = symmetric_ ? lower_ : upper_;
  for (int k = front.count - 1; k >= 0; --k) {
    Eigen::Map<Part> part(&here[nth(B * k)]);
    Part sum;
    for (int j = 0; j < B; ++j) {
      const double* column = &across[kBlock * front.factor + nth(B * k + j) * nth(height)];
      double product = 0;
      for (int row = B * (k + 1); row < height; ++row) {
        product += column[row] * here[nth(row)];
      }
      sum[j] = product;
    }
    const Block& inverse = inverse_[nth(front.first + k)];
    part = symmetric_ ? Part(inverse * part - sum) : Part(inverse * (part - sum));
  }
  std::copy_n(here.begin(), B * front.count, &y[nth(B * front.first)]);
}

template class FrontalFactors<2>;
template class FrontalFactors<3>;

}  // namespace apothem
