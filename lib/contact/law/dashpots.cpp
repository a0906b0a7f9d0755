#include "lib/contact/law/dashpots.hpp"

#include <algorithm>
#include <cmath>

namespace apothem {
namespace {

constexpr int kMostPasses = 100;
constexpr double kAgree = 1e-6;  // tolerance relative to the largest impulse, or to the elastic
                                 // normal impulse of the step

}  // namespace

double dashpot_time(double value, bool is_time, double k, double mobility) {
  if (is_time) return value;
  const double omega2 = k * mobility;
  return value > 0 && omega2 > 0 ? 2 * value / std::sqrt(omega2) : 0;
}

// If the force rises with the power p of the depth, the stiffness is p times the force over the
// depth. p is 1 for flat faces and 2 at a corner.
Dashpot::Normal Dashpot::Normal::of(double rate, double pressed, double stiffness, double deepest,
                                    double plateau) {
  if (!(stiffness > 0 && pressed > 0)) return {.rate = rate, .pressed = pressed};
  const double mean = pressed / stiffness;
  const double power = std::clamp(deepest / mean, 1., 2.);
  const double flat = 2 / power - 1;  // least depth of points without a plateau
  const double level = plateau * flat;
  const double least = level > 0 && level < 1 ? (flat - level) / (1 - level) : flat;
  return {rate, pressed, power * mean, power, level, least};
}

// With the largest depth D = pN/K, the coefficient c, and s = c u/(p N) for the rate u at which the
// sides part, points that are less deep than s D have no pressure. So the force is -c u = -p N s up
// to s = `least`, and from there to s = 1 it is -N [1 - 2 a p level z - a (p (1 - level) z)^2] with
// a = p - 1 and z = (1 - s)/(2 a). The rate depends on the force: with `kept`, this makes a
// quadratic equation for z.
double Dashpot::Normal::push(double free, double elastic, double kept) const {
  if (free >= -power * least * elastic) return free;
  const double more = elastic * (kept + power * (1 - kept)) + free, rise = power - 1;
  if (!(rise > 0 && more > 0)) return -elastic;
  const double even = power * (1 - level);
  const double linear = rise * elastic * power * (kept * level + (1 - kept));
  const double z =
      more / (linear + std::sqrt(linear * linear + rise * kept * even * even * elastic * more));
  return -elastic * (1 - rise * z * (2 * power * level + even * even * z));
}

void Dashpots::clear() {
  for (const Moved& moved : moved_) {
    if (moved.coordinate < index_.size()) index_[moved.coordinate] = kNone;
  }
  dashpots_.clear(), solved_.clear(), entries_.clear(), moved_.clear();
  across_rails_.clear(), of_these_.clear();
}

// Returns the index in moved_ of the first of `count` consecutive coordinates, and adds them if
// they are new.
std::uint32_t Dashpots::find(size_t first, size_t count) {
  if (first + count > index_.size()) index_.resize(first + count, kNone);
  std::uint32_t& index = index_[first];
  if (index != kNone) return index;
  index = static_cast<std::uint32_t>(moved_.size());
  for (size_t c = first; c < first + count; ++c) {
    moved_.push_back({.coordinate = static_cast<std::uint32_t>(c)});
  }
  return index;
}

// If a node occurs again in the same contact, its entries are summed.
template <size_t count>
void Dashpots::add(size_t first, const std::array<Parts, count>& parts) {
  const std::uint32_t index = find(first, count);
  Moved& moved = moved_[index];
  if (moved.end > solved_.back().first) {
    for (size_t c = 0; c < count; ++c) {
      for (size_t k = 0; k < 3; ++k) entries_[moved.end - count + c].part[k] += parts[c][k];
    }
    return;
  }
  for (size_t c = 0; c < count; ++c) {
    entries_.push_back({index + static_cast<std::uint32_t>(c), parts[c]});
  }
  moved.end = static_cast<std::uint32_t>(entries_.size());
}

void Dashpots::add_node(NodeIndex node, const Vec2& normal, const Vec2& tangential) {
  add<2>(nodes_ + 2 * static_cast<size_t>(node),
         {Parts{normal.x(), 0, tangential.x()}, Parts{normal.y(), 0, tangential.y()}});
}

void Dashpots::add_point(RigidIndex body, const Vec2& arm, const Vec2& normal,
                         const Vec2& tangential) {
  add<3>(3 * static_cast<size_t>(body),
         {Parts{normal.x(), 0, tangential.x()}, Parts{normal.y(), 0, tangential.y()},
          Parts{cross(arm, normal), 0, cross(arm, tangential)}});
}

void Dashpots::add_rigid(RigidIndex body, double sign, const std::array<Vec2, 2>& normal_at,
                         const Vec2& tangential_at) {
  const Vec2 n = sign * dashpots_.back().normal, t(-n.y(), n.x());
  add<3>(3 * static_cast<size_t>(body),
         {Parts{n.x(), n.x(), t.x()}, Parts{n.y(), n.y(), t.y()},
          Parts{cross(normal_at[0], n), cross(normal_at[1], n), cross(tangential_at, t)}});
}

std::span<const Dashpots::Entry> Dashpots::entries(size_t i) const {
  const size_t first = solved_[i].first;
  const size_t end = i + 1 < solved_.size() ? solved_[i + 1].first : entries_.size();
  return {entries_.data() + first, end - first};
}

Vec2 Dashpots::force_on_a(size_t i) const {
  const Vec2& n = dashpots_[i].normal;
  return normal_force(i) * n + tangential_force(i) * Vec2(-n.y(), n.x());
}

double Dashpots::lost_after(std::span<const double> velocity, double dt) const {
  double power = 0;
  for (const Moved& moved : moved_) {
    if (moved.coordinate < velocity.size()) power += moved.force * velocity[moved.coordinate];
  }
  return -dt / 2 * (power - gain_);
}

// The velocity along a rail is one number that both coordinates share. Impulses across the rail go
// into whatever holds the rail.
void Dashpots::put_on(const Motion::Rail& rail) {
  const size_t coordinate = 3 * static_cast<size_t>(rail.body);
  if (coordinate >= index_.size() || index_[coordinate] == kNone) return;
  // The coordinates of a body are consecutive.
  const std::uint32_t index = index_[coordinate];
  moving_[index].inverse_mass = moving_[index + 1].inverse_mass = rail.inverse_mass;
  moved_[index].kick = rail.gain * rail.direction.x();
  moved_[index + 1].kick = rail.gain * rail.direction.y();
  for (size_t i = 0; i < solved_.size(); ++i) {
    const size_t first = solved_[i].first, end = first + entries(i).size();
    for (size_t e = first; e < end; ++e) {
      if (entries_[e].moved != index) continue;
      Entry &x = entries_[e], &y = entries_[e + 1];
      Entry across_x = x, across_y = y;
      for (size_t k = 0; k < 3; ++k) {
        const double along = Vec2(x.part[k], y.part[k]).dot(rail.direction);
        x.part[k] = along * rail.direction.x(), y.part[k] = along * rail.direction.y();
        across_x.part[k] -= x.part[k], across_y.part[k] -= y.part[k];
      }
      across_rails_.push_back(across_x), across_rails_.push_back(across_y);
      of_these_.insert(of_these_.end(), 2, static_cast<std::uint32_t>(i));
    }
  }
}

void Dashpots::find_kicks(const Motion& motion, double dt) {
  moving_.resize(moved_.size());
  for (size_t i = 0; i < moved_.size(); ++i) {
    Moved& moved = moved_[i];
    const size_t c = moved.coordinate;
    const double w = motion.inverse_mass[c], g = motion.weight.empty() ? 0 : motion.weight[c];
    moved.kick = dt / 2 * w * (motion.before[c] + motion.after[c] + 2 * g);
    moved.reach = moved.force = 0;
    moving_[i].inverse_mass = w;
  }
  for (const Motion::Rail& rail : motion.rails) put_on(rail);
  for (size_t i = 0; i < moved_.size(); ++i) {
    moving_[i].velocity = motion.velocity[moved_[i].coordinate] + moved_[i].kick;
  }
}

// A dashpot acts for half of the last drift and half of the next one. If the contact began within
// the last drift, or will end within the next one, it acts only for as long as the contact is
// closed, with the mean of the coefficient, which rises with the square root of the stiffness.
void Dashpots::find_rates(double dt) {
  for (size_t i = 0; i < dashpots_.size(); ++i) {
    const Dashpot& dashpot = dashpots_[i];
    Solved& solved = solved_[i];
    std::array<double, 3> before{}, kick{};
    for (const Entry& e : entries(i)) {
      const double kicked = moved_[e.moved].kick, v = moving_[e.moved].velocity - kicked;
      for (size_t k = 0; k < 3; ++k) {
        kick[k] += e.part[k] * kicked;
        before[k] += e.part[k] * v;
      }
    }
    const auto closed_fraction = [&](double approach, const Dashpot::Normal& normal) {
      if (!(approach * dt > normal.depth)) return .5;
      return 2 / (normal.power + 1) * normal.depth / (approach * dt);
    };
    double fraction = 0;  // larger fraction of the step for which one end of the contact is closed
    for (size_t k = 0; k < 2; ++k) {
      const Dashpot::Normal& across = dashpot.across[k];
      const double both =
          closed_fraction(-before[k], across) + closed_fraction(before[k] + kick[k], across);
      if (across.rate > 0) fraction = std::max(fraction, both);
      solved.along[k] = {0, across.rate * both * dt, before[k]};
    }
    solved.along[2] = {0, dashpot.tangential_rate * fraction * dt, before[2]};
    solved.slip = before[2];
    for (const Entry& e : entries(i)) {
      double& reach = moved_[e.moved].reach;
      for (size_t k = 0; k < 3; ++k) reach += solved.along[k].gain * std::abs(e.part[k]);
    }
  }
}

// x includes the effect of all dashpots at these bodies on the rate.
void Dashpots::find_gains() {
  for (size_t i = 0; i < dashpots_.size(); ++i) {
    Solved& solved = solved_[i];
    std::array<double, 3> mobility{}, coupled{};
    solved.d01 = solved.d02 = solved.d12 = 0;
    for (const Entry& e : entries(i)) {
      const double w = moving_[e.moved].inverse_mass, all = w * moved_[e.moved].reach;
      for (size_t k = 0; k < 3; ++k) {
        mobility[k] += w * e.part[k] * e.part[k];
        coupled[k] += all * std::abs(e.part[k]);
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

// Solves for the dashpots of one contact with all others fixed. Returns the largest change of an
// impulse, N s.
double Dashpots::relax(size_t i, double dt) {
  const Dashpot& dashpot = dashpots_[i];
  Solved& solved = solved_[i];
  // Two sums, each of every second entry, because an addition has to wait for the one before.
  const std::span<const Entry> all = entries(i);
  std::array<double, 3> rate{}, rest{};
  const auto add = [&](const Entry& e, std::array<double, 3>& sum) {
    const double v = moving_[e.moved].velocity;
    for (size_t k = 0; k < 3; ++k) sum[k] += e.part[k] * v;
  };
  for (size_t e = 0; e + 1 < all.size(); e += 2) add(all[e], rate), add(all[e + 1], rest);
  if (all.size() % 2 == 1) add(all.back(), rate);
  for (size_t k = 0; k < 3; ++k) rate[k] += rest[k];
  std::array<double, 3> change;
  const auto free = [&](size_t k, double behind) {
    const Along& along = solved.along[k];
    return along.kept * along.impulse - along.gain * behind - along.offset;
  };
  const auto set = [&](size_t k, double impulse) {
    change[k] = impulse - solved.along[k].impulse;
    solved.along[k].impulse = impulse;
  };
  const auto push = [&](size_t k, double behind) {
    const Dashpot::Normal& across = dashpot.across[k];
    const double pull = free(k, behind);
    set(k, pull < 0 ? across.push(pull, across.pressed * dt, solved.along[k].kept) : pull);
  };
  push(0, rate[0]);
  push(1, rate[1] + solved.d01 * change[0]);
  const double per_dt = 1 / dt;
  const double pressed = dashpot.across[0].pressed + dashpot.across[1].pressed +
                         (solved.along[0].impulse + solved.along[1].impulse) * per_dt;
  const double limit = dashpot.limit(pressed, solved.slip) * dt, spring = dashpot.spring * dt;
  const double behind = rate[2] + solved.d02 * change[0] + solved.d12 * change[1];
  set(2, std::clamp(free(2, behind), -limit - spring, limit - spring));
  for (const Entry& e : all) {
    Moving& moving = moving_[e.moved];
    moving.velocity += moving.inverse_mass *
                       (e.part[0] * change[0] + e.part[1] * change[1] + e.part[2] * change[2]);
  }
  return std::max({std::abs(change[0]), std::abs(change[1]), std::abs(change[2])});
}

Dashpots::Pass Dashpots::relax_all(bool forwards, double dt) {
  Pass pass;
  for (size_t k = 0; k < dashpots_.size(); ++k) {
    const size_t i = forwards ? k : dashpots_.size() - 1 - k;
    pass.change = std::max(pass.change, relax(i, dt));
    const std::array<Along, 3>& along = solved_[i].along;
    pass.largest = std::max(pass.largest, std::abs(along[0].impulse + along[1].impulse));
  }
  return pass;
}

void Dashpots::solve(const Motion& motion, double dt) {
  dt_ = dt;
  find_kicks(motion, dt);
  find_rates(dt);
  find_gains();
  double pressed = 0;
  for (const Dashpot& dashpot : dashpots_) {
    pressed = std::max(pressed, dashpot.across[0].pressed + dashpot.across[1].pressed);
  }
  // One pass is never enough: it leaves the order of the contacts in the result.
  for (int k = 0; k < kMostPasses; ++k) {
    const Pass pass = relax_all(k % 2 == 0, dt);
    if (k > 0 && pass.change <= kAgree * std::max(pass.largest, pressed * dt)) break;
  }
  sum_forces(motion, dt);
}

void Dashpots::sum_forces(const Motion& motion, double dt) {
  const auto force = [&](size_t i, const Entry& e) {
    const std::array<Along, 3>& along = solved_[i].along;
    return (e.part[0] * along[0].impulse + e.part[1] * along[1].impulse +
            e.part[2] * along[2].impulse) *
           (1 / dt);
  };
  for (size_t i = 0; i < dashpots_.size(); ++i) {
    for (const Entry& e : entries(i)) moved_[e.moved].force += force(i, e);
  }
  for (size_t k = 0; k < across_rails_.size(); ++k) {
    const Entry& e = across_rails_[k];
    moved_[e.moved].force += force(of_these_[k], e);
  }
  // The power is taken at the mean velocities of the two half kicks.
  double power = 0;
  gain_ = 0;
  for (const Moved& moved : moved_) {
    const size_t c = moved.coordinate;
    const double f = moved.force, w = dt / 4 * motion.inverse_mass[c];
    const double g = motion.weight.empty() ? 0 : motion.weight[c];
    power += f * (motion.velocity[c] + w * (motion.before[c] + f + g));
    gain_ += f * w * (motion.after[c] + f + g);
  }
  lost_ = -dt / 2 * power;
}

void Dashpots::add_forces(std::span<double> forces) const {
  for (const Moved& moved : moved_) {
    if (moved.coordinate < forces.size()) forces[moved.coordinate] += moved.force;
  }
}

}  // namespace apothem
