#include "lib/contact/law/dashpots.hpp"

#include <algorithm>
#include <cmath>

namespace apothem {
namespace {

constexpr int kMostSweeps = 50;
constexpr double kAgree = 1e-6;  // of the largest impulse, or of what presses over the step

}  // namespace

double dashpot_time(double value, bool is_time, double k, double mobility) {
  if (is_time) return value;
  const double omega2 = k * mobility;
  return value > 0 && omega2 > 0 ? 2 * value / std::sqrt(omega2) : 0;
}

// Where the force rises with the power p of the depth, the stiffness is p times the force over the
// depth, and the coefficient rises with its root: 1 flat on flat, 2 at a corner.
Dashpot::Normal Dashpot::Normal::of(double rate, double pressed, double stiffness, double deepest) {
  if (!(stiffness > 0 && pressed > 0)) return {rate, pressed, 0, 1};
  const double power = std::clamp(stiffness * deepest / pressed, 1., 2.);
  return {rate, pressed, power * pressed / stiffness, 2 / (power + 1)};
}

void Dashpots::add(size_t coordinate, const std::array<double, 3>& part) {
  const auto c = static_cast<std::uint32_t>(coordinate);
  for (auto e = static_cast<size_t>(solved_.back().first); e < entries_.size(); ++e) {
    if (entries_[e].coordinate != c) continue;
    for (size_t k = 0; k < 3; ++k) entries_[e].part[k] += part[k];
    return;
  }
  entries_.push_back({c, part});
}

void Dashpots::add_node(NodeIndex node, const Vec2& normal, const Vec2& tangential) {
  const size_t first = nodes_ + 2 * static_cast<size_t>(node);
  add(first, {normal.x(), 0, tangential.x()});
  add(first + 1, {normal.y(), 0, tangential.y()});
}

void Dashpots::add_point(RigidIndex body, const Vec2& arm, const Vec2& normal,
                         const Vec2& tangential) {
  const size_t first = 3 * static_cast<size_t>(body);
  add(first, {normal.x(), 0, tangential.x()});
  add(first + 1, {normal.y(), 0, tangential.y()});
  add(first + 2, {cross(arm, normal), 0, cross(arm, tangential)});
}

void Dashpots::add_rigid(RigidIndex body, double sign, const std::array<Vec2, 2>& normal_at,
                         const Vec2& tangential_at) {
  const auto c = static_cast<std::uint32_t>(3 * static_cast<size_t>(body));
  const Vec2 n = sign * dashpots_.back().normal, t(-n.y(), n.x());
  entries_.push_back({c, {n.x(), n.x(), t.x()}});
  entries_.push_back({c + 1, {n.y(), n.y(), t.y()}});
  entries_.push_back(
      {c + 2, {cross(normal_at[0], n), cross(normal_at[1], n), cross(tangential_at, t)}});
}

std::span<const Dashpots::Entry> Dashpots::entries(size_t i) const {
  const auto first = static_cast<size_t>(solved_[i].first);
  const size_t end =
      i + 1 < solved_.size() ? static_cast<size_t>(solved_[i + 1].first) : entries_.size();
  return {entries_.data() + first, end - first};
}

Vec2 Dashpots::force_on_a(size_t i) const {
  const Vec2& n = dashpots_[i].normal;
  return normal_force(i) * n + tangential_force(i) * Vec2(-n.y(), n.x());
}

double Dashpots::lost_after(std::span<const double> velocity, double dt) const {
  double power = 0;
  for (size_t c = 0; c < forces_.size(); ++c) power += forces_[c] * velocity[c];
  return -dt / 2 * (power - gain_);
}

// The velocity along a rail is one number, and both coordinates have it. Impulses across it go into
// what holds the rail.
void Dashpots::put_on(std::span<const Motion::Rail> rails) {
  for (size_t i = 0; i < solved_.size(); ++i) {
    const auto first = static_cast<size_t>(solved_[i].first), end = first + entries(i).size();
    for (size_t e = first; e < end; ++e) {
      for (const Motion::Rail& rail : rails) {
        if (entries_[e].coordinate != 3 * static_cast<std::uint32_t>(rail.body)) continue;
        Entry &x = entries_[e], &y = entries_[e + 1];
        across_rails_.push_back(x), across_rails_.push_back(y);
        across_at_.insert(across_at_.end(), 2, static_cast<std::uint32_t>(i));
        Entry &lost_x = across_rails_.end()[-2], &lost_y = across_rails_.end()[-1];
        for (size_t k = 0; k < 3; ++k) {
          const double along = Vec2(x.part[k], y.part[k]).dot(rail.direction);
          x.part[k] = along * rail.direction.x(), y.part[k] = along * rail.direction.y();
          lost_x.part[k] -= x.part[k], lost_y.part[k] -= y.part[k];
        }
      }
    }
  }
}

void Dashpots::find_kicks(const Motion& motion, double dt) {
  const std::span<const double> w = motion.inverse_mass;
  kick_.resize(w.size()), velocity_.resize(w.size());
  for (size_t c = 0; c < w.size(); ++c) {
    const double g = motion.weight.empty() ? 0 : motion.weight[c];
    kick_[c] = dt / 2 * w[c] * (motion.before[c] + motion.after[c] + 2 * g);
  }
  inverse_mass_ = w;
  across_rails_.clear(), across_at_.clear();
  if (!motion.rails.empty()) {
    put_on(motion.rails);
    with_rails_.assign(w.begin(), w.end());
    for (const Motion::Rail& rail : motion.rails) {
      for (const size_t axis : {0, 1}) {
        const size_t c = 3 * static_cast<size_t>(rail.body) + axis;
        with_rails_[c] = rail.inverse_mass;
        kick_[c] = rail.gain * rail.direction[static_cast<Eigen::Index>(axis)];
      }
    }
    inverse_mass_ = with_rails_;
  }
  for (size_t c = 0; c < w.size(); ++c) velocity_[c] = motion.velocity[c] + kick_[c];
}

// A contact that has begun within the last drift, or will end within the next one, acts for as long
// as it is closed, and any other one for half of both.
void Dashpots::find_rates(double dt) {
  reach_.assign(kick_.size(), 0.);
  for (size_t i = 0; i < dashpots_.size(); ++i) {
    const Dashpot& of = dashpots_[i];
    Solved& solved = solved_[i];
    std::array<double, 3> before{}, kick{};
    for (const Entry& e : entries(i)) {
      for (size_t k = 0; k < 3; ++k) {
        kick[k] += e.part[k] * kick_[e.coordinate];
        before[k] += e.part[k] * (velocity_[e.coordinate] - kick_[e.coordinate]);
      }
    }
    const auto share_of = [&](double approach, const Dashpot::Normal& normal) {
      return approach * dt > normal.depth ? normal.mean * normal.depth / (approach * dt) : .5;
    };
    double share = 0;  // of the contact: where it is deeper
    for (size_t k = 0; k < 2; ++k) {
      const Dashpot::Normal& across = of.across[k];
      const double both = share_of(-before[k], across) + share_of(before[k] + kick[k], across);
      if (across.rate > 0) share = std::max(share, both);
      solved.along[k] = {0, across.rate * both * dt, before[k]};
    }
    solved.along[2] = {0, of.tangential_rate * share * dt, before[2]};
    for (const Entry& e : entries(i)) {
      for (size_t k = 0; k < 3; ++k) {
        reach_[e.coordinate] += solved.along[k].gain * std::abs(e.part[k]);
      }
    }
  }
}

// x counts what the impulses of all dashpots of these bodies do to the rate.
void Dashpots::find_gains() {
  for (size_t i = 0; i < dashpots_.size(); ++i) {
    Solved& solved = solved_[i];
    std::array<double, 3> mobility{}, coupled{};
    solved.d01 = solved.d02 = solved.d12 = 0;
    for (const Entry& e : entries(i)) {
      const double w = inverse_mass_[e.coordinate];
      for (size_t k = 0; k < 3; ++k) {
        mobility[k] += w * e.part[k] * e.part[k];
        coupled[k] += w * std::abs(e.part[k]) * reach_[e.coordinate];
      }
      solved.d01 += w * e.part[0] * e.part[1];
      solved.d02 += w * e.part[0] * e.part[2];
      solved.d12 += w * e.part[1] * e.part[2];
    }
    for (size_t k = 0; k < 3; ++k) {
      const double rate = solved.along[k].gain, before = solved.along[k].offset, x = coupled[k];
      const double theta = x > 2 ? 1 - 1 / x : .5, part = 1 + theta * rate * mobility[k];
      solved.along[k] = {1 - 1 / part, rate * theta / part, rate * (1 - theta) * before / part};
    }
  }
}

// Has the dashpots of a contact agree with all others as they are. Returns the largest change of an
// impulse, N s.
double Dashpots::relax(size_t i, double dt) {
  const Dashpot& of = dashpots_[i];
  Solved& solved = solved_[i];
  std::array<double, 3> rate{};
  for (const Entry& e : entries(i)) {
    const double v = velocity_[e.coordinate];
    for (size_t k = 0; k < 3; ++k) rate[k] += e.part[k] * v;
  }
  std::array<double, 3> change;
  const auto follow = [&](size_t k, double behind, double least, double most) {
    Along& along = solved.along[k];
    const double free = along.kept * along.impulse - along.gain * behind - along.offset;
    const double next = std::clamp(free, least, most);
    change[k] = next - along.impulse;
    along.impulse = next;
  };
  follow(0, rate[0], -of.across[0].pressed * dt, HUGE_VAL);
  follow(1, rate[1] + solved.d01 * change[0], -of.across[1].pressed * dt, HUGE_VAL);
  const double pressed = (of.across[0].pressed + of.across[1].pressed) * dt +
                         solved.along[0].impulse + solved.along[1].impulse;
  const double limit = of.coefficient * std::max(0., pressed), spring = of.spring * dt;
  follow(2, rate[2] + solved.d02 * change[0] + solved.d12 * change[1], -limit - spring,
         limit - spring);
  for (const Entry& e : entries(i)) {
    velocity_[e.coordinate] +=
        inverse_mass_[e.coordinate] *
        (e.part[0] * change[0] + e.part[1] * change[1] + e.part[2] * change[2]);
  }
  return std::max({std::abs(change[0]), std::abs(change[1]), std::abs(change[2])});
}

void Dashpots::solve(const Motion& motion, double dt) {
  dt_ = dt;
  find_kicks(motion, dt);
  find_rates(dt);
  find_gains();
  double pressed = 0;
  for (const Dashpot& of : dashpots_) {
    pressed = std::max(pressed, of.across[0].pressed + of.across[1].pressed);
  }
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double change = 0, largest = pressed * dt;
    for (size_t i = 0; i < dashpots_.size(); ++i) relax(i, dt);
    for (size_t i = dashpots_.size(); i-- > 0;) {
      change = std::max(change, relax(i, dt));
      const std::array<Along, 3>& along = solved_[i].along;
      largest = std::max(largest, std::abs(along[0].impulse + along[1].impulse));
    }
    if (change <= kAgree * largest) break;
  }
  sum_forces(motion, dt);
}

void Dashpots::sum_forces(const Motion& motion, double dt) {
  forces_.assign(motion.inverse_mass.size(), 0.);
  const auto add_force = [&](const Entry& e, size_t i) {
    const std::array<Along, 3>& along = solved_[i].along;
    for (size_t k = 0; k < 3; ++k) forces_[e.coordinate] += e.part[k] * along[k].impulse / dt;
  };
  for (size_t i = 0; i < dashpots_.size(); ++i) {
    for (const Entry& e : entries(i)) add_force(e, i);
  }
  for (size_t k = 0; k < across_rails_.size(); ++k) add_force(across_rails_[k], across_at_[k]);
  // The mean velocities of both half kicks.
  double power = 0;
  gain_ = 0;
  for (size_t c = 0; c < forces_.size(); ++c) {
    const double f = forces_[c], w = dt / 4 * motion.inverse_mass[c];
    const double g = motion.weight.empty() ? 0 : motion.weight[c];
    power += f * (motion.velocity[c] + w * (motion.before[c] + f + g));
    gain_ += f * w * (motion.after[c] + f + g);
  }
  lost_ = -dt / 2 * power;
}

}  // namespace apothem
