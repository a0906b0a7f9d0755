#include "lib/text/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>

namespace apothem {
namespace {

// The Levenshtein distance.
size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (const char c : a) {
    size_t diagonal = row[0]++;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t substitute = diagonal + (c == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substitute, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

template <class Change>
std::string changed(std::string_view text, const Change& change) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(change(static_cast<unsigned char>(c)));
  return result;
}

}  // namespace

std::string lower_case(std::string_view text) {
  return changed(text, [](int c) { return std::tolower(c); });
}
std::string upper_case(std::string_view text) {
  return changed(text, [](int c) { return std::toupper(c); });
}

std::string_view trimmed(std::string_view text, std::string_view blanks) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

std::string replaced(std::string text, std::string_view mark, std::string_view by) {
  for (size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += by.size()) {
    text.replace(at, mark.size(), by);
  }
  return text;
}

const std::string* nearest_word(std::string_view word, const std::vector<std::string>& candidates) {
  const std::string* best = nullptr;
  size_t best_distance = std::max<size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const size_t distance = edit_distance(word, candidate);
    if (distance < best_distance && distance < candidate.size()) {
      best = &candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string suggest(std::string_view word, const std::vector<std::string>& candidates) {
  std::string result = fmt::format("\"{}\"", word);
  // A word that begins another one is that one cut short, however much of it is missing.
  const auto longer = std::ranges::find_if(candidates, [&](const std::string& candidate) {
    return word.size() >= 3 && candidate.starts_with(word);
  });
  if (longer != candidates.end()) {
    result += fmt::format("; did you mean \"{}\"?", *longer);
  } else if (const std::string* best = nearest_word(word, candidates)) {
    result += fmt::format("; did you mean \"{}\"?", *best);
  }
  return result;
}

}  // namespace apothem
