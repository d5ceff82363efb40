#pragma once
/// The accelerometer of the flight controller, asked over MSP (MSP_RAW_IMU) beside the remote-control frames, for
/// vehicles on which nothing else measures.
///
/// The controller serves 96 commands a second on one port. With 50 frames there is room for 40 questions: four with
/// each five frames, of which every second is this one, so that readings come at 20 Hz and what guards the link is
/// asked 20 times a second in place of 25. In a pulse a question follows each frame, and every second one is this one.

#include <array>
#include <cstdint>

#include "snapwing/link/msp.h"

namespace snapwing::link {

constexpr double STANDARD_GRAVITY = 9.80665;  ///< [m/s2]

struct ImuSettings {
  bool ask = false;
  /// [1/g] numbers per g in the answer: 512 by all boards of present Betaflight but those with an odd sensor (their
  /// `acc_1G` over 8, 4 or 2), and by iNav
  double counts_per_g = 512.0;
  /// @throws common::SettingError naming the key
  void validate() const;
};

/// Answer to MSP_RAW_IMU: accelerometer, gyroscope [deg/s], magnetometer, as the firmware writes them.
struct RawImu {
  std::array<int, 3> acceleration{}, rotation{}, field{};
};
/// The magnetometer may be missing.
bool decode(const MspPacket& packet, RawImu& out);
void encode(const RawImu& in, MspPacket& packet);

struct ImuReading {
  std::int64_t number = 0;               ///< counts the readings up; 0 = none came
  std::array<double, 3> acceleration{};  ///< [m/s2] specific force by the controller's axes; z is up, along the thrust
  double time = -1e9;                    ///< [s] when the answer came
};

/// Decides when the question is asked, and keeps the last answer.
class ImuQuestion {
 public:
  explicit ImuQuestion(const ImuSettings& settings) : settings_(settings) {}

  /// A new connection: what the last controller refused is asked again.
  void connected() { refused_ = false; }
  /// Whether a question may go with the frame of this number.
  bool mayAsk(unsigned frame) const { return active() ? frame % 5 != 4 : frame % 2 == 0; }
  /// Whether the next question is this one. Call once for each question.
  bool next() { return active() && turn_++ % 2 == 0; }
  /// @return false if the answer is no good; a controller that refuses is not asked again
  bool take(const MspPacket& packet, double now);

  const ImuReading& reading() const { return reading_; }

 private:
  bool active() const { return settings_.ask && !refused_; }

  ImuSettings settings_;
  bool refused_ = false;
  unsigned turn_ = 0;
  ImuReading reading_;
};

}  // namespace snapwing::link
