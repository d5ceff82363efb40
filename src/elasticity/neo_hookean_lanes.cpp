// Several points side by side. Each loop over lanes is one that the compiler turns into vectors.
#include <limits>

#include "neo_hookean_point.h"
#include "snapwing/common/wide.h"

namespace snapwing::elasticity {

namespace {

/// Volume and thickness of each point, and whether the latter is found.
struct Found {
  Lanes minors, det, z, beyond;
  Lanes t, grown, thickness_beyond, open;
};

template <int D>
inline void mixedAt(const PointLanes<D>& in, int l, double (&h)[D * D]) {
  for (int k = 0; k < D * D; ++k) h[k] = in.mix.at[l] * in.h[k].at[l];
}

template <int D>
SNAPWING_WIDE void findVolumes(const PointLanes<D>& in, Found& out) {
#pragma omp simd
  for (int l = 0; l < LANES; ++l) {
    double h[D * D];
    mixedAt<D>(in, l, h);
    const Volume volume = volumeAt<D>(h);
    out.minors.at[l] = volume.minors;
    out.det.at[l] = volume.det;
    out.z.at[l] = volume.z;
    out.beyond.at[l] = volume.beyond;
  }
}

SNAPWING_WIDE void guessThickness(const NeoHookeanModuli& m, Found& out) {
#pragma omp simd
  for (int l = 0; l < LANES; ++l) {
    const double guess = ThicknessStretch::guess(m, out.z.at[l]);
    const bool near = std::abs(guess) < NEAR;
    ThicknessStretch e;
    e.t = near ? guess : 0;
    const bool exact = e.refine(m, out.z.at[l]);
    out.t.at[l] = e.t;
    out.grown.at[l] = e.grown;
    out.thickness_beyond.at[l] = e.beyond;
    out.open.at[l] = near ? (exact ? 0 : 1) : 2;
  }
}

/// Those that are near but not exact once more; the others from anywhere.
void finishThickness(const NeoHookeanModuli& m, Found& out) {
  for (int l = 0; l < LANES; ++l) {
    if (out.open.at[l] == 0) continue;
    ThicknessStretch e;
    e.t = out.t.at[l];
    if (out.open.at[l] == 2 || !e.refine(m, out.z.at[l])) e.search(m, out.z.at[l]);
    out.t.at[l] = e.t;
    out.grown.at[l] = e.grown;
    out.thickness_beyond.at[l] = e.beyond;
  }
}

template <int D, bool PLANE_STRESS>
SNAPWING_WIDE void respond(const NeoHookeanModuli& m, const PointLanes<D>& in, const Found& found,
                           ResponseLanes<D>& out) {
#pragma omp simd
  for (int l = 0; l < LANES; ++l) {
    double h[D * D], mixed[D * D];
    for (int k = 0; k < D * D; ++k) h[k] = in.h[k].at[l];
    mixedAt<D>(in, l, mixed);
    const double det = found.det.at[l];
    const Volume volume = {found.minors.at[l], det, found.z.at[l], found.beyond.at[l]};
    ThicknessStretch e;
    if constexpr (PLANE_STRESS) {
      e.t = found.t.at[l], e.grown = found.grown.at[l], e.beyond = found.thickness_beyond.at[l];
    }
    const VolumeEnergy v = PLANE_STRESS ? VolumeEnergy(m, found.z.at[l], e) : VolumeEnergy(m, found.z.at[l]);
    PointResponse<D> r = hyperelasticAt<D>(m, mixed, volume, v);
    mixLinear<D>(m, h, in.stiffness.at[l], in.mix.at[l], r);
    out.det_f.at[l] = det;
    out.energy.at[l] = det > 0 ? r.energy : std::numeric_limits<double>::infinity();
    for (int k = 0; k < D * D; ++k) out.stress[k].at[l] = r.stress[k];
    for (int k = 0; k < D * D; ++k) out.q[k].at[l] = r.q[k];
    out.b.at[l] = r.b;
    out.c.at[l] = r.c;
  }
}

}  // namespace

template <int D>
void NeoHookean<D>::evaluateLanes(const PointLanes<D>& points, ResponseLanes<D>& out) const {
  Found found;
  findVolumes<D>(points, found);
  if constexpr (D == 2) {
    if (plane_stress_) {
      guessThickness(moduli_, found);
      finishThickness(moduli_, found);
      respond<D, true>(moduli_, points, found, out);
      return;
    }
  }
  respond<D, false>(moduli_, points, found, out);
}

template void NeoHookean<2>::evaluateLanes(const PointLanes<2>&, ResponseLanes<2>&) const;
template void NeoHookean<3>::evaluateLanes(const PointLanes<3>&, ResponseLanes<3>&) const;

}  // namespace snapwing::elasticity
