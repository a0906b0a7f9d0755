#include "lib/solver/frontal_factors.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
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
// Fronts are joined where that adds no more than these parts of zeros, by the number of columns (Y.
// Chen et al., ACM Trans. Math. Softw. 35 (2008) 22).
constexpr int kFew = 4, kSome = 16, kMany = 48;
constexpr double kOfSome = .8, kOfMany = .1, kOfMore = .05;

constexpr size_t nth(int i) { return static_cast<size_t>(i); }

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

// Sorts pairs of numbers below `size`, which takes no longer than to read them a few times.
void sort_pairs(std::vector<std::pair<int, int>>& pairs, int size) {
  std::vector<std::pair<int, int>> sorted(pairs.size());
  for (int std::pair<int, int>::*const key :
       {&std::pair<int, int>::second, &std::pair<int, int>::first}) {
    std::vector<size_t> end(nth(size) + 1, 0);
    for (const auto& pair : pairs) ++end[nth(pair.*key) + 1];
    for (size_t k = 0; k < nth(size); ++k) end[k + 1] += end[k];
    for (const auto& pair : pairs) sorted[end[nth(pair.*key)]++] = pair;
    std::swap(pairs, sorted);
  }
}

// The nodes of a forest so that each comes after those below it.
std::vector<int> in_postorder(const std::vector<int>& parent) {
  const auto n = parent.size();
  std::vector<int> child(n, -1), next(n, -1), order, open;
  for (size_t i = n; i-- > 0;) {
    if (parent[i] < 0) continue;
    next[i] = std::exchange(child[nth(parent[i])], static_cast<int>(i));
  }
  for (size_t root = 0; root < n; ++root) {
    if (parent[root] >= 0) continue;
    open.push_back(static_cast<int>(root));
    while (!open.empty()) {
      const auto i = nth(open.back());
      const int below = std::exchange(child[i], -1);
      if (below < 0) {
        order.push_back(open.back());
        open.pop_back();
      } else {
        child[i] = next[nth(below)];
        open.push_back(below);
      }
    }
  }
  return order;
}

}  // namespace

template <int B>
void FrontalFactors<B>::analyse(int size, std::vector<std::pair<int, int>> pairs) {
  size_ = size;
  for (auto& [row, column] : pairs) {
    if (row < column) std::swap(row, column);
  }
  sort_pairs(pairs, size);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  order(pairs);
  place_blocks(pairs);
  const std::vector<int> sorted = in_postorder(find_parents());
  std::vector<int> later(sorted.size());
  for (size_t k = 0; k < sorted.size(); ++k) later[nth(sorted[k])] = static_cast<int>(k);
  for (int& place : place_) place = later[nth(place)];
  place_blocks(pairs);
  find_fronts();
  join_fronts();
  measure_fronts();
}

template <int B>
void FrontalFactors<B>::order(const std::vector<std::pair<int, int>>& pairs) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(2 * pairs.size() + nth(size_));
  for (const auto& [row, column] : pairs) {
    entries.emplace_back(row, column, 1.);
    entries.emplace_back(column, row, 1.);
  }
  for (int i = 0; i < size_; ++i) entries.emplace_back(i, i, 1.);
  Eigen::SparseMatrix<double> pattern(size_, size_);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> eliminated;
  Eigen::AMDOrdering<int>()(pattern, eliminated);
  place_.resize(nth(size_));
  for (int k = 0; k < size_; ++k) place_[nth(eliminated.indices()[k])] = k;
}

// Sorts the blocks below the diagonal by columns, in the order of elimination.
template <int B>
void FrontalFactors<B>::place_blocks(std::vector<std::pair<int, int>>& pairs) {
  std::vector<std::pair<int, int>> placed;  // column, row
  placed.reserve(pairs.size());
  for (const auto& [row, column] : pairs) {
    const int r = place_[nth(row)], c = place_[nth(column)];
    placed.emplace_back(std::min(r, c), std::max(r, c));
  }
  sort_pairs(placed, size_);
  const auto n = nth(size_);
  first_.assign(n + 1, 0);
  row_.clear();
  for (const auto& [column, row] : placed) {
    ++first_[nth(column) + 1];
    row_.push_back(row);
  }
  for (size_t k = 0; k < n; ++k) first_[k + 1] += first_[k];
}

