#include "lib/sweep/summary_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "lib/text/words.hpp"

namespace apothem {
namespace {

const MeasuredValue* find_measure(const RunRecord& record, const std::string& name) {
  for (const auto& [known, value] : record.measures) {
    if (known == name) return &value;
  }
  return nullptr;
}

// The value of a measure of a run that is done.
MeasuredValue value_of(const RunRecord& record, const std::string& name) {
  const MeasuredValue* value =
      record.state == RunState::done ? find_measure(record, name) : nullptr;
  return value ? *value : MeasuredValue();
}

// A number, or yes as 1 and no as 0.
std::optional<double> number_of(const MeasuredValue& value) {
  if (const auto* yes = std::get_if<bool>(&value)) return *yes ? 1 : 0;
  if (const auto* number = std::get_if<double>(&value)) return *number;
  return {};
}

using Records = std::vector<const RunRecord*>;

SummaryCell mean_cell(const Records& runs, const std::string& measure) {
  std::vector<double> values;
  for (const RunRecord* run : runs) {
    if (const auto number = number_of(value_of(*run, measure))) values.push_back(*number);
  }
  const MeanEstimate e = estimate_mean(values);
  return {e.n, runs.size() - e.n, 0, e.mean, e.standard_error, e.interval};
}

SummaryCell proportion_cell(const Records& runs, const std::string& measure) {
  size_t trials = 0, count = 0;
  for (const RunRecord* run : runs) {
    const auto number = number_of(value_of(*run, measure));
    if (!number) continue;
    ++trials;
    if (*number != 0) ++count;
  }
  const ProportionEstimate e = estimate_proportion(count, trials);
  return {e.n, runs.size() - e.n, e.count, e.proportion, 0, e.interval};
}

SummaryCell rate_cell(const Records& runs, const SurvivalChoice& survival) {
  std::vector<Survival> values;
  for (const RunRecord* run : runs) {
    const auto exposure = number_of(value_of(*run, survival.measure));
    const std::optional<double> event =
        survival.event.empty() ? 1 : number_of(value_of(*run, survival.event));
    if (exposure && *exposure < 0) {
      throw SceneError("--survival", fmt::format("\"{}\" is {} in a run; an exposure is 0 or more",
                                                 survival.measure, *exposure));
    }
    if (exposure && event) values.push_back({*exposure, *event != 0});
  }
  const RateEstimate e = estimate_rate(values);
  return {e.n, runs.size() - e.n, e.events, e.rate, 0, e.interval};
}

void require_measure(const std::string& name, bool yes_no,
                     const std::vector<MeasureName>& measures) {
  std::vector<std::string> known;
  for (const MeasureName& m : measures) {
    if (m.name == name && m.yes_no == yes_no) return;
    if (m.yes_no == yes_no) known.push_back(m.name);
  }
  const char* kind = yes_no ? "yes/no" : "number";
  throw SceneError("--survival",
                   fmt::format("no run has a {} measure {} (known: {})", kind, suggest(name, known),
                               known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", "))));
}

// The places in the plan of what is not a seed.
std::vector<size_t> places_without_seeds(const Plan& plan) {
  std::vector<size_t> places;
  for (size_t i = 0; i < plan.paths.size(); ++i) {
    if (!is_seed(plan.paths[i])) places.push_back(i);
  }
  return places;
}

}  // namespace

std::vector<MeasureName> measure_names(const std::vector<RunRecord>& records) {
  std::vector<MeasureName> names;
  std::map<std::string, size_t> places;
  for (const RunRecord& record : records) {
    for (const auto& [name, value] : record.measures) {
      const auto [place, added] = places.emplace(name, names.size());
      if (added) names.push_back({name, false});
    }
  }
  for (MeasureName& measure : names) {
    bool yes = false, number = false;
    for (const RunRecord& record : records) {
      const MeasuredValue* value = find_measure(record, measure.name);
      yes = yes || (value && std::holds_alternative<bool>(*value));
      number = number || (value && std::holds_alternative<double>(*value));
    }
    measure.yes_no = yes && !number;
  }
  return names;
}

SummaryTable summarise(const Plan& plan, const std::vector<RunRecord>& records,
                       const std::optional<SurvivalChoice>& survival) {
  using Kind = SummaryColumn::Kind;
  SummaryTable table;
  const std::vector<size_t> places = places_without_seeds(plan);
  for (const size_t i : places) table.paths.push_back(plan.paths[i]);
  const std::vector<MeasureName> measures = measure_names(records);
  for (const MeasureName& m : measures) {
    table.columns.push_back({m.yes_no ? Kind::proportion : Kind::mean, m.name});
  }
  if (survival) {
    require_measure(survival->measure, false, measures);
    if (!survival->event.empty()) require_measure(survival->event, true, measures);
    table.columns.push_back({Kind::rate, survival->measure});
  }
  std::vector<Records> groups;
  std::map<std::vector<std::string>, size_t> known;
  for (size_t r = 0; r < records.size(); ++r) {
    std::vector<std::string> values;
    values.reserve(places.size());
    for (const size_t i : places) values.push_back(plan.runs[r].values[i]);
    const auto [group, added] = known.emplace(values, groups.size());
    if (added) {
      groups.emplace_back();
      table.rows.push_back({std::move(values), 0, 0, {}});
    }
    groups[group->second].push_back(&records[r]);
  }
  for (size_t g = 0; g < groups.size(); ++g) {
    SummaryRow& row = table.rows[g];
    row.runs = groups[g].size();
    row.done = static_cast<size_t>(std::ranges::count_if(
        groups[g], [](const RunRecord* run) { return run->state == RunState::done; }));
    for (const SummaryColumn& column : table.columns) {
      row.cells.push_back(column.kind == Kind::mean ? mean_cell(groups[g], column.measure)
                          : column.kind == Kind::proportion
                              ? proportion_cell(groups[g], column.measure)
                              : rate_cell(groups[g], *survival));
    }
  }
  return table;
}

}  // namespace apothem
