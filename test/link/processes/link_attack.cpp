/// link_attack: a stray or hostile sender on the link's LCM network, for the fault table. It floods the command
/// channels with random bytes, or with well-formed pulses, heartbeats and aborts sealed with another key.
#include <poll.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <random>

#include "snapwing/link/clock.h"
#include "snapwing/link/lcm_messages.h"
#include "snapwing/link/sealing.h"

using namespace snapwing;

int main(int argc, char** argv) {
  CLI::App app{"Hostile sender for tests"};
  std::string url, mode = "garbage";
  double rate = 100000, seconds = 1;
  app.add_option("--lcm-url", url)->required();
  app.add_option("--mode", mode)->check(CLI::IsMember({"garbage", "forged"}));
  app.add_option("--rate", rate, "messages a second");
  app.add_option("--seconds", seconds);
  CLI11_PARSE(app, argc, argv);
  lcm::LCM bus(url);
  if (!bus.good()) return 2;
  std::mt19937 rng(7);
  link::Key key;
  for (auto& byte : key) byte = static_cast<std::uint8_t>(rng());
  const link::Sealer sealer(key);
  link::PulseCommand pulse;
  pulse.stamp = {1, 1, 1, link::monotonicSeconds(), 0.1};
  pulse.pulse_id = 1000000;
  pulse.throttle = pulse.duration = 1.0;
  const char* channels[] = {link::CHANNEL_PULSE, link::CHANNEL_HEARTBEAT, link::CHANNEL_ABORT};
  std::vector<std::uint8_t> messages[] = {
      sealer.wrap(channels[0], link::toLcm(pulse)),
      sealer.wrap(channels[1], link::toLcm(link::Heartbeat{pulse.stamp, true, true, true})),
      sealer.wrap(channels[2], link::toLcm(link::Abort{pulse.stamp, 1}))};
  if (mode == "garbage") {
    for (auto& message : messages) {
      message.resize(64);
      for (auto& byte : message) byte = static_cast<std::uint8_t>(rng());
    }
  }
  const double start = link::monotonicSeconds();
  long sent = 0;
  for (double now = start; now - start < seconds; now = link::monotonicSeconds()) {
    const long due = std::lround((now - start) * rate);
    for (; sent < due; ++sent) {
      const std::size_t k = static_cast<std::size_t>(sent % 3);
      bus.publish(channels[k], messages[k].data(), static_cast<unsigned>(messages[k].size()));
    }
    poll(nullptr, 0, 0);
  }
  std::printf("%ld messages in %.3f s\n", sent, link::monotonicSeconds() - start);
  return 0;
}
