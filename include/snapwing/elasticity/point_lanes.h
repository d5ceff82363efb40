#pragma once
/// Several material points side by side, as a processor has numbers in its vectors.

namespace snapwing::elasticity {

constexpr int LANES = 8;

/// One number of each point.
struct alignas(64) Lanes {
  double at[LANES];
};

/// What a law sees of each point.
template <int D>
struct PointLanes {
  Lanes h[D * D];        ///< F - I by columns
  Lanes stiffness, mix;  ///< DensityInterpolation::Value of the point's cell
};

/// Response<D> of each point, its tangent in compact form. An energy that is not finite leaves the rest undefined, but
/// for det_f.
template <int D>
struct ResponseLanes {
  Lanes energy, det_f;
  Lanes stress[D * D];   ///< by columns
  Lanes b, c, q[D * D];  ///< CompactTangent<D>, Q by columns
};

}  // namespace snapwing::elasticity