// The tree of elimination: the first row of each column of L (J. Liu, SIAM J. Matrix Anal. Appl. 11
// (1990) 134).
template <int B>
std::vector<int> FrontalFactors<B>::find_parents() const {
  const auto n = nth(size_);
  std::vector<int> parent(n, -1), ancestor(n, -1);
  std::vector<std::vector<int>> columns(n);  // of the entries of each row
  for (size_t k = 0; k < n; ++k) {
    for (int p = first_[k]; p < first_[k + 1]; ++p) {
      columns[nth(row_[nth(p)])].push_back(static_cast<int>(k));
    }
  }
  for (size_t row = 0; row < n; ++row) {
    for (int i : columns[row]) {
      while (i >= 0 && i < static_cast<int>(row)) {
        const int next = std::exchange(ancestor[nth(i)], static_cast<int>(row));
        if (next < 0) parent[nth(i)] = static_cast<int>(row);
        i = next;
      }
    }
  }
  return parent;
}

// One front for each run of columns of which each has the rows of the next one, and that.
template <int B>
void FrontalFactors<B>::find_fronts() {
  const auto n = nth(size_);
  std::vector<std::vector<int>> rows(n), children(n);  // of each column
  std::vector<int> seen(n, -1);
  fronts_.clear();
  rows_.clear();
  for (size_t k = 0; k < n; ++k) {
    const int column = static_cast<int>(k);
    std::vector<int>& here = rows[k];
    seen[k] = column;
    const auto add = [&](int row) {
      if (std::exchange(seen[nth(row)], column) != column) here.push_back(row);
    };
    for (const int child : children[k]) {
      for (const int row : rows[nth(child)]) add(row);
    }
    for (int p = first_[k]; p < first_[k + 1]; ++p) add(row_[nth(p)]);
    if (!std::ranges::is_sorted(here)) std::ranges::sort(here);
    if (!here.empty()) children[nth(here[0])].push_back(column);
    const bool joins = children[k].size() == 1 && children[k][0] == column - 1 &&
                       rows[k - 1].size() == here.size() + 1;
    if (!joins) fronts_.push_back({.first = column});
    ++fronts_.back().count;
  }
  for (Front& front : fronts_) {
    const std::vector<int>& last = rows[nth(front.first + front.count - 1)];
    front.rows = rows_.size();
    front.below = static_cast<int>(last.size());
    rows_.insert(rows_.end(), last.begin(), last.end());
  }
}

// Joins fronts with those above them whose columns follow at once. A few zeros are cheaper than
// many small fronts.
template <int B>
void FrontalFactors<B>::join_fronts() {
  std::vector<Front> joined;
  std::vector<double> zeros;  // blocks, in each of these
  for (Front front : fronts_) {
    double added = 0;
    while (!joined.empty()) {
      const Front& last = joined.back();
      const bool follows = last.first + last.count == front.first && last.below > 0 &&
                           rows_[last.rows] < front.first + front.count;
      if (!follows) break;
      const double more =
          added + zeros.back() + last.count * static_cast<double>(front.size() - last.below);
      const double columns = last.count + front.count;
      const double all = columns * (columns + 1) / 2 + columns * front.below;
      const double part = more / all;
      const int wide = B * (last.count + front.count);
      const bool good = wide <= kFew || part < (wide <= kSome   ? kOfSome
                                                : wide <= kMany ? kOfMany
                                                                : kOfMore);
      if (!good) break;
      front.first = last.first;
      front.count += last.count;
      added = more;
      joined.pop_back();
      zeros.pop_back();
    }
    joined.push_back(front);
    zeros.push_back(added);
  }
  fronts_ = std::move(joined);
  std::vector<int> of_column(nth(size_));
  for (size_t f = 0; f < fronts_.size(); ++f) {
    for (int c = 0; c < fronts_[f].count; ++c)
      of_column[nth(fronts_[f].first + c)] = static_cast<int>(f);
  }
  for (size_t f = 0; f < fronts_.size(); ++f) {
    if (fronts_[f].below == 0) continue;
    const auto parent = nth(of_column[nth(rows_[fronts_[f].rows])]);
    fronts_[f].parent = static_cast<int>(parent);
    fronts_[f].sibling = std::exchange(fronts_[parent].child, static_cast<int>(f));
  }
}

