#include "particles.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace snapwing::planning {

namespace {

constexpr int LEAST_KIND = 5;    // at least one of so many particles is touched, and one is not
constexpr int LEAST_BASIN = 10;  // likewise, of those in each of the two modes

/// Draws `count` of `from`, which together weigh `weight`.
void draw(const std::vector<const Particle*>& from, int count, double weight, RandomSource& random,
          std::vector<Particle>* next) {
  if (count <= 0) return;
  // Systematic: one random number for all.
  const double spacing = weight / count;
  double at = spacing * random.uniform(), sum = from.front()->weight;
  std::size_t k = 0;
  for (int i = 0; i < count; ++i, at += spacing) {
    while (sum < at && k + 1 < from.size()) sum += from[++k]->weight;
    next->push_back(*from[k]);
    next->back().weight = spacing;
  }
}

/// Draws `count` of those that are touched, or not, keeping the weight of each mode among them.
void drawKind(const std::vector<Particle>& particles, double barrier, bool touched, int count, RandomSource& random,
              std::vector<Particle>* next) {
  if (count <= 0) return;
  std::vector<const Particle*> in[2];
  double weight[2] = {0, 0};
  for (const Particle& particle : particles) {
    if (particle.outside.touched() != touched) continue;
    const int mode = particle.inQuadrotor(barrier) ? 1 : 0;
    in[mode].push_back(&particle);
    weight[mode] += particle.weight;
  }
  const int least = count / LEAST_BASIN;
  int quadrotor = static_cast<int>(std::lround(count * weight[1] / (weight[0] + weight[1])));
  quadrotor = std::clamp(quadrotor, weight[1] > 0 ? least : 0, count - (weight[0] > 0 ? least : 0));
  if (!(weight[0] > 0)) quadrotor = count;
  if (!(weight[1] > 0)) quadrotor = 0;
  draw(in[0], count - quadrotor, weight[0], random, next);
  draw(in[1], quadrotor, weight[1], random, next);
}

}  // namespace

void normalise(std::vector<Particle>* particles) {
  const double sum = std::accumulate(particles->begin(), particles->end(), 0.0,
                                     [](double before, const Particle& p) { return before + p.weight; });
  for (Particle& particle : *particles) particle.weight /= sum;
}

double effective(const std::vector<Particle>& particles) {
  return 1.0 / std::accumulate(particles.begin(), particles.end(), 0.0,
                               [](double sum, const Particle& p) { return sum + p.weight * p.weight; });
}

double shareInQuadrotor(const std::vector<Particle>& particles, double barrier) {
  double sum = 0;
  for (const Particle& particle : particles) sum += particle.inQuadrotor(barrier) ? particle.weight : 0.0;
  return std::clamp(sum, 0.0, 1.0);
}

double shareTouched(const std::vector<Particle>& particles) {
  double sum = 0;
  for (const Particle& particle : particles) sum += particle.outside.touched() ? particle.weight : 0.0;
  return std::clamp(sum, 0.0, 1.0);
}

double samplingVariance(const std::vector<Particle>& particles, double barrier) {
  // The sum of n weights, equal at the last draw, has the relative variance 1 / n_effective - 1 / n.
  double sum[2] = {0, 0}, squares[2] = {0, 0}, count[2] = {0, 0};
  for (const Particle& particle : particles) {
    const int mode = particle.inQuadrotor(barrier) ? 1 : 0;
    sum[mode] += particle.weight;
    squares[mode] += particle.weight * particle.weight;
    count[mode] += 1;
  }
  double variance = 0;
  for (int mode = 0; mode < 2; ++mode) {
    if (sum[mode] > 0) variance += std::max(0.0, squares[mode] / (sum[mode] * sum[mode]) - 1.0 / count[mode]);
  }
  return variance;
}

std::vector<Particle> drawAnew(const std::vector<Particle>& particles, double barrier, RandomSource& random) {
  const int all = static_cast<int>(particles.size()), least = all / LEAST_KIND;
  const double with = shareTouched(particles);
  int count = std::clamp(static_cast<int>(std::lround(all * with)), least, all - least);
  if (!(with > 0)) count = 0;
  if (!(with < 1)) count = all;
  std::vector<Particle> next;
  next.reserve(particles.size());
  drawKind(particles, barrier, true, count, random, &next);
  drawKind(particles, barrier, false, all - count, random, &next);
  return next;
}

}  // namespace snapwing::planning
