#include "calib/methods/scene/particle_swarm.h"

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

// The standard's distributions differ between libraries.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double Uniform(double from, double to) {
    return from + (to - from) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  Vector6d InBox(double half) {
    Vector6d v;
    for (int k = 0; k < 6; ++k) v[k] = Uniform(-half, half);
    return v;
  }

 private:
  std::mt19937_64 engine_;
};

// Places in units of the box: -1 to 1 along each component.
struct Particle {
  Vector6d place, velocity, best_place;
  double best = 0;
};

class Swarm {
 public:
  Swarm(const PoseObjective& objective, const Rigid3& start, const SwarmOptions& options)
      : objective_(objective), start_(start), options_(options), draw_(options.seed) {
    for (int i = 0; i < options.particles; ++i) {
      Particle p;
      p.place = i == 0 ? Vector6d::Zero().eval() : draw_.InBox(1);
      p.velocity = draw_.InBox(0.5);
      p.best_place = p.place;
      p.best = ValueAt(p.place);
      particles_.push_back(p);
      if (p.best > particles_[leader_].best) leader_ = particles_.size() - 1;
    }
  }

  void MoveAll() {
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      Particle& p = particles_[i];
      Move(&p);
      const double value = ValueAt(p.place);
      if (!(value > p.best)) continue;
      p.best = value;
      p.best_place = p.place;
      if (value > particles_[leader_].best) leader_ = i;
    }
  }

  SwarmResult Result() const {
    const Particle& p = particles_[leader_];
    return {Moved(start_, p.best_place, options_.reach), p.best,
            p.best_place.cwiseAbs().maxCoeff() > 0.97};
  }

 private:
  double ValueAt(const Vector6d& place) const {
    return objective_(Moved(start_, place, options_.reach));
  }

  void Move(Particle* p) {
    constexpr double kInertia = 0.7298;
    constexpr double kPull = 1.49618;
    const Vector6d& leader = particles_[leader_].best_place;
    for (int k = 0; k < 6; ++k) {
      p->velocity[k] = kInertia * p->velocity[k] +
                       draw_.Uniform(0, kPull) * (p->best_place[k] - p->place[k]) +
                       draw_.Uniform(0, kPull) * (leader[k] - p->place[k]);
      p->place[k] += p->velocity[k];
      if (std::abs(p->place[k]) <= 1) continue;
      p->place[k] = p->place[k] > 0 ? 1 : -1;
      p->velocity[k] = 0;
    }
  }

  const PoseObjective& objective_;
  Rigid3 start_;
  SwarmOptions options_;
  Draw draw_;
  std::vector<Particle> particles_;
  std::size_t leader_ = 0;
};

}  // namespace

void SwarmOptions::Check() const {
  if (particles < 2) {
    throw InputError("swarm: particles is " + std::to_string(particles) + "; expected 2 or more");
  }
  if (rounds < 1) {
    throw InputError("swarm: rounds is " + std::to_string(rounds) + "; expected 1 or more");
  }
  if (!(reach.rotation_rad > 0) || !(reach.translation_m > 0)) {
    throw InputError("swarm: reach is " + std::to_string(reach.rotation_rad) + " rad and " +
                     std::to_string(reach.translation_m) + " m; expected more than 0");
  }
}

SwarmResult MaximiseBySwarm(const PoseObjective& objective, const Rigid3& start,
                            const SwarmOptions& options) {
  options.Check();
  Swarm swarm(objective, start, options);
  for (int round = 0; round < options.rounds; ++round) swarm.MoveAll();
  return swarm.Result();
}

}  // namespace rgbdt