// The places of the factors, and room for the largest front and for what fronts leave.
template <int B>
void FrontalFactors<B>::measure_fronts() {
  size_t factors = 0, tallest = 0, panel = 0, left = 0, most = 0;
  std::vector<size_t> of_children(fronts_.size(), 0);  // what they leave
  for (size_t f = 0; f < fronts_.size(); ++f) {
    Front& front = fronts_[f];
    const size_t height = nth(B * front.size());
    const size_t below = nth(B * front.below);
    tallest = std::max(tallest, height);
    front.factor = factors;
    factors += height * nth(B * front.count);
    panel = std::max(panel, height * nth(B * front.count));
    left -= of_children[f];
    left += below * below;
    most = std::max(most, left);
    if (front.parent >= 0) of_children[nth(front.parent)] += below * below;
  }
  lower_.resize(factors);
  upper_.clear();
  tallest_ = tallest;
  front_.resize(tallest * tallest);
  across_.resize(panel);
  left_.resize(most);
  local_.assign(nth(size_), 0);
  pivot_.resize(nth(size_));
  inverse_.resize(nth(size_));
  below_.resize(row_.size());
  above_.resize(row_.size());
  diagonal_.resize(nth(size_));
}

template <int B>
typename FrontalFactors<B>::Block& FrontalFactors<B>::at(int row, int column) {
  const int r = place_[nth(row)], c = place_[nth(column)];
  if (r == c) return diagonal_[nth(r)];
  const auto k = nth(std::min(r, c));
  const auto found =
      std::lower_bound(row_.begin() + first_[k], row_.begin() + first_[k + 1], std::max(r, c));
  const auto i = static_cast<size_t>(found - row_.begin());
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
  for (const Front& front : fronts_) {
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
  const std::span<const int> rows = rows_of(front);
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
    for (int p = first_[k]; p < first_[k + 1]; ++p) {
      const auto entry = nth(p);
      const int row = local_[nth(row_[entry])];
      put(below_[entry], row, B * c);
      if (!symmetric) put(above_[entry], B * c, row);
    }
  }
  take_left(front, symmetric);
}

// The last front below it has left its part at the end.
template <int B>
void FrontalFactors<B>::take_left(const Front& front, bool symmetric) {
  const DenseColumns to{front_.data(), B * front.size()};
  for (int f = front.child; f >= 0; f = fronts_[nth(f)].sibling) {
    const Front& child = fronts_[nth(f)];
    const int height = B * child.below;
    top_ -= nth(height) * nth(height);
    const DenseColumns from{&left_[top_], height};
    const std::span<const int> rows = rows_of(child);
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
  std::copy_n(front_.data(), count, &lower_[front.factor]);
  if (!symmetric) std::copy_n(across_.data(), count, &upper_[front.factor]);
  for (size_t c = 0; c < below; ++c) {
    std::copy_n(&front_[(columns + c) * height + columns], below, &left_[top_ + c * below]);
  }
  top_ += below * below;
}

template <int B>
void FrontalFactors<B>::solve(std::span<double> x) const {
  const auto n = nth(size_);
  std::vector<double> y(B * n), here(tallest_);
  for (size_t i = 0; i < n; ++i) {
    std::copy_n(&x[B * i], B, &y[B * nth(place_[i])]);
  }
  for (const Front& front : fronts_) solve_down(front, y, here);
  for (size_t f = fronts_.size(); f-- > 0;) solve_up(fronts_[f], y, here);
  for (size_t i = 0; i < n; ++i) {
    std::copy_n(&y[B * nth(place_[i])], B, &x[B * i]);
  }
}

// The entries of y in the rows of a front.
template <int B>
void FrontalFactors<B>::gather(const Front& front, std::span<const double> y,
                               std::span<double> here) const {
  std::copy_n(&y[nth(B * front.first)], B * front.count, here.begin());
  auto to = here.begin() + B * front.count;
  for (const int row : rows_of(front)) to = std::copy_n(&y[nth(B * row)], B, to);
}

// y := L^-1 y, for the columns of a front.
template <int B>
void FrontalFactors<B>::solve_down(const Front& front, std::span<double> y,
                                   std::span<double> here) const {
  gather(front, y, here);
  const int columns = B * front.count, height = B * front.size();
  const double* column = &lower_[front.factor];
  for (int k = 0; k < columns; ++k, column += height) {
    const double value = here[nth(k)];
    for (int row = (k / B + 1) * B; row < height; ++row) {
      here[nth(row)] -= column[row] * value;
    }
  }
  std::copy_n(here.begin(), columns, &y[nth(B * front.first)]);
  auto from = here.begin() + columns;
  for (const int row : rows_of(front)) {
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
      const double* column = &across[front.factor + nth(B * k + j) * nth(height)];
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
